// An aircraft in the picture: where it should be and of the size it should have, only when it is shown, and the same
// wherever on the Earth. Usage:
//   test_craft_gl                            the tests
//   test_craft_gl --pictures FOLDER [NAME]   writes pictures of each kind from all sides, or those so named, to look at
//   test_craft_gl --times                    what it costs at 1280 x 800
//   test_craft_gl --times-of-shadows         and what its shadow on the ground does
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "assets/image.h"
#include "base/arena.h"
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
    packet.craft = (RenderCraft){true, false, shot->kind, place, body, shot->pose};
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

// --- where it is

static Shot plain_shot(int kind, double distance_m) {
    return (Shot){.kind = (CraftKind)kind,
                  .heading_rad = 0.8,
                  .bank_rad = 0.3,
                  .bearing_rad = 1.9,
                  .elevation_rad = 0.25,
                  .distance_m = distance_m,
                  .sun_azimuth_rad = 2.0,
                  .sun_elevation_rad = 0.8,
                  .pose = {.gear = 1.0, .elevator_rad = 0.2, .flaps_rad = 0.4}};
}

typedef struct Point {
    double x, y; // pixels from the top left corner
} Point;

static Point project(const RenderPacket *packet, Vec3d from_eye) {
    Vec3d at = mat3d_mul_vec(&packet->camera.camera_from_ecef, from_eye);
    double px = HEIGHT / (2.0 * tan(FOV_RAD * 0.5));
    return (Point){0.5 * WIDTH + px * at.x / -at.z, 0.5 * HEIGHT - px * at.y / -at.z};
}

static double side_of(Point a, Point b, Point p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

// Pixels whose middle is inside; both ways round, as a solid's back covers what its front does.
static void fill_triangle(const Point p[3], uint8_t *mask) {
    int left = (int)fmax(floor(fmin(p[0].x, fmin(p[1].x, p[2].x))), 0.0);
    int right = (int)fmin(ceil(fmax(p[0].x, fmax(p[1].x, p[2].x))), WIDTH - 1);
    int top = (int)fmax(floor(fmin(p[0].y, fmin(p[1].y, p[2].y))), 0.0);
    int bottom = (int)fmin(ceil(fmax(p[0].y, fmax(p[1].y, p[2].y))), HEIGHT - 1);
    for (int y = top; y <= bottom; y++) {
        for (int x = left; x <= right; x++) {
            Point at = {x + 0.5, y + 0.5};
            double a = side_of(p[0], p[1], at), b = side_of(p[1], p[2], at), c = side_of(p[2], p[0], at);
            if ((a >= 0.0 && b >= 0.0 && c >= 0.0) || (a <= 0.0 && b <= 0.0 && c <= 0.0))
                mask[y * WIDTH + x] = 1;
        }
    }
}

// What the aircraft covers, by a drawing of the test's own from the same mesh and in double.
static void fill_expected(const RenderPacket *packet, uint8_t *mask) {
    CraftModel model;
    const RenderCraft *craft = &packet->craft;
    Vec3d from_eye = vec3d_sub(craft->position_ecef, packet->camera.eye_ecef);
    assert_int_equal(craft_model_create(craft_shape(craft->kind), &model), RESULT_OK);
    memset(mask, 0, WIDTH * HEIGHT);
    for (int i = 0; i + 2 < model.mesh.index_count; i += 3) {
        Point points[3];
        for (int j = 0; j < 3; j++) {
            const CraftVertex *vertex = &model.mesh.vertices[model.mesh.indices[i + j]];
            const CraftHinge *hinge = &model.hinges[vertex->joint];
            double angle = craft_joint_angle_rad(&model, (CraftJoint)vertex->joint, &craft->pose);
            Vec3d at = vec3d_sub(vec3d(vertex->position[0], vertex->position[1], vertex->position[2]), hinge->at);
            at = vec3d_add(quatd_rotate(quatd_from_axis_angle(hinge->axis, angle), at), hinge->at);
            points[j] = project(packet, vec3d_add(from_eye, quatd_rotate(craft->ecef_from_body, at)));
        }
        bool disc = model.mesh.vertices[model.mesh.indices[i]].finish == CRAFT_DISC;
        if (!disc)
            fill_triangle(points, mask);
    }
    craft_model_free(&model);
}

typedef struct Overlap {
    int expected, found, differing;
} Overlap;

static Overlap compare_with_expected(Stage *stage, RenderPacket *packet) {
    uint8_t *empty = malloc(WIDTH * HEIGHT * 3), *mask = malloc(WIDTH * HEIGHT);
    assert_true(empty && mask);
    packet->craft.show = false;
    draw(stage, packet);
    memcpy(empty, stage->rgb, WIDTH * HEIGHT * 3);
    packet->craft.show = true;
    draw(stage, packet);
    fill_expected(packet, mask);
    Overlap overlap = {0};
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        bool found = memcmp(empty + i * 3, stage->rgb + i * 3, 3) != 0;
        overlap.expected += mask[i];
        overlap.found += found;
        overlap.differing += found != (mask[i] != 0);
    }
    free(empty);
    free(mask);
    return overlap;
}

