// Whole frames: no pinhole, one picture for one view, voids and draped images where they belong, and memory that runs
// out.
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "assets/image.h"
#include "base/arena.h"
#include "render/gl.h"
#include "render/render.h"
#include "terrain/geodesy.h"
#include "tests/cut_support.h"
#include "tests/gl_support.h"
#include "tests/heard.h"

#define WIDTH 640
#define HEIGHT 400
#define BYTES ((size_t)WIDTH * HEIGHT * 3)
#define DEG GEODESY_RAD_PER_DEG
#define FOV_RAD (60.0 * DEG)

static const DemGeoref GEOREF = {
    .crs = DEM_CRS_GEOGRAPHIC, .x0 = 20.0, .y0 = 49.5, .dx = 1.0 / 1200, .dy = -1.0 / 1200};

typedef struct Stage {
    Jobs *jobs;
    Terrain *terrain;
    Geoid *geoid;
    Lod *lod;
    Arena *arena;
    Renderer *renderer;
    RenderStats stats;
    uint8_t *rgb;
} Stage;

static RenderOptions options_for_tests(void) {
    RenderOptions options = render_default_options();
    options.width = WIDTH;
    options.height = HEIGHT;
    options.samples = 1;
    options.vram_bytes_max = (size_t)64 << 20;
    return options;
}

static Stage stage_begin(Terrain *terrain, Jobs *jobs, const RenderOptions *options) {
    Stage stage = {.jobs = jobs, .terrain = terrain};
    const LodOptions lod_options = lod_default_options();
    assert_int_equal(lod_create(&lod_options, terrain, &stage.lod), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &stage.arena), RESULT_OK);
    assert_int_equal(render_create(options, terrain, &stage.renderer), RESULT_OK);
    stage.rgb = malloc(BYTES);
    assert_non_null(stage.rgb);
    return stage;
}

static Stage stage_rough_with(int side, double relief_m, int patch_level, const RenderOptions *options) {
    Jobs *jobs = NULL;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    Dem *dem = support_rough_dem(side, side, &GEOREF, relief_m, 11);
    return stage_begin(support_terrain(dem, TERRAIN_ERROR_TOTAL, patch_level, jobs), jobs, options);
}

