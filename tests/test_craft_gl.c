// An aircraft in the picture: where it should be and of the size it should have, only when it is shown, and the same
// wherever on the Earth. Usage:
//   test_craft_gl                     the tests
//   test_craft_gl --pictures FOLDER   writes pictures of each kind from all sides, to look at
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "assets/image.h"
#include "base/arena.h"
#include "base/clock.h"
#include "render/gl.h"
#include "render/render.h"
#include "terrain/geodesy.h"
#include "tests/cut_support.h"
#include "tests/gl_support.h"

#define WIDTH 320
#define HEIGHT 200
#define PICTURE_WIDTH 1280
#define PICTURE_HEIGHT 800
#define DEG GEODESY_RAD_PER_DEG
#define FOV_RAD (40.0 * DEG)

static const DemGeoref GEOREF = {
    .crs = DEM_CRS_GEOGRAPHIC, .x0 = 20.0, .y0 = 49.5, .dx = 1.0 / 1200, .dy = -1.0 / 1200};

typedef struct Stage {
    int width, height;
    Jobs *jobs;
    Terrain *terrain;
    Geoid *geoid;
    Lod *lod;
    Arena *arena;
    Renderer *renderer;
    RenderStats stats;
    uint8_t *rgb;
} Stage;

static Stage stage_begin(Terrain *terrain, Geoid *geoid, Jobs *jobs, int width, int height, int samples) {
    Stage stage = {.width = width, .height = height, .jobs = jobs, .terrain = terrain, .geoid = geoid};
    const LodOptions lod_options = lod_default_options();
    RenderOptions options = render_default_options();
    options.width = width;
    options.height = height;
    options.samples = samples;
    options.measure_times = true;
    assert_int_equal(lod_create(&lod_options, terrain, &stage.lod), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &stage.arena), RESULT_OK);
    assert_int_equal(render_create(&options, terrain, &stage.renderer), RESULT_OK);
    stage.rgb = malloc((size_t)width * (size_t)height * 3);
    assert_non_null(stage.rgb);
    return stage;
}

static Stage stage_rough(const DemGeoref *georef) {
    Jobs *jobs = NULL;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    Dem *dem = support_rough_dem(129, 129, georef, 400.0, 5);
    return stage_begin(support_terrain(dem, TERRAIN_ERROR_TOTAL, 12, jobs), NULL, jobs, WIDTH, HEIGHT, 1);
}

static void stage_end(Stage *stage) {
    render_destroy(&stage->renderer);
    lod_destroy(&stage->lod);
    arena_destroy(&stage->arena);
    terrain_destroy(&stage->terrain);
    geoid_close(&stage->geoid);
    jobs_destroy(&stage->jobs);
    free(stage->rgb);
}

// Local axes at a place: north, east, down as columns of ECEF.
typedef struct Local {
    Vec3d north, east, down;
} Local;

static Local local_at(Vec3d ecef) {
    Geodetic at = geodesy_from_ecef(ecef);
    Mat3d enu = geodesy_enu_from_ecef(at.lat_rad, at.lon_rad);
    return (Local){vec3d(enu.m[1][0], enu.m[1][1], enu.m[1][2]), vec3d(enu.m[0][0], enu.m[0][1], enu.m[0][2]),
                   vec3d(-enu.m[2][0], -enu.m[2][1], -enu.m[2][2])};
}

static Vec3d local_vector(const Local *local, double north, double east, double down) {
    return vec3d_add(vec3d_add(vec3d_scale(local->north, north), vec3d_scale(local->east, east)),
                     vec3d_scale(local->down, down));
}

// Of a rotation with these columns; heading, pitch and bank are small enough in these tests for the trace to be > -1.
static Quatd quaternion_of(Vec3d x, Vec3d y, Vec3d z) {
    Quatd q = {1.0 + x.x + y.y + z.z, y.z - z.y, z.x - x.z, x.y - y.x};
    if (q.w < 1e-3) // half a turn: from the largest diagonal element
        q = x.x >= y.y && x.x >= z.z ? (Quatd){y.z - z.y, 1.0 + x.x - y.y - z.z, y.x + x.y, z.x + x.z}
            : y.y >= z.z             ? (Quatd){z.x - x.z, y.x + x.y, 1.0 + y.y - x.x - z.z, z.y + y.z}
                                     : (Quatd){x.y - y.x, z.x + x.z, z.y + y.z, 1.0 + z.z - x.x - y.y};
    return quatd_normalize(q);
}

typedef struct Shot {
    CraftKind kind;
    double heading_rad, bank_rad;
    double bearing_rad, elevation_rad, distance_m; // of the eye, from the craft: 0 ahead of it, 90 degrees right of it
    double sun_azimuth_rad, sun_elevation_rad;     // azimuth from north
    CraftPose pose;
} Shot;

