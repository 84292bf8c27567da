// Flights with caching over a magenta background, from update to pixels: while only land can be seen, no pixel may
// show what is behind it. That only land can be seen is computed for each frame, not assumed.
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
#include "render/gl.h"
#include "render/render.h"
#include "terrain/geodesy.h"

#define WIDTH 480
#define HEIGHT 300
#define PIXELS ((size_t)WIDTH * HEIGHT)
#define DEG GEODESY_RAD_PER_DEG
#define SEED UINT64_C(2026)
#define FRAMES 300

static const DemGeoref ROUGH = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 46.9, 0.0006, -0.0004};

// --- where the flight is, and whether it sees nothing but land

typedef struct Sight {
    double col, row, above_m; // above the highest sample around
    double heading_rad, down_rad, bank_rad, fov_y_rad, tau_px;
} Sight;

typedef struct Land {
    const Terrain *terrain;
    double below_m; // lower than anything drawn
} Land;

static Land land_of(const Terrain *terrain) {
    const Dem *dem = terrain_dem(terrain);
    double lowest = INFINITY;
    for (size_t i = 0; i < (size_t)dem->width * (size_t)dem->height; i++)
        lowest = fmin(lowest, (double)dem->height_m[i]);
    return (Land){terrain, lowest - 100.0}; // chords of 20 km lie 8 m under the sphere
}

static double highest_around(const Dem *dem, double col, double row) {
    double highest = -INFINITY;
    for (int r = (int)row - 3; r <= (int)row + 4; r++)
        for (int c = (int)col - 3; c <= (int)col + 4; c++)
            highest = fmax(highest, (double)dem->height_m[(size_t)r * (size_t)dem->width + (size_t)c]);
    return highest;
}

static RenderCamera camera_of(const Land *land, const Sight *sight) {
    double lat, lon, h = highest_around(terrain_dem(land->terrain), sight->col, sight->row) + sight->above_m;
    grid_geodetic(terrain_grid(land->terrain), sight->col, sight->row, &lat, &lon);
    lat *= DEG, lon *= DEG;
    Mat3d enu = geodesy_enu_from_ecef(lat, lon);
    double ch = cos(sight->heading_rad), sh = sin(sight->heading_rad), cd = cos(sight->down_rad);
    double sd = sin(sight->down_rad), cb = cos(sight->bank_rad), sb = sin(sight->bank_rad);
    Mat3d level = {{{ch, -sh, 0.0}, {sh * sd, ch * sd, cd}, {-sh * cd, -ch * cd, sd}}}; // right, up, back in ENU
    Mat3d bank = {{{cb, sb, 0.0}, {-sb, cb, 0.0}, {0.0, 0.0, 1.0}}}, banked = mat3d_mul(&bank, &level);
    return (RenderCamera){geodesy_to_ecef((Geodetic){lat, lon, h}), mat3d_mul(&banked, &enu), sight->fov_y_rad};
}

static Vec3d ray_through(const RenderCamera *camera, double x_px, double y_px) {
    double focal_px = HEIGHT / (2.0 * tan(camera->fov_y_rad * 0.5));
    Vec3d ray = {x_px - WIDTH * 0.5, HEIGHT * 0.5 - y_px, -focal_px};
    return vec3d_normalize(mat3d_mul_vec_transposed(&camera->camera_from_ecef, ray));
}

// Whether a ray is below everything before it has left the data, a few cells of rim left out.
static bool ends_in_land(const Land *land, Vec3d eye, Vec3d ray) {
    const Dem *dem = terrain_dem(land->terrain);
    double low_m = 0.0, high_m = 1000.0, col, row;
    while (geodesy_from_ecef(vec3d_mad(eye, ray, high_m)).h_m > land->below_m)
        if ((high_m *= 2.0) > 5e5)
            return false;
    for (int i = 0; i < 30; i++) {
        double middle_m = 0.5 * (low_m + high_m);
        bool above = geodesy_from_ecef(vec3d_mad(eye, ray, middle_m)).h_m > land->below_m;
        *(above ? &low_m : &high_m) = middle_m;
    }
    Geodetic end = geodesy_from_ecef(vec3d_mad(eye, ray, high_m));
    return grid_from_geodetic(terrain_grid(land->terrain), end.lat_rad / DEG, end.lon_rad / DEG, &col, &row) &&
           col > 5.0 && row > 5.0 && col < dem->width - 6.0 && row < dem->height - 6.0;
}

