#include "app/viewpoint.h"

#include "base/log.h"
#include "terrain/geodesy.h"

#include <math.h>

#define BLOCKS 12         // across and down: where the relief is compared
#define STRIDE_SAMPLES 64 // at least so many samples a block side are looked at, where there are
#define AZIMUTHS 24
#define SIGHT_STEPS 24
#define CLEARANCE_M 120.0 // of the eye above the ground

// A column and row, and how high the ground is there.
typedef struct Spot {
    int col, row;
    double h_m;
} Spot;

typedef struct Block {
    Spot top;
    double relief_m;
    bool has_data;
} Block;

Vec3d viewpoint_forward(const Viewpoint *view) {
    Mat3d enu = geodesy_enu_from_ecef(view->lat_deg * GEODESY_RAD_PER_DEG, view->lon_deg * GEODESY_RAD_PER_DEG);
    double heading = view->heading_deg * GEODESY_RAD_PER_DEG, pitch = view->pitch_deg * GEODESY_RAD_PER_DEG;
    Vec3d local = {sin(heading) * cos(pitch), cos(heading) * cos(pitch), sin(pitch)};
    return mat3d_mul_vec_transposed(&enu, local);
}

Mat3d viewpoint_camera(const Viewpoint *view) {
    Mat3d enu = geodesy_enu_from_ecef(view->lat_deg * GEODESY_RAD_PER_DEG, view->lon_deg * GEODESY_RAD_PER_DEG);
    double heading = view->heading_deg * GEODESY_RAD_PER_DEG, pitch = view->pitch_deg * GEODESY_RAD_PER_DEG;
    Mat3d local = {{{cos(heading), -sin(heading), 0.0},
                    {-sin(heading) * sin(pitch), -cos(heading) * sin(pitch), cos(pitch)},
                    {-sin(heading) * cos(pitch), -cos(heading) * cos(pitch), -sin(pitch)}}};
    return mat3d_mul(&local, &enu);
}

static Block look_at_block(const Dem *dem, int bx, int by) {
    int col0 = (int)((int64_t)dem->width * bx / BLOCKS), col1 = (int)((int64_t)dem->width * (bx + 1) / BLOCKS);
    int row0 = (int)((int64_t)dem->height * by / BLOCKS), row1 = (int)((int64_t)dem->height * (by + 1) / BLOCKS);
    int step = (col1 - col0) / STRIDE_SAMPLES + 1;
    Block block = {.has_data = false};
    double bottom_m = 0.0;
    for (int row = row0; row < row1; row += step) {
        for (int col = col0; col < col1; col += step) {
            if (dem_is_void(dem, col, row))
                continue;
            double h_m = dem->height_m[(size_t)row * (size_t)dem->width + (size_t)col];
            if (!block.has_data || h_m > block.top.h_m)
                block.top = (Spot){col, row, h_m};
            if (!block.has_data || h_m < bottom_m)
                bottom_m = h_m;
            block.has_data = true;
        }
    }
    block.relief_m = block.top.h_m - bottom_m;
    return block;
}

static bool find_highest_relief(const Dem *dem, Block *best) {
    *best = (Block){.has_data = false};
    for (int by = 0; by < BLOCKS; by++) {
        for (int bx = 0; bx < BLOCKS; bx++) {
            Block block = look_at_block(dem, bx, by);
            if (block.has_data && (!best->has_data || block.relief_m > best->relief_m))
                *best = block;
        }
    }
    return best->has_data;
}

// A point `distance_m` from `from` in the direction, on the sphere of the local radius: near enough to choose a view.
static Geodetic walk(Geodetic from, double azimuth_rad, double distance_m) {
    double angle = distance_m / GEODESY_A_M;
    double lat = asin(sin(from.lat_rad) * cos(angle) + cos(from.lat_rad) * sin(angle) * cos(azimuth_rad));
    double lon = from.lon_rad +
                 atan2(sin(azimuth_rad) * sin(angle) * cos(from.lat_rad), cos(angle) - sin(from.lat_rad) * sin(lat));
    return (Geodetic){lat, lon, 0.0};
}

static bool ground_at(const Terrain *terrain, Geodetic point, double *h_m) {
    return terrain_ground_m(terrain, point.lat_rad / GEODESY_RAD_PER_DEG, point.lon_rad / GEODESY_RAD_PER_DEG, h_m);
}