static Stage stage_rough(int side, double relief_m, const RenderOptions *options) {
    return stage_rough_with(side, relief_m, 12, options);
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

// Over a place of the grid, looking along a heading and down by `down_rad`.
static RenderPacket packet_at(const Stage *stage, double col, double row, double above_m, double heading_rad,
                              double down_rad) {
    RenderPacket packet;
    memset(&packet, 0, sizeof packet);
    Vec3d eye = support_eye(stage->terrain, col, row, above_m);
    Geodetic at = geodesy_from_ecef(eye);
    Mat3d enu = geodesy_enu_from_ecef(at.lat_rad, at.lon_rad);
    Vec3d east = {enu.m[0][0], enu.m[0][1], enu.m[0][2]}, north = {enu.m[1][0], enu.m[1][1], enu.m[1][2]};
    Vec3d up = {enu.m[2][0], enu.m[2][1], enu.m[2][2]};
    Vec3d level = vec3d_mad(vec3d_scale(north, cos(heading_rad)), east, sin(heading_rad));
    Vec3d right = vec3d_mad(vec3d_scale(east, cos(heading_rad)), north, -sin(heading_rad));
    Vec3d ahead = vec3d_mad(vec3d_scale(level, cos(down_rad)), up, -sin(down_rad)), top = vec3d_cross(right, ahead);
    packet.camera = (RenderCamera){
        eye, {{{right.x, right.y, right.z}, {top.x, top.y, top.z}, {-ahead.x, -ahead.y, -ahead.z}}}, FOV_RAD};
    packet.sun_ecef = vec3d_normalize(vec3d_add(vec3d_add(up, vec3d_scale(east, 0.7)), vec3d_scale(north, -0.4)));
    return packet;
}

static void draw(Stage *stage, RenderPacket *packet, double tau_px) {
    LodView view = {.eye_ecef = packet->camera.eye_ecef,
                    .forward_ecef = {-packet->camera.camera_from_ecef.m[2][0], -packet->camera.camera_from_ecef.m[2][1],
                                     -packet->camera.camera_from_ecef.m[2][2]},
                    .px_per_rad = HEIGHT / (2.0 * tan(FOV_RAD * 0.5)),
                    .tau_px = tau_px};
    arena_reset(stage->arena);
    assert_int_equal(lod_update(stage->lod, &view, stage->jobs, stage->arena, &packet->cut), RESULT_OK);
    assert_int_equal(render_frame(stage->renderer, packet, &stage->stats), RESULT_OK);
    lod_release(stage->lod, packet->cut.frame);
    assert_int_equal(render_read_pixels(stage->renderer, stage->rgb), RESULT_OK);
    assert_int_equal(gl_take_error(), GL_NO_ERROR);
}

static bool is_magenta(const uint8_t *pixel) {
    return pixel[0] == 255 && pixel[1] == 0 && pixel[2] == 255;
}

// Magenta with terrain above it in the same column: below the skyline every pixel must be covered.
static int count_pinholes(const uint8_t *rgb) {
    int pinholes = 0;
    for (int x = 0; x < WIDTH; x++) {
        bool below_skyline = false;
        for (int y = 0; y < HEIGHT; y++) {
            bool open = is_magenta(rgb + ((size_t)y * WIDTH + (size_t)x) * 3);
            pinholes += open && below_skyline;
            below_skyline = below_skyline || !open;
        }
    }
    return pinholes;
}

// Flies low and high over the middle of the data, where no edge of them is in view below the skyline.
static int fly_and_count(Stage *stage, int side, int frames, double above_m) {
    int pinholes = 0;
    for (int frame = 0; frame < frames; frame++) {
        double along = (double)frame / frames, place = side * (0.3 + 0.25 * along);
        RenderPacket packet =
            packet_at(stage, place, side * 0.4 + place * 0.1, above_m * (1.0 + along), 0.6 + along, 0.5);
        packet.magenta_background = true;
        draw(stage, &packet, 0.7 + 2.0 * along);
        pinholes += count_pinholes(stage->rgb);
    }
    return pinholes;
}

static void a_flight_over_magenta_has_no_pinhole(void **state) {
    (void)state;
    const RenderOptions options = options_for_tests();
    Stage stage = stage_rough(700, 1500.0, &options);
    int low = fly_and_count(&stage, 700, 30, 80.0), high = fly_and_count(&stage, 700, 20, 3000.0);
    print_message("pinholes: %d low, %d high\n", low, high);
    stage_end(&stage);
    assert_int_equal(low + high, 0);
}

static void a_flight_over_the_tatras_has_no_pinhole(void **state) {
    (void)state;
    Jobs *jobs = NULL;
    Geoid *geoid = NULL;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    Terrain *terrain = support_shared_terrain("tatra_srtm3_2401.tif", &geoid, jobs);
    if (!terrain) {
        print_message("skipped: ../shared/dem/tatra_srtm3_2401.tif is not there\n");
        jobs_destroy(&jobs);
        skip();
    }
    const RenderOptions options = options_for_tests();
    Stage stage = stage_begin(terrain, jobs, &options);
    stage.geoid = geoid;
    int pinholes = fly_and_count(&stage, 2401, 60, 150.0);
    print_message("pinholes: %d\n", pinholes);
    stage_end(&stage);
    assert_int_equal(pinholes, 0);
}

static void one_view_has_one_picture(void **state) {
    (void)state;
    const RenderOptions options = options_for_tests();
    Stage first = stage_rough(257, 1500.0, &options), second = stage_rough(257, 1500.0, &options);
    // The second has flown elsewhere before, and comes with other colours.
    for (int i = 0; i < 5; i++) {
        RenderPacket other = packet_at(&second, 30.0 + i * 20.0, 200.0, 900.0 + 500.0 * i, i, 0.3);
        other.colouring = (RenderColouring)(i % RENDER_COLOURING_COUNT);
        other.wireframe = i == 3;
        draw(&second, &other, 3.0);
    }
    RenderPacket packet = packet_at(&first, 128.0, 128.0, 1000.0, 1.0, 0.2);
    draw(&first, &packet, 1.0);
    draw(&second, &packet, 1.0);
    assert_memory_equal(first.rgb, second.rgb, BYTES);
    stage_end(&first);
    stage_end(&second);
}

static void the_sky_is_blue_and_pales_towards_the_horizon(void **state) {
    (void)state;
    const RenderOptions options = options_for_tests();
    Stage stage = stage_rough(65, 100.0, &options);
    RenderPacket packet = packet_at(&stage, 32.0, 32.0, 1500.0, 4.0, 0.0);
    draw(&stage, &packet, 2.0);
    const uint8_t *top = stage.rgb + WIDTH / 2 * 3,
                  *low = stage.rgb + ((size_t)(HEIGHT * 46 / 100) * WIDTH + WIDTH / 2) * 3;
    print_message("top %d %d %d, above the horizon %d %d %d\n", top[0], top[1], top[2], low[0], low[1], low[2]);
    assert_true(top[2] > top[1] && top[1] > top[0]);
    assert_true(low[0] > top[0] + 40 && low[2] - low[0] < top[2] - top[0]);
    stage_end(&stage);
}

// The last good cut while a finer one does not fit, and a word about it.
static void a_cut_too_large_for_the_memory_leaves_the_last_one(void **state) {
    (void)state;
    RenderOptions options = options_for_tests();
    options.vram_bytes_max = (size_t)4 << 20;
    Stage stage = stage_rough_with(1025, 3000.0, 8, &options);
    uint8_t *before = malloc(BYTES);
    assert_non_null(before);
    RenderPacket packet = packet_at(&stage, 512.0, 512.0, 3000.0, 1.0, 0.3);
    draw(&stage, &packet, 150.0);
    memcpy(before, stage.rgb, BYTES);
    int64_t patches = stage.stats.patches_drawn;
    Heard heard;
    heard_begin(&heard);
    draw(&stage, &packet, 0.04);
    draw(&stage, &packet, 0.04);
    heard_end();
    print_message("%lld patches kept; said: %s", (long long)patches, heard.text);
    assert_int_equal(heard.warnings, 1);
    assert_non_null(strstr(heard.text, "limit"));
    assert_int_equal(stage.stats.patches_drawn, patches);
    assert_true(stage.stats.partial);
    assert_memory_equal(before, stage.rgb, BYTES);
    draw(&stage, &packet, 100.0); // and recovers
    assert_false(stage.stats.partial);
    assert_memory_not_equal(before, stage.rgb, BYTES);
    free(before);
    stage_end(&stage);
}

// A small memory holds what is in view of a cut that it does not hold as a whole: the same picture as with plenty.
static void what_is_in_view_is_enough(void **state) {
    (void)state;
    RenderOptions options = options_for_tests();
    Stage plenty = stage_rough(1025, 3000.0, &options);
    options.vram_bytes_max = (size_t)5 << 20;
    Stage small = stage_rough(1025, 3000.0, &options);
    Heard heard;
    heard_begin(&heard);
    for (int i = 0; i < 12; i++) { // turning round, so that everything goes in and out
        RenderPacket packet = packet_at(&plenty, 512.0, 512.0, 3000.0, 0.5 * i, 0.35);
        draw(&plenty, &packet, 1.5);
        draw(&small, &packet, 1.5);
        assert_memory_equal(plenty.rgb, small.rgb, BYTES);
        assert_false(small.stats.partial);
    }
    heard_end();
    print_message("%s", heard.text);
    assert_int_equal(heard.warnings, 1);
    assert_non_null(strstr(heard.text, "in view"));
    stage_end(&plenty);
    stage_end(&small);
}

static void a_first_cut_too_large_is_drawn_in_part(void **state) {
    (void)state;
    RenderOptions options = options_for_tests();
    options.vram_bytes_max = (size_t)4 << 20;
    Stage stage = stage_rough(1025, 3000.0, &options);
    RenderPacket packet = packet_at(&stage, 512.0, 512.0, 3000.0, 1.0, 0.6);
    Heard heard;
    heard_begin(&heard);
    draw(&stage, &packet, 0.1);
    heard_end();
    print_message("%lld patches drawn; said: %s", (long long)stage.stats.patches_drawn, heard.text);
    assert_int_equal(heard.warnings, 1);
    assert_true(stage.stats.patches_drawn > 0 && stage.stats.partial);
    LodCut told = {.promises = true};
    render_tell_cut(&stage.stats.resident, stage.stats.partial, &told);
    assert_false(told.promises);
    stage_end(&stage);
}

static void voids_are_holes_where_asked_for(void **state) {
    (void)state;
    Jobs *jobs = NULL;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    Dem *dem = support_rough_dem(129, 129, &GEOREF, 50.0, 3);
    dem->void_bits = calloc(1, (129 * 129 + 7) / 8);
    assert_non_null(dem->void_bits);
    for (int row = 60; row < 70; row++)
        for (int col = 60; col < 70; col++)
            dem->void_bits[(row * 129 + col) >> 3] |= (uint8_t)(1 << ((row * 129 + col) & 7));
    const RenderOptions options = options_for_tests();
    Stage stage = stage_begin(support_terrain(dem, TERRAIN_ERROR_TOTAL, 12, jobs), jobs, &options);
    RenderPacket packet = packet_at(&stage, 64.5, 64.5, 3000.0, 0.0, 90.0 * DEG);
    packet.magenta_background = true;
    draw(&stage, &packet, 0.5);
    int open = 0, middle_open = 0;
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            bool magenta = is_magenta(stage.rgb + ((size_t)y * WIDTH + (size_t)x) * 3);
            open += magenta;
            middle_open += magenta && abs(x - WIDTH / 2) < 40 && abs(y - HEIGHT / 2) < 60;
        }
    }
    // Ten by ten cells of 60.6 m by 92.7 m, from 3000 m less the relief.
    double px_per_m = HEIGHT / (2.0 * tan(FOV_RAD * 0.5)) / 3000.0, expected = 606.0 * 927.0 * px_per_m * px_per_m;
    print_message("%d open pixels, %d of them in the middle, about %.0f expected\n", open, middle_open, expected);
    assert_true(fabs(open - expected) < 0.08 * expected);
    assert_true(open > 0 && middle_open > 0);
    stage_end(&stage);
}