static RenderPacket packet_of(const Shot *shot, Vec3d place) {
    RenderPacket packet;
    memset(&packet, 0, sizeof packet);
    const Local local = local_at(place);
    Quatd body = quaternion_of(local.north, local.east, local.down);
    body = quatd_mul(body, quatd_from_axis_angle(vec3d(0, 0, 1), shot->heading_rad));
    body = quatd_mul(body, quatd_from_axis_angle(vec3d(1, 0, 0), shot->bank_rad));
    packet.craft = (RenderCraft){true, shot->kind, place, body, shot->pose};
    double azimuth = shot->heading_rad + shot->bearing_rad, level = cos(shot->elevation_rad);
    Vec3d away = local_vector(&local, level * cos(azimuth), level * sin(azimuth), -sin(shot->elevation_rad));
    Vec3d right = local_vector(&local, sin(azimuth), -cos(azimuth), 0.0), up = vec3d_cross(away, right);
    packet.camera = (RenderCamera){vec3d_mad(place, away, shot->distance_m),
                                   {{{right.x, right.y, right.z}, {up.x, up.y, up.z}, {away.x, away.y, away.z}}},
                                   FOV_RAD};
    double low = cos(shot->sun_elevation_rad);
    packet.sun_ecef = local_vector(&local, low * cos(shot->sun_azimuth_rad), low * sin(shot->sun_azimuth_rad),
                                   -sin(shot->sun_elevation_rad));
    return packet;
}

static void draw(Stage *stage, RenderPacket *packet) {
    LodView view = {.eye_ecef = packet->camera.eye_ecef,
                    .forward_ecef = {-packet->camera.camera_from_ecef.m[2][0], -packet->camera.camera_from_ecef.m[2][1],
                                     -packet->camera.camera_from_ecef.m[2][2]},
                    .px_per_rad = stage->height / (2.0 * tan(FOV_RAD * 0.5)),
                    .tau_px = 2.0};
    arena_reset(stage->arena);
    assert_int_equal(lod_update(stage->lod, &view, stage->jobs, stage->arena, &packet->cut), RESULT_OK);
    assert_int_equal(render_frame(stage->renderer, packet, &stage->stats), RESULT_OK);
    lod_release(stage->lod, packet->cut.frame);
    assert_int_equal(render_read_pixels(stage->renderer, stage->rgb), RESULT_OK);
    assert_int_equal(gl_take_error(), GL_NO_ERROR);
}

//TESTS

// --- pictures to look at

static const CraftPose CRUISE = {.propeller_rad = 0.5, .rpm = 2400.0};
static const CraftPose SLOW = {
    .aileron_rad = 0.3, .elevator_rad = 0.35, .rudder_rad = 0.35, .flaps_rad = 0.52, .gear = 1.0, .propeller_rad = 0.6};

static const struct {
    const char *name;
    double bearing_deg, elevation_deg, distance_m, sun_azimuth_deg, sun_elevation_deg;
    bool slow;
} PICTURES[] = {
    {"ahead-right", 40, 12, 14, 20, 40, false},  {"ahead", 2, 3, 13, 60, 35, false},
    {"behind-left", 215, 15, 15, 280, 30, false}, {"behind", 180, 8, 16, 200, 50, true},
    {"above", 150, 70, 17, 100, 45, false},       {"below", 60, -35, 15, 100, 45, true},
    {"right", 90, 0, 13, 120, 30, false},         {"backlit", 120, 5, 15, 300, 12, false},
    {"near-nose", 35, 10, 6, 60, 40, true},       {"near-tail", 205, 14, 8, 140, 40, true},
    {"far", 140, 20, 120, 60, 40, false},         {"very-far", 100, 25, 1000, 60, 40, false},
    {"low-sun", 60, 20, 14, 30, 4, true},
};

static void write_pictures(const char *folder, const char *only) {
    Jobs *jobs = NULL;
    Geoid *geoid = NULL;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    Terrain *terrain = support_shared_terrain("tatra_srtm3_2401.tif", &geoid, jobs);
    assert_non_null(terrain);
    Stage stage = stage_begin(terrain, geoid, jobs, PICTURE_WIDTH, PICTURE_HEIGHT, 4);
    for (size_t i = 0; i < COUNT_OF(PICTURES); i++) {
        for (int kind = 0; kind < CRAFT_KIND_COUNT; kind++) {
            char path[512];
            snprintf(path, sizeof path, "%s/%s-%s.png", folder, craft_shape((CraftKind)kind)->name, PICTURES[i].name);
            if (only && !strstr(path, only))
                continue;
            const Shot shot = {.kind = (CraftKind)kind,
                               .heading_rad = 0.9,
                               .bearing_rad = PICTURES[i].bearing_deg * DEG,
                               .elevation_rad = PICTURES[i].elevation_deg * DEG,
                               .distance_m = PICTURES[i].distance_m,
                               .sun_azimuth_rad = PICTURES[i].sun_azimuth_deg * DEG,
                               .sun_elevation_rad = PICTURES[i].sun_elevation_deg * DEG,
                               .pose = PICTURES[i].slow ? SLOW : CRUISE};
            RenderPacket packet = packet_of(&shot, support_eye(terrain, 1200.0, 1250.0, 900.0));
            draw(&stage, &packet);
            assert_int_equal(image_write_png(path, stage.width, stage.height, 3, stage.rgb), RESULT_OK);
            printf("%s: %.1f ms\n", path, stage.stats.draw_ms);
        }
    }
    stage_end(&stage);
}

int main(int argc, char **argv) {
    Context *context = NULL;
    if (!gl_support_begin(16, 16, &context))
        return GL_SKIP_STATUS;
    if (argc >= 3 && strcmp(argv[1], "--pictures") == 0)
        write_pictures(argv[2], argc > 3 ? argv[3] : NULL);
    context_destroy(&context);
    return 0;
}
