#include "tests/cut_support.h"

#include "terrain/geodesy.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>

#include <cmocka.h>

uint64_t support_random(uint64_t *state) { // splitmix64
    uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

double support_between(uint64_t *state, double low, double high) {
    return low + (high - low) * (double)(support_random(state) >> 11) * 0x1p-53;
}

// ---- terrains ----

static double lattice_noise(int col, int row, uint64_t seed) { // 0..1
    seed ^= (uint64_t)(uint32_t)col << 32 | (uint32_t)row;
    return support_between(&seed, 0.0, 1.0);
}

static double octave(int col, int row, int cell, uint64_t seed) {
    int c = col / cell, r = row / cell;
    double u = (double)(col % cell) / cell, v = (double)(row % cell) / cell;
    double north = lattice_noise(c, r, seed) * (1 - u) + lattice_noise(c + 1, r, seed) * u;
    double south = lattice_noise(c, r + 1, seed) * (1 - u) + lattice_noise(c + 1, r + 1, seed) * u;
    return north * (1 - v) + south * v;
}

Dem *support_rough_dem(int width, int height, const DemGeoref *georef, double relief_m, uint64_t seed) {
    Dem *dem = NULL;
    assert_int_equal(dem_create(width, height, georef, DEM_DATUM_ELLIPSOID, &dem), RESULT_OK);
    for (int row = 0; row < height; row++)
        for (int col = 0; col < width; col++) {
            double h = 0.0;
            for (int cell = 128; cell >= 1; cell /= 2)
                h += octave(col, row, cell, seed + (uint64_t)cell) * pow(cell / 128.0, 0.9);
            dem->height_m[(size_t)row * (size_t)width + (size_t)col] = (float)(h * relief_m * 0.5);
        }
    return dem;
}

Terrain *support_terrain(Dem *dem, TerrainErrorKind error, int patch_level, Jobs *jobs) {
    TerrainOptions options = {.error = error, .patch_level = patch_level};
    Terrain *terrain = NULL;
    assert_int_equal(terrain_create(&options, dem, NULL, jobs, &terrain), RESULT_OK);
    return terrain;
}

Terrain *support_shared_terrain(const char *name, Geoid **geoid, Jobs *jobs) {
    char path[512];
    snprintf(path, sizeof path, "%s/dem/%s", SHARED_DIR, name);
    const char *paths[] = {path}, *geoid_path = SHARED_DIR "/geo/egm96-15.pgm";
    if (access(path, R_OK) || access(geoid_path, R_OK)) {
        print_message("%s or %s is missing: skipped\n", path, geoid_path);
        return NULL;
    }
    DemOptions dem_options = dem_default_options();
    TerrainOptions options = terrain_default_options();
    Dem *dem = NULL;
    Terrain *terrain = NULL;
    assert_int_equal(geoid_open(geoid_path, geoid), RESULT_OK);
    assert_int_equal(dem_load(&dem_options, paths, 1, &dem), RESULT_OK);
    assert_int_equal(terrain_create(&options, dem, *geoid, jobs, &terrain), RESULT_OK);
    return terrain;
}

// ---- views ----

Vec3d support_eye(const Terrain *terrain, double col, double row, double above_m) {
    const Dem *dem = terrain_dem(terrain);
    int c = (int)fmin(fmax(col + 0.5, 0.0), dem->width - 1), r = (int)fmin(fmax(row + 0.5, 0.0), dem->height - 1);
    double lat, lon, ground_m = (double)dem->height_m[(size_t)r * (size_t)dem->width + (size_t)c];
    grid_geodetic(terrain_grid(terrain), col, row, &lat, &lon);
    return geodesy_to_ecef((Geodetic){lat * GEODESY_RAD_PER_DEG, lon * GEODESY_RAD_PER_DEG, ground_m + above_m});
}

LodView support_view(Vec3d eye_ecef, double tau_px) {
    Vec3d north = vec3d_cross(eye_ecef, vec3d_cross(vec3d(0.0, 0.0, 1.0), eye_ecef));
    return (LodView){.eye_ecef = eye_ecef,
                     .forward_ecef = vec3d_normalize(north),
                     .px_per_rad = 692.8, // 800 lines for 60 degrees
                     .tau_px = tau_px};
}

// ---- checks ----

static uint64_t mix(uint64_t hash, uint64_t value) {
    hash = (hash ^ value) * UINT64_C(0x9e3779b97f4a7c15);
    return hash ^ hash >> 32;
}

static uint64_t mix_vertex(uint64_t hash, const LodPage *page, uint16_t index) {
    const LodVertex *v = &page->vertices[index];
    hash = mix(hash, (uint64_t)(uint32_t)(page->col0 + v->col) << 32 | (uint32_t)(page->row0 + v->row));
    hash = mix(hash, (uint64_t)(page->origin.x + v->x));
    hash = mix(hash, (uint64_t)(page->origin.y + v->y));
    return mix(hash, (uint64_t)(page->origin.z + v->z));
}

uint64_t support_cut_hash(const LodCut *cut) {
    uint64_t hash = (uint64_t)cut->item_count;
    for (int32_t i = 0; i < cut->item_count; i++) {
        const LodItem *item = &cut->items[i];
        hash = mix(hash, (uint64_t)item->level << 32 | (uint32_t)item->index_count);
        for (int32_t k = 0; k < item->index_count; k++)
            hash = mix_vertex(mix(hash, item->indices[k]), item->page, item->indices[k]);
    }
    return hash;
}

Measure support_check_cut(const Terrain *terrain, const LodCut *cut, Jobs *jobs, const char *what) {
    const Dem *dem = terrain_dem(terrain);
    Measure m;
    assert_int_equal(measure_cut(terrain, cut, jobs, &m), RESULT_OK);
    bool whole = !m.t_junctions && !m.holes && !m.overlaps && m.samples == (int64_t)dem->width * dem->height;
    bool kept = !cut->promises || (isfinite(m.max_px) && m.max_px <= cut->reached_px);
    if (!whole || !kept)
        fail_msg("%s, frame %" PRIu64 ": max %.6g px at (%d, %d), tolerance %.6g, reached %.6g; %" PRId64
                 " T-junctions, %" PRId64 " holes, %" PRId64 " overlaps, %" PRId64 " of %d x %d samples; expected "
                 "at most the tolerance, 0, 0, 0, all",
                 what, cut->frame, m.max_px, m.worst_col, m.worst_row, cut->view.tau_px, cut->reached_px, m.t_junctions,
                 m.holes, m.overlaps, m.samples, dem->width, dem->height);
    return m;
}
