// Yalcin, Weiss, De Floriani 2011, section 4: criteria other than the error. Our own: which ones, and where they are
// from.
#include "terrain/diamond/diamond_fields.h"

#include "terrain/diamond/diamond_internal.h"
#include "terrain/geodesy.h"
#include "terrain/terrain_parts.h"

#include <math.h>

// As terrain_create does: a bilinear undulation between samples so far apart is within a millimetre.
#define UNDULATION_STRIDE_M 1000.0

typedef struct Filling {
    DiamondModel *model;
    int stride; // samples between undulations
    int plane;
} Filling;

static double undulation(const Filling *f, int col, int row) {
    double lat, lon;
    grid_geodetic(f->model->terrain->grid, (double)col, (double)row, &lat, &lon);
    return terrain_undulation_m(f->model->terrain, lat, lon);
}

// Between the undulations west and east of a column.
static double undulation_between(const Filling *f, DiamondPoint v) {
    int west = v.col / f->stride * f->stride;
    double here = undulation(f, west, v.row);
    return west == v.col ? here : here + (undulation(f, west + f->stride, v.row) - here) * (v.col - west) / f->stride;
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
        model->datum_m[entry] =
            inside ? (float)((double)model->height_m[diamond_sample(&model->layout, v)] - undulation_between(f, v))
                   : 0.0f;
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

void diamond_fields_fill(DiamondModel *model, Jobs *jobs) {
    if (!model->datum_m && !model->east_deg)
        return;
    GridBounds bounds = grid_bounds(model->terrain->grid, 0, model->layout.height - 1, 0.0);
    Filling f = {.model = model, .stride = (int)fmin(64.0, fmax(1.0, UNDULATION_STRIDE_M / bounds.across_m))};
    for (f.plane = 0; f.plane < model->layout.level_count; f.plane++)
        diamond_run_rows(jobs, &model->layout, f.plane, fill_task, &f);
}