static void it_covers_the_pixels_it_should(void **state) {
    (void)state;
    static const DemGeoref elsewhere = {
        .crs = DEM_CRS_GEOGRAPHIC, .x0 = 179.93, .y0 = 0.05, .dx = 1.0 / 1200, .dy = -1.0 / 1200};
    const DemGeoref *georefs[] = {&GEOREF, &elsewhere}; // the latter on the equator, up to the antimeridian
    for (size_t place = 0; place < COUNT_OF(georefs); place++) {
        Stage stage = stage_rough(georefs[place]);
        for (int kind = 0; kind < CRAFT_KIND_COUNT; kind++) {
            for (double distance_m = 20.0; distance_m < 50.0; distance_m += 20.0) {
                const Shot shot = plain_shot(kind, distance_m);
                RenderPacket packet = packet_of(&shot, support_eye(stage.terrain, 64.0, 64.0, 1500.0));
                Overlap overlap = compare_with_expected(&stage, &packet);
                print_message("%s at %.0f m: %d pixels, %d expected, %d differ\n", craft_shape(shot.kind)->name,
                              distance_m, overlap.found, overlap.expected, overlap.differing);
                assert_true(overlap.expected > 300);
                assert_true(overlap.differing <= overlap.expected / 50);
            }
        }
        stage_end(&stage);
    }
}

static void the_ground_hides_it(void **state) {
    (void)state;
    Stage stage = stage_rough(&GEOREF);
    Shot shot = plain_shot(CRAFT_C172, 100.0);
    shot.elevation_rad = 1.2;
    RenderPacket packet = packet_of(&shot, support_eye(stage.terrain, 64.0, 64.0, -60.0));
    Overlap overlap = compare_with_expected(&stage, &packet);
    print_message("%d pixels of an aircraft under the ground, %d without a ground\n", overlap.found, overlap.expected);
    assert_true(overlap.expected > 100);
    assert_int_equal(overlap.found, 0);
    stage_end(&stage);
}

// --- what it costs

static void not_shown_it_costs_nothing(void **state) {
    (void)state;
    const size_t bytes = (size_t)WIDTH * HEIGHT * 3;
    Stage plain = stage_rough(&GEOREF), stage = stage_rough(&GEOREF);
    const Shot shot = plain_shot(CRAFT_JET_TRAINER, 25.0);
    RenderPacket packet = packet_of(&shot, support_eye(stage.terrain, 64.0, 64.0, 1500.0)), without = packet;
    memset(&without.craft, 0, sizeof without.craft);
    draw(&plain, &without);
    packet.craft.show = false;
    int before = gl_support_programs();
    draw(&stage, &packet);
    int hidden = gl_support_programs() - before;
    assert_memory_equal(plain.rgb, stage.rgb, bytes);
    packet.craft.show = true;
    draw(&stage, &packet);
    int shown = gl_support_programs() - before;
    assert_memory_not_equal(plain.rgb, stage.rgb, bytes);
    packet.craft.show = false;
    draw(&stage, &packet); // and leaves nothing behind
    assert_memory_equal(plain.rgb, stage.rgb, bytes);
    print_message("programs made: %d while hidden, %d when shown\n", hidden, shown);
    assert_int_equal(hidden, 0);
    assert_true(shown > 0);
    stage_end(&plain);
    stage_end(&stage);
}