// --- memory: this program's own allocations, counted while a frame is drawn (see tests/CMakeLists.txt)

static struct {
    bool counting;
    int allocations;
} memory;

void *__real_malloc(size_t bytes);
void *__real_calloc(size_t count, size_t bytes);
void *__real_realloc(void *block, size_t bytes);
void *__wrap_malloc(size_t bytes);
void *__wrap_calloc(size_t count, size_t bytes);
void *__wrap_realloc(void *block, size_t bytes);

void *__wrap_malloc(size_t bytes) {
    memory.allocations += memory.counting;
    return __real_malloc(bytes);
}

void *__wrap_calloc(size_t count, size_t bytes) {
    memory.allocations += memory.counting;
    return __real_calloc(count, bytes);
}

void *__wrap_realloc(void *block, size_t bytes) {
    memory.allocations += memory.counting;
    return __real_realloc(block, bytes);
}

static void a_frame_allocates_nothing_after_the_first_flight(void **state) {
    (void)state;
    const RenderOptions options = options_for_tests();
    Stage stage = stage_rough(513, 1500.0, &options);
    for (int flight = 0; flight < 2; flight++) {
        for (int frame = 0; frame < 40; frame++) {
            RenderPacket packet = packet_at(&stage, 150.0 + 4.0 * frame, 250.0, 400.0, 0.1 * frame, 0.2);
            LodView view = {.eye_ecef = packet.camera.eye_ecef,
                            .forward_ecef = {1.0, 0.0, 0.0},
                            .px_per_rad = HEIGHT / (2.0 * tan(FOV_RAD * 0.5)),
                            .tau_px = 1.0};
            arena_reset(stage.arena);
            assert_int_equal(lod_update(stage.lod, &view, stage.jobs, stage.arena, &packet.cut), RESULT_OK);
            memory.counting = flight == 1;
            assert_int_equal(render_frame(stage.renderer, &packet, &stage.stats), RESULT_OK);
            memory.counting = false;
            lod_release(stage.lod, packet.cut.frame);
        }
    }
    print_message("%d allocations\n", memory.allocations);
    stage_end(&stage);
    assert_int_equal(memory.allocations, 0);
}

