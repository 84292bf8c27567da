#include "base/log.h"
#include "terrain/measure/measure_internal.h"

#include <math.h>
#include <stdlib.h>

typedef struct Popping {
    const Dem *dem;
    const Grid *grid;
    const LodView *view;
    const float *before_m, *after_m;
    const MeasureTouched *touched; // NULL: all are
    double *row_px;                // [height], the largest of each row; -1: none
    int *row_col;                  // [height], where
} Popping;

static double moved_px(const Popping *p, int col, int row, int64_t sample) {
    if (p->touched && !atomic_load_explicit(&p->touched->samples[sample], memory_order_relaxed))
        return -1.0;
    double moved_m = fabs((double)p->after_m[sample] - (double)p->before_m[sample]);
    if (!(moved_m > 0.0)) // nor where one does not cover the sample
        return moved_m == 0.0 ? 0.0 : -1.0;
    Vec3d exact = grid_ecef(p->grid, col, row, (double)p->dem->height_m[sample]);
    return p->view->px_per_rad * moved_m / vec3d_distance(exact, p->view->eye_ecef);
}

static void rows_task(void *user, int64_t begin, int64_t end, int worker) {
    const Popping *p = user;
    (void)worker;
    for (int64_t row = begin; row < end; row++) {
        p->row_px[row] = -1.0;
        p->row_col[row] = 0;
        for (int col = 0; col < p->dem->width; col++) {
            double px = moved_px(p, col, (int)row, row * p->dem->width + col);
            if (px <= p->row_px[row])
                continue;
            p->row_px[row] = px;
            p->row_col[row] = col;
        }
    }
}

Result measure_popping_touched(const Terrain *terrain, const LodView *view, const float *const rise_m[2],
                               const MeasureTouched *touched, Jobs *jobs, MeasurePopping *out) {
    const Dem *dem = terrain_dem(terrain);
    Popping p = {.dem = dem,
                 .grid = terrain_grid(terrain),
                 .view = view,
                 .before_m = rise_m[0],
                 .after_m = rise_m[1],
                 .touched = touched};
    p.row_px = malloc(sizeof *p.row_px * (size_t)dem->height);
    p.row_col = malloc(sizeof *p.row_col * (size_t)dem->height);
    Result result = p.row_px && p.row_col ? RESULT_OK : RESULT_MEMORY;
    if (result == RESULT_OK) {
        int worst = 0;
        jobs_run(jobs, dem->height, 16, rows_task, &p);
        for (int row = 1; row < dem->height; row++)
            worst = p.row_px[row] > p.row_px[worst] ? row : worst;
        *out = (MeasurePopping){fmax(p.row_px[worst], 0.0), p.row_col[worst], worst};
    } else {
        log_error("measure: no memory for %d rows", dem->height);
    }
    free(p.row_px);
    free(p.row_col);
    return result;
}

Result measure_popping(const Terrain *terrain, const LodView *view, const float *before_m, const float *after_m,
                       Jobs *jobs, MeasurePopping *out) {
    return measure_popping_touched(terrain, view, (const float *const[2]){before_m, after_m}, NULL, jobs, out);
}
