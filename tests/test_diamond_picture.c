// Pictures of diamonds made on the GPU: the same as those of the CPU twin, without pinholes; the budget is kept, at
// once or in the frames that follow, and the numbers told are those of what is drawn.
#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "assets/image.h"
#include "base/arena.h"
#include "cut_support.h"
#include "gl_support.h"
#include "heard.h"
#include "render/diamond/diamond_pass.h"
#include "render/gl.h"
#include "render/render.h"
#include "terrain/diamond/diamond.h"
#include "terrain/geodesy.h"

#define WIDTH 400
#define HEIGHT 260
#define BYTES ((size_t)WIDTH * HEIGHT * 3)
#define DEG GEODESY_RAD_PER_DEG
#define FOV_RAD (60.0 * DEG)
#define SEED UINT64_C(77)

static const DemGeoref ROUGH = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 46.9, 0.0006, -0.0004};

typedef struct Stage {
    Jobs *jobs;
    Terrain *terrain;
    Lod *lods[2]; // of the processor, and resident
    Arena *arena;
    Renderer *renderer;
    RenderStats stats;
    uint8_t *rgb[2];
} Stage;

static Lod *create_lod(const Stage *stage, bool resident, int64_t max_triangles) {
    LodOptions options = lod_default_options();
    Lod *lod = NULL;
    options.method = LOD_DIAMOND;
    options.resident = resident;
    options.serial = resident;
    options.max_triangles = max_triangles;
    assert_int_equal(lod_create(&options, stage->terrain, &lod), RESULT_OK);
    return lod;
}

static Stage stage_begin(int64_t max_triangles) {
    Stage stage = {0};
    assert_int_equal(jobs_create(2, &stage.jobs), RESULT_OK);
    Dem *dem = support_rough_dem(327, 468, &ROUGH, 1300.0, SEED);
    stage.terrain = support_terrain(dem, TERRAIN_ERROR_TOTAL, 12, stage.jobs);
    RenderOptions options = render_default_options();
    options.width = WIDTH;
    options.height = HEIGHT;
    options.samples = 1;
    options.lockstep = true;
    assert_int_equal(render_create(&options, stage.terrain, &stage.renderer), RESULT_OK);
    assert_int_equal(arena_create(1 << 20, &stage.arena), RESULT_OK);
    for (int i = 0; i < 2; i++) {
        stage.lods[i] = create_lod(&stage, i == 1, max_triangles);
        stage.rgb[i] = malloc(BYTES);
        assert_non_null(stage.rgb[i]);
    }
    return stage;
}

static void stage_end(Stage *stage) {
    render_destroy(&stage->renderer);
    for (int i = 0; i < 2; i++) {
        lod_destroy(&stage->lods[i]);
        free(stage->rgb[i]);
    }
    arena_destroy(&stage->arena);
    terrain_destroy(&stage->terrain);
    jobs_destroy(&stage->jobs);
    assert_int_equal(gl_take_error(), GL_NO_ERROR);
}

// Level with the horizon, or so far below it.
static RenderCamera camera_at(const Stage *stage, double across, double down, double above_m, double heading_rad,
                              double below_rad) {
    const Dem *dem = terrain_dem(stage->terrain);
    Vec3d eye = support_eye(stage->terrain, across * dem->width, down * dem->height, above_m);
    Geodetic at = geodesy_from_ecef(eye);
    Mat3d enu = geodesy_enu_from_ecef(at.lat_rad, at.lon_rad);
    double ch = cos(heading_rad), sh = sin(heading_rad), cd = cos(below_rad), sd = sin(below_rad);
    Mat3d level = {{{ch, -sh, 0.0}, {sh * sd, ch * sd, cd}, {-sh * cd, -ch * cd, sd}}}; // right, up, back in ENU
    return (RenderCamera){eye, mat3d_mul(&level, &enu), FOV_RAD};
}

static RenderPacket packet_of(const RenderCamera *camera) {
    Vec3d up = vec3d_normalize(camera->eye_ecef);
    return (RenderPacket){.camera = *camera, .sun_ecef = vec3d_normalize(vec3d_add(up, vec3d(0.2, -0.3, 0.4)))};
}

static LodView view_of(const RenderCamera *camera, double tau_px) {
    const double *back = camera->camera_from_ecef.m[2];
    return (LodView){.eye_ecef = camera->eye_ecef,
                     .forward_ecef = vec3d(-back[0], -back[1], -back[2]),
                     .px_per_rad = HEIGHT / (2.0 * tan(FOV_RAD / 2.0)),
                     .tau_px = tau_px};
}