// How good it is to stand there: over the terrain, low ground on the way, so that the relief rises in front.
static bool rate_stand(const Terrain *terrain, Geodetic target, double azimuth_rad, double distance_m, double *mean_m) {
    double sum = 0.0, h_m;
    for (int i = 1; i <= SIGHT_STEPS; i++) {
        if (!ground_at(terrain, walk(target, azimuth_rad, distance_m * i / SIGHT_STEPS), &h_m))
            return false;
        sum += h_m;
    }
    *mean_m = sum / SIGHT_STEPS;
    return true;
}

static bool choose_azimuth(const Terrain *terrain, Geodetic target, double distance_m, double *azimuth_rad) {
    bool found = false;
    double best_m = 0.0, mean_m;
    for (int i = 0; i < AZIMUTHS; i++) {
        double azimuth = 2.0 * GEODESY_PI * i / AZIMUTHS;
        if (rate_stand(terrain, target, azimuth, distance_m, &mean_m) && (!found || mean_m < best_m)) {
            found = true;
            best_m = mean_m;
            *azimuth_rad = azimuth;
        }
    }
    return found;
}

// High enough that no ground between eye and target hides the target.
static double clear_height(const Terrain *terrain, Geodetic target, double azimuth_rad, double distance_m, double h_m) {
    double eye_m = h_m, ground_m;
    for (int i = 1; i <= SIGHT_STEPS; i++) {
        double share = (double)i / SIGHT_STEPS;
        if (!ground_at(terrain, walk(target, azimuth_rad, distance_m * share), &ground_m))
            continue;
        double needed_m = target.h_m + (ground_m + CLEARANCE_M * share - target.h_m) / share;
        if (share > 0.15 && needed_m > eye_m)
            eye_m = needed_m;
    }
    return eye_m;
}

static Viewpoint look_from(const Geoid *geoid, Geodetic eye, Geodetic target) {
    Mat3d enu = geodesy_enu_from_ecef(eye.lat_rad, eye.lon_rad);
    Vec3d to = mat3d_mul_vec(&enu, vec3d_sub(geodesy_to_ecef(target), geodesy_to_ecef(eye)));
    double heading_deg = atan2(to.x, to.y) / GEODESY_RAD_PER_DEG;
    double lat_deg = eye.lat_rad / GEODESY_RAD_PER_DEG, lon_deg = eye.lon_rad / GEODESY_RAD_PER_DEG;
    return (Viewpoint){.lat_deg = lat_deg,
                       .lon_deg = lon_deg,
                       .alt_m = eye.h_m - (geoid ? geoid_undulation_m(geoid, lat_deg, lon_deg) : 0.0),
                       .heading_deg = heading_deg < 0 ? heading_deg + 360.0 : heading_deg,
                       .pitch_deg = atan2(to.z, hypot(to.x, to.y)) / GEODESY_RAD_PER_DEG};
}

static Geodetic target_of(const Terrain *terrain, const Block *block) {
    double lat_deg, lon_deg;
    grid_geodetic(terrain_grid(terrain), block->top.col, block->top.row, &lat_deg, &lon_deg);
    return (Geodetic){lat_deg * GEODESY_RAD_PER_DEG, lon_deg * GEODESY_RAD_PER_DEG, block->top.h_m};
}

Result viewpoint_of_relief(const Terrain *terrain, const Geoid *geoid, Viewpoint *out) {
    const Dem *dem = terrain_dem(terrain);
    Block block;
    double spacing_m[2];
    if (!find_highest_relief(dem, &block)) {
        log_error("%s: not one sample has data; nothing to look at", dem->file);
        return RESULT_RANGE;
    }
    Result result = dem_spacing_m(dem, spacing_m);
    if (result != RESULT_OK)
        return result;
    double extent_m = fmin(dem->width * spacing_m[0], dem->height * spacing_m[1]);
    Geodetic target = target_of(terrain, &block);
    double distance_m = fmin(fmax(6.0 * block.relief_m, 0.08 * extent_m), 0.45 * extent_m), azimuth = GEODESY_PI;
    while (!choose_azimuth(terrain, target, distance_m, &azimuth) && distance_m > 0.02 * extent_m)
        distance_m *= 0.7;
    Geodetic eye = walk(target, azimuth, distance_m);
    eye.h_m = clear_height(terrain, target, azimuth, distance_m, target.h_m + 0.12 * distance_m);
    *out = look_from(geoid, eye, target);
    return RESULT_OK;
}