// The corners tell of all rays: the ends of the others lie between theirs, and what is drawn has no gap up to there.
static bool sees_only_land(const Land *land, const RenderCamera *camera) {
    for (int corner = 0; corner < 4; corner++)
        if (!ends_in_land(land, camera->eye_ecef, ray_through(camera, corner & 1 ? WIDTH : 0, corner & 2 ? HEIGHT : 0)))
            return false;
    return true;
}

// As flat as asked for, or as flat as can be with nothing but land in sight.
static RenderCamera look_at_land(const Land *land, Sight *sight) {
    RenderCamera camera = camera_of(land, sight);
    while (!sees_only_land(land, &camera)) {
        sight->down_rad += 2.0 * DEG;
        if (sight->down_rad > GEODESY_PI / 2)
            fail_msg("no land fills the view from (%.0f, %.0f), %.0f m up", sight->col, sight->row, sight->above_m);
        camera = camera_of(land, sight);
    }
    return camera;
}

// --- the flight: legs, one after the other

typedef struct Leg {
    const char *name;
    int frames;
    double above_m[2], tau_px; // at its begin, at its end
    double turn_deg, roll_deg; // of the head, a frame
    int jump_every;            // frames; 0: never
    double fov_y_deg;          // a change of it is one of all tolerances, and ends all reuse
} Leg;

static const Leg LEGS[] = {
    {"low", 60, {30.0, 120.0}, 1.0, 0.5, 0.0, 0, 60.0},
    {"low, finer", 40, {120.0, 60.0}, 0.5, -1.0, 0.0, 0, 60.0},
    {"climb", 40, {60.0, 3000.0}, 2.0, 0.3, 0.2, 0, 45.0},
    {"high, coarse", 50, {3000.0, 3600.0}, 4.0, 2.0, 0.0, 0, 30.0},
    {"head turning", 40, {400.0, 400.0}, 1.0, 9.0, 9.0, 0, 70.0},
    {"jumps", 40, {50.0, 2000.0}, 1.0, 3.0, 0.0, 4, 60.0},
    {"dive", 30, {2500.0, 20.0}, 1.5, 0.0, 0.0, 0, 50.0},
};

static const Leg *leg_of(int frame, double *along) {
    const Leg *leg = LEGS;
    while (frame >= leg->frames)
        frame -= leg++->frames;
    *along = (double)frame / leg->frames;
    return leg;
}

// The next place: forwards by what a pilot at this height takes for 1/20 s to 1/2 s.
static void advance(const Land *land, const Leg *leg, int frame, double along, uint64_t *random, Sight *sight) {
    const Dem *dem = terrain_dem(land->terrain);
    double step = (4.0 + 0.02 * sight->above_m) / 50.0;
    if (leg->jump_every && frame % leg->jump_every == 0) {
        sight->col = support_between(random, 0.3, 0.7) * dem->width;
        sight->row = support_between(random, 0.3, 0.7) * dem->height;
    } else {
        sight->col += step * sin(0.01 * frame);
        sight->row -= step * cos(0.01 * frame);
    }
    sight->col = fmin(fmax(sight->col, 0.3 * dem->width), 0.7 * dem->width);
    sight->row = fmin(fmax(sight->row, 0.3 * dem->height), 0.7 * dem->height);
    sight->above_m = leg->above_m[0] + along * (leg->above_m[1] - leg->above_m[0]);
    sight->heading_rad += leg->turn_deg * DEG;
    sight->bank_rad += leg->roll_deg * DEG;
    sight->fov_y_rad = leg->fov_y_deg * DEG;
    sight->down_rad = 0.5 * sight->fov_y_rad + (3.0 + 12.0 * fabs(sin(0.11 * frame))) * DEG;
    sight->tau_px = leg->tau_px;
}

// --- what flies: cuts are drawn after the next one was made, as the program does

typedef struct Stage {
    Jobs *jobs;
    Geoid *geoid;
    Terrain *terrain;
    Land land;
    Lod *lod;
    Arena *arenas[2];
    RenderPacket packets[2];
    Renderer *renderer;
    uint8_t *rgb;
} Stage;

typedef struct Tally {
    int64_t pinholes, triangles, reused, patches, evictions, vram_bytes;
    int first_bad; // frame
} Tally;

static Stage stage_begin(Terrain *terrain, Geoid *geoid, Jobs *jobs, size_t vram_bytes) {
    Stage stage = {.jobs = jobs, .geoid = geoid, .terrain = terrain, .land = land_of(terrain)};
    LodOptions lod_options = lod_default_options();
    lod_options.method = LOD_HYBRID;
    lod_options.partitions = 0;
    lod_options.reuse = true;
    assert_int_equal(lod_create(&lod_options, terrain, &stage.lod), RESULT_OK);
    for (int i = 0; i < 2; i++)
        assert_int_equal(arena_create(1 << 20, &stage.arenas[i]), RESULT_OK);
    RenderOptions options = render_default_options();
    options.width = WIDTH;
    options.height = HEIGHT;
    options.vram_bytes_max = vram_bytes;
    assert_int_equal(render_create(&options, terrain, &stage.renderer), RESULT_OK);
    stage.rgb = malloc(PIXELS * 3);
    assert_non_null(stage.rgb);
    return stage;
}