// Left half red, right half blue.
static void write_two_colours(const char *path) {
    uint8_t pixels[64][64][3];
    for (int y = 0; y < 64; y++)
        for (int x = 0; x < 64; x++) {
            pixels[y][x][0] = x < 32 ? 200 : 20;
            pixels[y][x][1] = 20;
            pixels[y][x][2] = x < 32 ? 20 : 200;
        }
    assert_int_equal(image_write_png(path, 64, 64, 3, &pixels[0][0][0]), RESULT_OK);
}

static void a_draped_image_lies_in_its_bounds(void **state) {
    (void)state;
    char folder[] = "/tmp/overfly-drape-XXXXXX", path[64];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/two.png", folder);
    write_two_colours(path);
    RenderOptions options = options_for_tests();
    options.image_path = path;
    options.image_bounds_given = true;
    options.image_west_deg = 20.0;
    options.image_east_deg = 20.0 + 128.0 / 1200;
    options.image_north_deg = 49.5;
    options.image_south_deg = 49.5 - 128.0 / 1200;
    Stage stage = stage_rough(129, 20.0, &options);
    RenderPacket packet = packet_at(&stage, 64.0, 64.0, 3000.0, 0.0, 90.0 * DEG);
    draw(&stage, &packet, 1.0);
    const uint8_t *left = stage.rgb + ((size_t)HEIGHT / 2 * WIDTH + WIDTH / 2 - 40) * 3, *right = left + 80 * 3;
    print_message("left %d %d %d, right %d %d %d\n", left[0], left[1], left[2], right[0], right[1], right[2]);
    assert_true(left[0] > left[2] + 30);
    assert_true(right[2] > right[0] + 30);
    stage_end(&stage);
    remove(path);
    rmdir(folder);
}