static void one_pose_has_one_picture(void **state) {
    (void)state;
    const size_t bytes = (size_t)WIDTH * HEIGHT * 3;
    Stage first = stage_rough(&GEOREF), second = stage_rough(&GEOREF);
    for (int kind = 0; kind < CRAFT_KIND_COUNT; kind++) { // the second has shown others, with a turning propeller
        Shot other = plain_shot(kind, 30.0);
        other.pose.rpm = 2000.0;
        RenderPacket packet = packet_of(&other, support_eye(second.terrain, 60.0, 64.0, 1500.0));
        packet.wireframe = kind == 1;
        draw(&second, &packet);
    }
    Shot shot = plain_shot(CRAFT_C172, 14.0);
    shot.pose.rpm = 1000.0;
    RenderPacket packet = packet_of(&shot, support_eye(first.terrain, 64.0, 64.0, 1500.0));
    draw(&first, &packet);
    draw(&second, &packet);
    assert_memory_equal(first.rgb, second.rgb, bytes);
    stage_end(&first);
    stage_end(&second);
}

// Its sunny side is the brighter one.
static double mean_brightness(Stage *stage, double sun_azimuth_rad) {
    Shot shot = plain_shot(CRAFT_GLIDER, 20.0);
    shot.bank_rad = 0.0;
    shot.elevation_rad = 0.0;
    shot.bearing_rad = 90.0 * DEG;
    shot.sun_azimuth_rad = sun_azimuth_rad;
    shot.sun_elevation_rad = 0.35;
    RenderPacket packet = packet_of(&shot, support_eye(stage->terrain, 64.0, 64.0, 1500.0));
    uint8_t *mask = malloc(WIDTH * HEIGHT);
    assert_non_null(mask);
    draw(stage, &packet);
    fill_expected(&packet, mask);
    double sum = 0.0;
    int count = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        sum += mask[i] ? stage->rgb[i * 3] : 0.0;
        count += mask[i];
    }
    free(mask);
    return sum / count;
}

static void it_is_brighter_towards_the_sun(void **state) {
    (void)state;
    Stage stage = stage_rough(&GEOREF);
    double heading = plain_shot(CRAFT_GLIDER, 20.0).heading_rad;
    double lit = mean_brightness(&stage, heading + 90.0 * DEG), shade = mean_brightness(&stage, heading - 90.0 * DEG);
    print_message("red, of 255: %.1f in the sun, %.1f against it\n", lit, shade);
    assert_true(lit > shade + 30.0);
    stage_end(&stage);
}

// Of the pixel where a point of the aircraft is seen; body axes.
static double brightness_at(const Stage *stage, const RenderPacket *packet, Vec3d body) {
    Vec3d from_eye = vec3d_sub(packet->craft.position_ecef, packet->camera.eye_ecef);
    Point at = project(packet, vec3d_add(from_eye, quatd_rotate(packet->craft.ecef_from_body, body)));
    const uint8_t *pixel = stage->rgb + ((size_t)at.y * WIDTH + (size_t)at.x) * 3;
    return (pixel[0] + pixel[1] + pixel[2]) / 3.0;
}

// The sun 45 degrees up on the right: the wing shades the door, the cowling ahead of it is in the sun.
static void the_wing_throws_a_shadow(void **state) {
    (void)state;
    Stage stage = stage_rough(&GEOREF);
    Shot shot = plain_shot(CRAFT_C172, 14.0);
    shot.bank_rad = 0.0;
    shot.elevation_rad = -0.1;
    shot.bearing_rad = 90.0 * DEG;
    shot.sun_azimuth_rad = shot.heading_rad + 90.0 * DEG;
    shot.sun_elevation_rad = 45.0 * DEG;
    RenderPacket packet = packet_of(&shot, support_eye(stage.terrain, 64.0, 64.0, 1500.0));
    draw(&stage, &packet);
    double door = brightness_at(&stage, &packet, vec3d(-0.15, 0.54, 0.25));
    double cowling = brightness_at(&stage, &packet, vec3d(1.55, 0.49, 0.25));
    print_message("of 255: door %.0f, cowling %.0f\n", door, cowling);
    assert_true(cowling > door + 30.0);
    stage_end(&stage);
}

// --- pictures to look at

static const CraftPose CRUISE = {.propeller_rad = 0.5, .rpm = 2400.0};
static const CraftPose SLOW = {
    .aileron_rad = 0.3, .elevator_rad = 0.35, .rudder_rad = 0.35, .flaps_rad = 0.52, .gear = 1.0, .propeller_rad = 0.6};