// Draws the cut of one of the two; its pixels go to rgb.
static LodCut draw(Stage *stage, int which, RenderPacket *packet, double tau_px) {
    LodView view = view_of(&packet->camera, tau_px);
    Result result = lod_update(stage->lods[which], &view, stage->jobs, stage->arena, &packet->cut);
    assert_true(result == RESULT_OK || result == RESULT_BUDGET);
    assert_int_equal(packet->cut.resident != NULL, which);
    assert_int_equal(render_frame(stage->renderer, packet, &stage->stats), RESULT_OK);
    assert_int_equal(render_read_pixels(stage->renderer, stage->rgb[which]), RESULT_OK);
    LodCut cut = packet->cut;
    render_tell_cut(&stage->stats.resident, stage->stats.partial, &cut);
    lod_release(stage->lods[which], cut.frame);
    arena_reset(stage->arena);
    return cut;
}

typedef struct Difference {
    int most;
    int64_t channels; // that differ
} Difference;

static Difference difference_of(const Stage *stage) {
    Difference d = {0, 0};
    for (size_t i = 0; i < BYTES; i++) {
        int here = abs(stage->rgb[0][i] - stage->rgb[1][i]);
        d.most = here > d.most ? here : d.most;
        d.channels += here != 0;
    }
    return d;
}

static int64_t count_magenta(const uint8_t *rgb) {
    int64_t count = 0;
    for (size_t i = 0; i < BYTES; i += 3)
        count += rgb[i] >= 250 && rgb[i + 1] <= 5 && rgb[i + 2] >= 250;
    return count;
}

static void keep_pictures(const Stage *stage) {
    const char *const names[] = {"diamond_cpu.png", "diamond_gpu.png"};
    for (int i = 0; i < 2; i++)
        if (image_write_png(names[i], WIDTH, HEIGHT, 3, stage->rgb[i]) == RESULT_OK)
            print_message("see %s\n", names[i]);
}

// --- pictures

// Edges of triangles would tell the slightest difference in a position: lines are as sharp as pixels. How dark they are
// depends, in the last bits, on which corner of a triangle comes first.
static void both_sides_draw_the_same_positions(void **state) {
    (void)state;
    static const double TAUS[] = {0.5, 1.0, 2.0};
    Stage stage = stage_begin(4000000);
    for (size_t i = 0; i < COUNT_OF(TAUS); i++) {
        RenderCamera camera = camera_at(&stage, 0.4, 0.6, 60.0 + 900.0 * (double)i, 0.7 * (double)i, 0.35);
        RenderPacket packet = packet_of(&camera);
        packet.colouring = RENDER_COLOUR_PARTITION;
        packet.magenta_background = packet.wireframe = true;
        int64_t cpu = draw(&stage, 0, &packet, TAUS[i]).stats.triangles;
        int64_t gpu = draw(&stage, 1, &packet, TAUS[i]).stats.triangles;
        Difference d = difference_of(&stage);
        print_message("tau %g: %" PRId64 " and %" PRId64 " triangles, %" PRId64 " channels differ, by %d at most\n",
                      TAUS[i], cpu, gpu, d.channels, d.most);
        if (d.most > 4)
            keep_pictures(&stage);
        assert_int_equal(gpu, cpu);
        assert_true(d.most <= 4);
        assert_int_equal(count_magenta(stage.rgb[0]), count_magenta(stage.rgb[1]));
    }
    stage_end(&stage);
}

// Noise on the ground is counted from the DEM's corner on one side, from the page's on the other: it rounds
// differently.
static void both_sides_draw_the_same_land(void **state) {
    (void)state;
    Stage stage = stage_begin(4000000);
    for (int i = 0; i < 3; i++) {
        RenderCamera camera = camera_at(&stage, 0.3 + 0.2 * i, 0.5, 80.0 + 700.0 * i, 2.0 * i, 0.2);
        RenderPacket packet = packet_of(&camera);
        draw(&stage, 0, &packet, 1.0);
        draw(&stage, 1, &packet, 1.0);
        Difference d = difference_of(&stage);
        print_message("%" PRId64 " of %zu channels differ, by %d at most\n", d.channels, BYTES, d.most);
        if (d.most > 32 || d.channels > (int64_t)BYTES / 200)
            keep_pictures(&stage);
        assert_true(d.most <= 32);
        assert_true(d.channels <= (int64_t)BYTES / 200);
    }
    stage_end(&stage);
}