static Stage stage_rough(int patch_level, size_t vram_bytes) {
    Jobs *jobs = NULL;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    print_message("seed %" PRIu64 "\n", SEED);
    Dem *dem = support_rough_dem(613, 611, &ROUGH, 1200.0, SEED);
    return stage_begin(support_terrain(dem, TERRAIN_ERROR_TOTAL, patch_level, jobs), NULL, jobs, vram_bytes);
}

static void stage_end(Stage *stage) {
    render_destroy(&stage->renderer);
    lod_destroy(&stage->lod);
    for (int i = 0; i < 2; i++)
        arena_destroy(&stage->arenas[i]);
    terrain_destroy(&stage->terrain);
    geoid_close(&stage->geoid);
    jobs_destroy(&stage->jobs);
    free(stage->rgb);
}

static void make_packet(Stage *stage, const Sight *sight, const RenderCamera *camera, int slot) {
    const double *back = camera->camera_from_ecef.m[2];
    LodView view = {.eye_ecef = camera->eye_ecef,
                    .forward_ecef = {-back[0], -back[1], -back[2]},
                    .px_per_rad = HEIGHT / (2.0 * tan(camera->fov_y_rad * 0.5)),
                    .tau_px = sight->tau_px};
    RenderPacket *packet = &stage->packets[slot];
    memset(packet, 0, sizeof *packet);
    packet->camera = *camera;
    packet->sun_ecef = vec3d_normalize(camera->eye_ecef);
    packet->magenta_background = true;
    arena_reset(stage->arenas[slot]);
    assert_int_equal(lod_update(stage->lod, &view, stage->jobs, stage->arenas[slot], &packet->cut), RESULT_OK);
}

// Magenta, or as good as.
static int64_t count_magenta(const uint8_t *rgb) {
    int64_t count = 0;
    for (size_t i = 0; i < PIXELS; i++)
        count += rgb[i * 3] >= 250 && rgb[i * 3 + 1] <= 5 && rgb[i * 3 + 2] >= 250;
    return count;
}

static int64_t draw_and_count(Stage *stage, const RenderPacket *packet, RenderStats *stats) {
    assert_int_equal(render_frame(stage->renderer, packet, stats), RESULT_OK);
    assert_int_equal(render_read_pixels(stage->renderer, stage->rgb), RESULT_OK);
    assert_int_equal(gl_take_error(), GL_NO_ERROR);
    return count_magenta(stage->rgb);
}

static void draw_frame(Stage *stage, int frame, Tally *tally) {
    RenderPacket *packet = &stage->packets[frame & 1];
    RenderStats stats;
    // Full shading now and then, flat colours else, which are quicker; each covers the same pixels.
    packet->colouring = frame % 10 ? (RenderColouring)(1 + frame % (RENDER_COLOURING_COUNT - 1)) : RENDER_COLOUR_LAND;
    int64_t pinholes = draw_and_count(stage, packet, &stats);
    if (pinholes && !tally->pinholes) {
        tally->first_bad = frame;
        if (image_write_png("pinholes.png", WIDTH, HEIGHT, 3, stage->rgb) == RESULT_OK)
            print_message("frame %d: %" PRId64 " pinholes, see pinholes.png\n", frame, pinholes);
    }
    tally->pinholes += pinholes;
    tally->triangles += stats.triangles_drawn;
    tally->evictions += stats.evictions;
    tally->vram_bytes = stats.vram_bytes > tally->vram_bytes ? stats.vram_bytes : tally->vram_bytes;
    tally->reused += packet->cut.stats.patches_reused;
    tally->patches += packet->cut.stats.patches;
    lod_release(stage->lod, packet->cut.frame);
}

