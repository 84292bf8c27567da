#include "app/reproduce/reproduce.h"

#include "terrain/geodesy.h"

#include <math.h>
#include <string.h>

#define DRAWN_VIEWS 6
#define VRAM_BYTES_MAX ((size_t)1 << 30)

int reproduce_sides(Reproduce *run, const char *what, const int *full, int full_count, int quick_count, int *out) {
    if (run->side_count) {
        memcpy(out, run->sides, sizeof *out * (size_t)run->side_count);
        return run->side_count;
    }
    int count = run->quick && quick_count < full_count ? quick_count : full_count;
    memcpy(out, full, sizeof *out * (size_t)count);
    for (int i = count; i < full_count; i++)
        report_note(&run->report.left_out, "%s: %d x %d samples", what, full[i], full[i]);
    return count;
}

double reproduce_seconds(Reproduce *run, const char *what, double full, double quick) {
    if (run->seconds > 0.0)
        return run->seconds;
    if (run->quick)
        report_note(&run->report.left_out, "%s: all but %g s of each flight of %g s", what, quick, full);
    return run->quick ? quick : full;
}

LodOptions reproduce_lod_options(LodMethod method) {
    LodOptions options = lod_default_options();
    options.method = method;
    options.max_triangles = REPRODUCE_TRIANGLES_MAX;
    return options;
}

double reproduce_px_per_rad(int height_px) {
    return height_px / (2.0 * tan(0.5 * REPRODUCE_FOV_DEG * GEODESY_RAD_PER_DEG));
}

Result reproduce_terrain(const Reproduce *run, SiteGround ground, int side, Circuit *circuit, Terrain **out) {
    Result result = site_make_terrain(&run->site, ground, side, TERRAIN_ERROR_TOTAL, run->all, out);
    if (result == RESULT_OK)
        circuit_plan(*out, REPRODUCE_HEIGHT_M, circuit);
    return result;
}

Result reproduce_draw(Reproduce *run, Race *race, const Circuit *circuit, int width, int height, double tau_px,
                      double part, double step) {
    Viewpoint views[DRAWN_VIEWS];
    if (!run->context)
        return RESULT_OK;
    for (int i = 0; i < DRAWN_VIEWS; i++)
        views[i] = circuit_at(circuit, part + i * step);
    RaceStage stage = {.context = run->context,
                       .width = width,
                       .height = height,
                       .fov_y_rad = REPRODUCE_FOV_DEG * GEODESY_RAD_PER_DEG,
                       .tau_px = tau_px,
                       .vram_bytes_max = VRAM_BYTES_MAX};
    return race_draw(race, &stage, views, DRAWN_VIEWS);
}