static void a_flight_has_no_pinhole(void **state) {
    (void)state;
    Stage stage = stage_begin(4000000);
    int64_t pinholes = 0, triangles = 0;
    for (int frame = 0; frame < 40; frame++) {
        double along = 0.42 + 0.004 * frame; // straight down, so that nothing but land is seen
        RenderCamera camera = camera_at(&stage, 0.5, along, 200.0 + 40.0 * frame, 0.1 * frame, 75.0 * DEG);
        RenderPacket packet = packet_of(&camera);
        packet.colouring = frame % 2 ? RENDER_COLOUR_CACHE : RENDER_COLOUR_PARTITION;
        packet.magenta_background = true;
        triangles += draw(&stage, 1, &packet, 0.4 + 0.1 * (frame % 13)).stats.triangles;
        pinholes += count_magenta(stage.rgb[1]);
    }
    print_message("%" PRId64 " triangles in 40 frames, %" PRId64 " pinholes\n", triangles, pinholes);
    stage_end(&stage);
    assert_int_equal(pinholes, 0);
}

static int count_hues(const uint8_t *rgb) {
    bool seen[4096] = {false};
    int count = 0;
    for (size_t i = 0; i < BYTES; i += 3) {
        int hue = (rgb[i] >> 4) << 8 | (rgb[i + 1] >> 4) << 4 | rgb[i + 2] >> 4;
        count += !seen[hue];
        seen[hue] = true;
    }
    return count;
}

static void levels_have_colours_of_their_own(void **state) {
    (void)state;
    Stage stage = stage_begin(4000000);
    RenderCamera camera = camera_at(&stage, 0.5, 0.5, 700.0, 0.5, 75.0 * DEG);
    RenderPacket packet = packet_of(&camera);
    packet.colouring = RENDER_COLOUR_LEVEL;
    packet.magenta_background = true;
    draw(&stage, 1, &packet, 2.0);
    int hues = count_hues(stage.rgb[1]);
    int64_t pinholes = count_magenta(stage.rgb[1]);
    packet.colouring = RENDER_COLOUR_PARTITION;
    draw(&stage, 1, &packet, 2.0);
    int one = count_hues(stage.rgb[1]);
    print_message("%d colours of levels, %d of partitions\n", hues, one);
    stage_end(&stage);
    assert_int_equal(one, 1);
    assert_true(hues >= 5 && hues <= 20);
    assert_int_equal(pinholes, 0);
}

// --- the budget

// One after the other: a cut of another method ends what a renderer remembers.
static void a_budget_raises_the_tolerance_as_on_the_processor(void **state) {
    (void)state;
    enum { BUDGET = 6000, FRAMES = 6 };
    Stage stage = stage_begin(BUDGET);
    LodCut cuts[2][FRAMES];
    for (int i = 0; i < 2 * FRAMES; i++) {
        int which = i / FRAMES, n = i % FRAMES;
        RenderCamera camera = camera_at(&stage, 0.5, 0.4 + 0.03 * n, 100.0 + 150.0 * n, 0.3, 0.3);
        RenderPacket packet = packet_of(&camera);
        cuts[which][n] = draw(&stage, which, &packet, 0.5);
    }
    for (int i = 0; i < FRAMES; i++) {
        const LodCut *cpu = &cuts[0][i], *gpu = &cuts[1][i];
        print_message("CPU %" PRId64 " triangles at %.3f px, GPU %" PRId64 " at %.3f\n", cpu->stats.triangles,
                      cpu->reached_px, gpu->stats.triangles, gpu->reached_px);
        assert_true(gpu->stats.triangles <= BUDGET && gpu->reached_px > 0.5);
        assert_true(gpu->stats.triangles <= cpu->stats.triangles); // which cuts large ones along its squares
        assert_true(gpu->reached_px == cpu->reached_px);
    }
    assert_int_equal(stage.stats.triangles_drawn, cuts[1][FRAMES - 1].stats.triangles);
    stage_end(&stage);
}