static void an_image_without_a_place_is_refused(void **state) {
    (void)state;
    char folder[] = "/tmp/overfly-drape-XXXXXX", path[64];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/two.png", folder);
    write_two_colours(path);
    RenderOptions options = options_for_tests();
    options.image_path = path;
    Jobs *jobs = NULL;
    Renderer *renderer = NULL;
    assert_int_equal(jobs_create(1, &jobs), RESULT_OK);
    Terrain *terrain = support_terrain(support_rough_dem(33, 33, &GEOREF, 20.0, 1), TERRAIN_ERROR_TOTAL, 8, jobs);
    Heard heard;
    heard_begin(&heard);
    assert_int_equal(render_create(&options, terrain, &renderer), RESULT_UNSUPPORTED);
    options.image_bounds_given = true; // all zero
    assert_int_equal(render_create(&options, terrain, &renderer), RESULT_RANGE);
    heard_end();
    print_message("%s", heard.text);
    assert_non_null(strstr(heard.text, "two.png"));
    assert_null(renderer);
    terrain_destroy(&terrain);
    jobs_destroy(&jobs);
    remove(path);
    rmdir(folder);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_flight_over_magenta_has_no_pinhole),
        cmocka_unit_test(a_flight_over_the_tatras_has_no_pinhole),
        cmocka_unit_test(one_view_has_one_picture),
        cmocka_unit_test(the_sky_is_blue_and_pales_towards_the_horizon),
        cmocka_unit_test(a_cut_too_large_for_the_memory_leaves_the_last_one),
        cmocka_unit_test(what_is_in_view_is_enough),
        cmocka_unit_test(a_first_cut_too_large_is_drawn_in_part),
        cmocka_unit_test(a_frame_allocates_nothing_after_the_first_flight),
        cmocka_unit_test(voids_are_holes_where_asked_for),
        cmocka_unit_test(a_draped_image_lies_in_its_bounds),
        cmocka_unit_test(an_image_without_a_place_is_refused),
    };
    Context *context = NULL;
    if (!gl_support_begin(WIDTH, HEIGHT, &context))
        return GL_SKIP_STATUS;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    context_destroy(&context);
    return failed;
}