static const struct {
    const char *name;
    double bearing_deg, elevation_deg, distance_m, sun_azimuth_deg, sun_elevation_deg;
    bool slow;
} PICTURES[] = {
    {"ahead-right", 40, 12, 14, 20, 40, false},   {"ahead", 2, 3, 13, 60, 35, false},
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

// Processor time, milliseconds: with LP_NUM_THREADS=1 it tells the same on a busy machine as on an idle one.
static double frame_ms(Stage *stage, RenderPacket *packet) {
    clock_t begin = clock();
    draw(stage, packet);
    return 1e3 * (double)(clock() - begin) / CLOCKS_PER_SEC;
}

// Of the shortest of some frames.
static double best_ms(Stage *stage, RenderPacket *packet, bool show) {
    double best = 1e9;
    packet->craft.show = show;
    for (int i = 0; i < 15; i++)
        best = fmin(best, frame_ms(stage, packet));
    return best;
}

// Seen as from a chasing camera, so high above the ground: what the shadow costs, frame by frame beside those without.
static void print_shadow_times(Stage *stage, double above_m) {
    Shot shot = plain_shot(CRAFT_C172, 27.0);
    shot.bank_rad = 0.0;
    shot.bearing_rad = 180.0 * DEG;
    shot.elevation_rad = 15.0 * DEG;
    shot.sun_azimuth_rad = shot.heading_rad + 180.0 * DEG;
    shot.sun_elevation_rad = 70.0 * DEG;
    RenderPacket packet = packet_of(&shot, support_eye(stage->terrain, 1200.0, 1250.0, above_m));
    double with = 1e9, without = 1e9;
    for (int i = 0; i < 10; i++) {
        packet.craft.casts = true;
        with = fmin(with, frame_ms(stage, &packet));
        packet.craft.casts = false;
        without = fmin(without, frame_ms(stage, &packet));
    }
    printf("its shadow from %.0f m: %.1f ms, %.1f without\n", above_m, with, without);
}

static Stage stage_tatra(void) {
    Jobs *jobs = NULL;
    Geoid *geoid = NULL;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    Terrain *terrain = support_shared_terrain("tatra_srtm3_2401.tif", &geoid, jobs);
    assert_non_null(terrain);
    return stage_begin(terrain, geoid, jobs, PICTURE_WIDTH, PICTURE_HEIGHT, 1);
}

static void print_times_of_shadows(void) {
    static const double heights_m[] = {1.3, 20.0, 60.0, 300.0, 2000.0};
    Stage stage = stage_tatra();
    for (size_t i = 0; i < COUNT_OF(heights_m); i++)
        print_shadow_times(&stage, heights_m[i]);
    stage_end(&stage);
}

static void print_times(void) {
    Stage stage = stage_tatra();
    static const double distances_m[] = {6.0, 14.0, 40.0, 120.0, 2000.0};
    for (int kind = 0; kind < CRAFT_KIND_COUNT; kind++) {
        for (size_t i = 0; i < COUNT_OF(distances_m); i++) {
            const Shot shot = plain_shot(kind, distances_m[i]);
            RenderPacket packet = packet_of(&shot, support_eye(stage.terrain, 1200.0, 1250.0, 900.0));
            double with = best_ms(&stage, &packet, true), without = best_ms(&stage, &packet, false);
            printf("%s at %.0f m: %.1f ms, %.1f without\n", craft_shape(shot.kind)->name, distances_m[i], with,
                   without);
        }
    }
    stage_end(&stage);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_covers_the_pixels_it_should), cmocka_unit_test(the_ground_hides_it),
        cmocka_unit_test(not_shown_it_costs_nothing),     cmocka_unit_test(one_pose_has_one_picture),
        cmocka_unit_test(it_is_brighter_towards_the_sun), cmocka_unit_test(the_wing_throws_a_shadow),
    };
    Context *context = NULL;
    int failed = 0;
    if (!gl_support_begin(16, 16, &context))
        return GL_SKIP_STATUS;
    if (argc >= 3 && strcmp(argv[1], "--pictures") == 0)
        write_pictures(argv[2], argc > 3 ? argv[3] : NULL);
    else if (argc == 2 && strcmp(argv[1], "--times") == 0)
        print_times();
    else if (argc == 2 && strcmp(argv[1], "--times-of-shadows") == 0)
        print_times_of_shadows();
    else
        failed = cmocka_run_group_tests(tests, NULL, NULL);
    context_destroy(&context);
    return failed;
}