// Without waiting, the first frames are above the budget and the later ones keep it.
static void without_waiting_later_frames_keep_the_budget(void **state) {
    (void)state;
    enum { BUDGET = 6000, FRAMES = 40 };
    Stage stage = stage_begin(BUDGET);
    Ground *ground = NULL;
    DiamondPass *pass = NULL;
    const DiamondPassOptions options = {.software = true, .wait = false, .defines = ""};
    RenderCamera camera = camera_at(&stage, 0.5, 0.5, 100.0, 0.3, 0.3);
    Frame frame = frame_make(&camera, WIDTH, HEIGHT);
    LodView view = view_of(&camera, 0.25);
    assert_int_equal(ground_create(stage.terrain, true, &ground), RESULT_OK);
    assert_int_equal(diamond_pass_create(&options, &pass), RESULT_OK);
    RenderCutStats stats = {0};
    log_set_level(LOG_ERROR);
    for (int i = 0; i < FRAMES; i++) {
        LodCut cut;
        assert_int_equal(lod_update(stage.lods[1], &view, stage.jobs, stage.arena, &cut), RESULT_OK);
        diamond_pass_prepare(pass, &frame, ground, &cut);
        diamond_pass_count(pass, &stats);
        glFinish();
        arena_reset(stage.arena);
    }
    log_set_level(LOG_INFO);
    print_message("%" PRId64 " triangles at %.3f px\n", stats.resident.triangles, stats.resident.reached_px);
    diamond_pass_destroy(&pass);
    ground_destroy(&ground);
    stage_end(&stage);
    assert_true(stats.resident.triangles <= BUDGET && stats.resident.triangles > BUDGET / 3);
    assert_true(stats.resident.reached_px > 0.25 && isfinite(stats.resident.reached_px));
}

// A selection has no tolerance to raise: what there is room for is drawn, and nothing is promised.
static void a_selection_beyond_the_room_promises_nothing(void **state) {
    (void)state;
    Stage stage = stage_begin(1000);
    DiamondSelect *select = NULL;
    assert_int_equal(diamond_select_create("tolerance || level < 99", NULL, &select), RESULT_OK);
    LodOptions options = lod_default_options();
    options.method = LOD_DIAMOND;
    options.resident = true;
    options.serial = 2;
    options.max_triangles = 1000;
    options.select = select;
    lod_destroy(&stage.lods[1]);
    assert_int_equal(lod_create(&options, stage.terrain, &stage.lods[1]), RESULT_OK);
    RenderCamera camera = camera_at(&stage, 0.5, 0.5, 500.0, 0.3, 0.4);
    RenderPacket packet = packet_of(&camera);
    Heard heard;
    heard_begin(&heard);
    LodCut cut = draw(&stage, 1, &packet, 1.0);
    draw(&stage, 1, &packet, 1.0);
    heard_end();
    print_message("%" PRId64 " triangles, said: %s\n", cut.stats.triangles, heard.text);
    int64_t drawn = stage.stats.triangles_drawn;
    stage_end(&stage);
    diamond_select_destroy(&select);
    assert_true(packet.cut.promises && !cut.promises && isinf(cut.reached_px));
    assert_true(drawn > 1000 && drawn < 2 * 326 * 467);
    assert_non_null(strstr(heard.text, "--max-triangles"));
}

// A method changed in flight: memory goes with the last resident cut, and comes back with the next.
static void memory_of_the_gpu_follows_the_cuts(void **state) {
    (void)state;
    Stage stage = stage_begin(100000);
    RenderCamera camera = camera_at(&stage, 0.5, 0.5, 500.0, 0.3, 0.4);
    RenderPacket packet = packet_of(&camera);
    int64_t bytes[4];
    for (int i = 0; i < 4; i++) {
        draw(&stage, i % 2, &packet, 2.0);
        bytes[i] = stage.stats.vram_bytes;
    }
    print_message("%" PRId64 " %" PRId64 " %" PRId64 " %" PRId64 " bytes\n", bytes[0], bytes[1], bytes[2], bytes[3]);
    stage_end(&stage);
    int64_t samples = INT64_C(327) * 468;
    assert_true(bytes[1] > bytes[0] + 30 * samples);
    assert_true(bytes[2] < bytes[1] - 30 * samples && bytes[3] > bytes[2] + 30 * samples);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_sides_draw_the_same_positions),
        cmocka_unit_test(both_sides_draw_the_same_land),
        cmocka_unit_test(a_flight_has_no_pinhole),
        cmocka_unit_test(levels_have_colours_of_their_own),
        cmocka_unit_test(a_budget_raises_the_tolerance_as_on_the_processor),
        cmocka_unit_test(without_waiting_later_frames_keep_the_budget),
        cmocka_unit_test(a_selection_beyond_the_room_promises_nothing),
        cmocka_unit_test(memory_of_the_gpu_follows_the_cuts),
    };
    Context *context = NULL;
    if (!gl_support_begin(WIDTH, HEIGHT, &context))
        return GL_SKIP_STATUS;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    context_destroy(&context);
    return failed;
}
