// Yalcin, Weiss, De Floriani 2011, section 4: criteria other than the error. Our own: which ones, and where they are
// from.
#include "terrain/diamond/diamond_fields.h"

#include "terrain/diamond/diamond_internal.h"
#include "terrain/geodesy.h"
#include "terrain/terrain_parts.h"

#include <math.h>
#include <stdlib.h>

// As terrain_create does: a bilinear undulation between samples so far apart is within a millimetre.
#define UNDULATION_STRIDE_M 1000.0

typedef struct Filling {
    DiamondModel *model;
    int stride;          // samples between undulations
    int across;          // undulations a row
    double *undulations; // [height][across], metres; NULL: nobody asks
    int plane;
} Filling;

static void undulation_task(void *user, int64_t begin, int64_t end, int worker) {
    const Filling *f = user;
    const Terrain *terrain = f->model->terrain;
    (void)worker;
    for (int64_t row = begin; row < end; row++)
        for (int i = 0; i < f->across; i++) {
            double lat, lon;
            grid_geodetic(terrain->grid, (double)i * f->stride, (double)row, &lat, &lon);
            f->undulations[row * f->across + i] = terrain_undulation_m(terrain, lat, lon);
        }
}

static float datum_height(const Filling *f, DiamondPoint v) {
    const double *west = f->undulations + (size_t)v.row * (size_t)f->across + (size_t)(v.col / f->stride);
    double undulation = west[0] + (west[1] - west[0]) * (v.col % f->stride) / f->stride;
    return (float)((double)f->model->height_m[diamond_sample(&f->model->layout, v)] - undulation);
}

static void fill_degrees(const Filling *f, size_t entry, DiamondPoint v) {
    double lat, lon;
    const DiamondModel *model = f->model;
    Vec3d p = {(double)model->x[entry], (double)model->y[entry], (double)model->z[entry]};
    Geodetic g = geodesy_from_ecef(vec3d_add(p, model->origin_ecef));
    lat = g.lat_rad / GEODESY_RAD_PER_DEG;
    lon = g.lon_rad / GEODESY_RAD_PER_DEG;
    if (model->terrain->dem->georef.crs == DEM_CRS_GEOGRAPHIC)
        grid_geodetic(model->terrain->grid, (double)v.col, (double)v.row, &lat, &lon);
    f->model->north_deg[entry] = (float)(lat - model->middle_lat_deg);
    f->model->east_deg[entry] = (float)remainder(lon - model->middle_lon_deg, 360.0);
}

static void fill_entry(const Filling *f, size_t entry, DiamondPoint v) {
    DiamondModel *model = f->model;
    bool inside = diamond_is_inside(&model->layout, v);
    if (model->datum_m)
        model->datum_m[entry] = inside ? datum_height(f, v) : 0.0f;
    if (!model->east_deg)
        return;
    model->east_deg[entry] = model->north_deg[entry] = 0.0f;
    if (inside)
        fill_degrees(f, entry, v);
}

static void fill_task(void *user, int64_t begin, int64_t end, int worker) {
    const Filling *f = user;
    const DiamondLayout *layout = &f->model->layout;
    (void)worker;
    for (uint32_t j = (uint32_t)begin; j < (uint32_t)end; j++)
        for (uint32_t i = 0; i < layout->across[f->plane]; i++)
            for (int slot = 0; slot < DIAMOND_SLOTS; slot++) {
                uint32_t word = layout->offset[f->plane] + j * layout->across[f->plane] + i;
                fill_entry(f, diamond_entry(layout, slot, word), diamond_vertex(f->plane, i, j, slot));
            }
}

Result diamond_fields_fill(DiamondModel *model, Jobs *jobs) {
    if (!model->datum_m && !model->east_deg)
        return RESULT_OK;
    const DiamondLayout *layout = &model->layout;
    GridBounds bounds = grid_bounds(model->terrain->grid, 0, layout->height - 1, 0.0);
    Filling f = {.model = model, .stride = (int)fmin(64.0, fmax(1.0, UNDULATION_STRIDE_M / bounds.across_m))};
    f.across = (layout->width - 1) / f.stride + 2;
    if (model->datum_m) {
        f.undulations = malloc(sizeof *f.undulations * (size_t)layout->height * (size_t)f.across);
        if (!f.undulations)
            return RESULT_MEMORY;
        jobs_run(jobs, layout->height, 16, undulation_task, &f);
    }
    for (f.plane = 0; f.plane < layout->level_count; f.plane++)
        diamond_run_rows(jobs, layout, f.plane, fill_task, &f);
    free(f.undulations);
    return RESULT_OK;
}