static Tally fly(Stage *stage, double tau_scale) {
    const Dem *dem = terrain_dem(stage->terrain);
    Sight sight = {.col = 0.5 * dem->width, .row = 0.6 * dem->height};
    Tally tally = {.first_bad = -1};
    uint64_t random = SEED;
    for (int frame = 0; frame < FRAMES; frame++) {
        double along;
        const Leg *leg = leg_of(frame, &along);
        advance(&stage->land, leg, frame, along, &random, &sight);
        sight.tau_px *= tau_scale;
        RenderCamera camera = look_at_land(&stage->land, &sight);
        if (along == 0.0)
            print_message("frame %3d: %s, tau %.1f, looking %.0f degrees down\n", frame, leg->name, sight.tau_px,
                          sight.down_rad / DEG);
        make_packet(stage, &sight, &camera, frame & 1);
        if (frame > 0)
            draw_frame(stage, frame - 1, &tally);
    }
    draw_frame(stage, FRAMES - 1, &tally);
    return tally;
}

static void fly_and_judge(Stage *stage, double tau_scale, bool evicting) {
    Heard heard;
    heard_begin(&heard);
    Tally tally = fly(stage, tau_scale);
    heard_end();
    print_message("%d frames: %" PRId64 " pinholes, %.0f triangles a frame, %.1f %% of patches reused, %" PRId64
                  " evictions, %.1f MiB\n%s",
                  FRAMES, tally.pinholes, (double)tally.triangles / FRAMES,
                  100.0 * (double)tally.reused / (double)tally.patches, tally.evictions,
                  (double)tally.vram_bytes / (1 << 20), heard.text);
    stage_end(stage);
    assert_int_equal(heard.errors + heard.warnings, 0); // such as a cut that does not fit
    assert_true(tally.reused * 2 > tally.patches);      // or it tests no cache
    assert_true(evicting == (tally.evictions > 0));
    assert_int_equal(tally.pinholes, 0);
}

static void a_flight_over_rough_ground_has_no_pinhole(void **state) {
    (void)state;
    Stage stage = stage_rough(8, (size_t)256 << 20);
    fly_and_judge(&stage, 1.0, false);
}

static void a_flight_with_little_memory_has_no_pinhole(void **state) {
    (void)state;
    Stage stage = stage_rough(8, (size_t)4 << 20);
    fly_and_judge(&stage, 2.0, true);
}

static void a_flight_over_the_tatra_has_no_pinhole(void **state) {
    (void)state;
    Jobs *jobs = NULL;
    Geoid *geoid = NULL;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    Terrain *terrain = support_shared_terrain("tatra_srtm3_2401.tif", &geoid, jobs);
    if (!terrain) {
        jobs_destroy(&jobs);
        skip();
    }
    Stage stage = stage_begin(terrain, geoid, jobs, (size_t)512 << 20);
    fly_and_judge(&stage, 1.0, false);
}

// --- controls: damage that must show

typedef struct Hit {
    int32_t item, triangle;
    double metres, area_px;
} Hit;

typedef struct Screen {
    double x, y;
} Screen;

static Vec3d vertex_of(const LodItem *item, int32_t corner) {
    const LodVertex *v = &item->page->vertices[item->indices[corner]];
    GridPoint at = item->page->origin;
    return grid_point_ecef((GridPoint){at.x + v->x, at.y + v->y, at.z + v->z});
}

static Screen screen_of(const RenderCamera *camera, Vec3d at) {
    Vec3d in = mat3d_mul_vec(&camera->camera_from_ecef, vec3d_sub(at, camera->eye_ecef));
    double focal_px = HEIGHT / (2.0 * tan(camera->fov_y_rad * 0.5));
    return (Screen){focal_px * in.x / -in.z, focal_px * in.y / -in.z}; // from the middle, y up
}

static double cross(Screen a, Screen b) {
    return a.x * b.y - a.y * b.x;
}

// Whether the middle of the picture lies in a triangle that is seen whole and from above.
static bool covers_middle(const RenderCamera *camera, const LodItem *item, int32_t triangle, Hit *hit) {
    Screen corner[3];
    for (int i = 0; i < 3; i++) {
        Vec3d at = vertex_of(item, triangle * 3 + i);
        hit->metres = vec3d_distance(at, camera->eye_ecef);
        if (-mat3d_mul_vec(&camera->camera_from_ecef, vec3d_sub(at, camera->eye_ecef)).z < 1.0)
            return false;
        corner[i] = screen_of(camera, at);
        if (fabs(corner[i].x) > WIDTH / 2.0 || fabs(corner[i].y) > HEIGHT / 2.0)
            return false;
    }
    double a = cross(corner[0], corner[1]), b = cross(corner[1], corner[2]), c = cross(corner[2], corner[0]);
    hit->area_px = 0.5 * (a + b + c);
    return a > 0.0 && b > 0.0 && c > 0.0;
}

static Hit find_in_middle(const RenderCamera *camera, const LodCut *cut) {
    Hit hit = {.item = 0};
    for (hit.item = 0; hit.item < cut->item_count; hit.item++)
        for (hit.triangle = 0; hit.triangle < cut->items[hit.item].index_count / 3; hit.triangle++)
            if (covers_middle(camera, &cut->items[hit.item], hit.triangle, &hit))
                return hit;
    fail_msg("no triangle of %d patches covers the middle of the picture", cut->item_count);
    return hit;
}

// A view from high up in which each triangle is several pixels large, and a copy of its items to be damaged.
static LodItem *view_for_damage(Stage *stage, Hit *hit) {
    const Dem *dem = terrain_dem(stage->terrain);
    Sight sight = {0.5 * dem->width, 0.55 * dem->height, 2500.0, 0.4, 50.0 * DEG, 0.0, 60.0 * DEG, 4.0};
    RenderCamera camera = look_at_land(&stage->land, &sight);
    RenderStats stats;
    make_packet(stage, &sight, &camera, 0);
    LodCut *cut = &stage->packets[0].cut;
    stage->packets[0].colouring = RENDER_COLOUR_LEVEL;
    assert_int_equal(draw_and_count(stage, &stage->packets[0], &stats), 0);
    *hit = find_in_middle(&camera, cut);
    LodItem *items = malloc((size_t)cut->item_count * sizeof *items);
    assert_non_null(items);
    memcpy(items, cut->items, (size_t)cut->item_count * sizeof *items);
    cut->items = items;
    return items;
}

static void a_missing_triangle_shows(void **state) {
    (void)state;
    Stage stage = stage_rough(8, (size_t)64 << 20);
    Hit hit;
    RenderStats stats;
    LodItem *items = view_for_damage(&stage, &hit), *item = &items[hit.item];
    uint16_t *indices = malloc((size_t)item->index_count * sizeof *indices);
    assert_non_null(indices);
    memcpy(indices, item->indices, (size_t)item->index_count * sizeof *indices);
    memmove(indices + hit.triangle * 3, indices + hit.triangle * 3 + 3,
            (size_t)(item->index_count - hit.triangle * 3 - 3) * sizeof *indices);
    item->indices = indices;
    item->index_count -= 3;
    item->revision = UINT64_MAX; // other contents need another name
    int64_t open = draw_and_count(&stage, &stage.packets[0], &stats);
    print_message("%" PRId64 " pixels open, the triangle's area is %.1f pixels\n", open, hit.area_px);
    free(indices);
    free(items);
    stage_end(&stage);
    assert_true(hit.area_px > 4.0);
    assert_true(fabs((double)open - hit.area_px) < 3.0 * sqrt(hit.area_px) + 3.0); // about its circumference
}

static void a_patch_moved_by_two_pixels_shows(void **state) {
    (void)state;
    Stage stage = stage_rough(8, (size_t)64 << 20);
    Hit hit;
    RenderStats stats;
    LodItem *items = view_for_damage(&stage, &hit), *item = &items[hit.item];
    const RenderCamera *camera = &stage.packets[0].camera;
    const double *right = camera->camera_from_ecef.m[0];
    double two_px_m = 2.0 * hit.metres * 2.0 * tan(camera->fov_y_rad * 0.5) / HEIGHT;
    LodPage page = *item->page;
    page.id = UINT64_MAX;
    page.origin.x += llround(two_px_m * right[0]) * GRID_LATTICE_PER_M;
    page.origin.y += llround(two_px_m * right[1]) * GRID_LATTICE_PER_M;
    page.origin.z += llround(two_px_m * right[2]) * GRID_LATTICE_PER_M;
    item->page = &page;
    int64_t open = draw_and_count(&stage, &stage.packets[0], &stats);
    print_message("%" PRId64 " pixels open with a patch moved by %.0f m, %.0f m away\n", open, two_px_m, hit.metres);
    free(items);
    stage_end(&stage);
    assert_true(open > 0);
}

int main(void) {
    int frames = 0;
    for (size_t i = 0; i < COUNT_OF(LEGS); i++)
        frames += LEGS[i].frames;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_missing_triangle_shows),
        cmocka_unit_test(a_patch_moved_by_two_pixels_shows),
        cmocka_unit_test(a_flight_over_rough_ground_has_no_pinhole),
        cmocka_unit_test(a_flight_with_little_memory_has_no_pinhole),
        cmocka_unit_test(a_flight_over_the_tatra_has_no_pinhole),
    };
    Context *context = NULL;
    if (!gl_support_begin(WIDTH, HEIGHT, &context))
        return GL_SKIP_STATUS;
    int failed = frames == FRAMES ? cmocka_run_group_tests(tests, NULL, NULL) : 1;
    context_destroy(&context);
    return failed;
}
