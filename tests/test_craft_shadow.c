// An aircraft's shadow on the ground: where the sun throws it, as dark as without the sun, as soft as the sun is wide,
// and nothing where there is none.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/arena.h"
#include "render/atmosphere.h"
#include "render/craft/craft_cast.h"
#include "render/craft/craft_split.h"
#include "render/gl.h"
#include "render/render.h"
#include "terrain/geodesy.h"
#include "tests/cut_support.h"
#include "tests/gl_support.h"

#define WIDTH 192
#define HEIGHT 160
#define BYTES ((size_t)WIDTH * HEIGHT * 3)
#define FOV_RAD (30.0 * GEODESY_RAD_PER_DEG)
#define EYE_M 60.0 // above the shadow
#define GROUND_M 300.0
#define SIDE 129   // samples
#define EAST_M 1.2 // a sample; level ground would be water
#define SOUTH_M (-0.8)
#define SHADOW_FILL 2.2 // as shaders/tone.glsl has it
#define SUN_RADIUS_RAD (0.2666 * GEODESY_RAD_PER_DEG)

static const DemGeoref GEOREF = {
    .crs = DEM_CRS_GEOGRAPHIC, .x0 = 20.0, .y0 = 49.5, .dx = 1.0 / 1200, .dy = -1.0 / 1200};

typedef struct Stage {
    Jobs *jobs;
    Terrain *terrain;
    Lod *lods[2]; // of the picture or its left half, and of the right half
    Arena *arena;
    Renderer *renderer;
    uint8_t *rgb;
} Stage;

// The mean height of its rim is GROUND_M, and so is the globe around.
static Dem *inclined_dem(void) {
    Dem *dem = NULL;
    assert_int_equal(dem_create(SIDE, SIDE, &GEOREF, DEM_DATUM_ELLIPSOID, &dem), RESULT_OK);
    for (int i = 0; i < SIDE * SIDE; i++) {
        float h_m = (float)(GROUND_M + EAST_M * (i % SIDE - SIDE / 2) + SOUTH_M * (i / SIDE - SIDE / 2));
        dem->height_m[i] = h_m;
        dem->min_m = i == 0 || h_m < dem->min_m ? h_m : dem->min_m;
        dem->max_m = i == 0 || h_m > dem->max_m ? h_m : dem->max_m;
    }
    return dem;
}

static Stage stage_begin(bool resident) {
    Stage stage = {0};
    RenderOptions options = render_default_options();
    options.width = WIDTH;
    options.height = HEIGHT;
    options.samples = 1;
    assert_int_equal(jobs_create(2, &stage.jobs), RESULT_OK);
    stage.terrain = support_terrain(inclined_dem(), TERRAIN_ERROR_TOTAL, 12, stage.jobs);
    for (int i = 0; i < 2; i++) {
        LodOptions lod_options = lod_default_options();
        lod_options.method = resident ? LOD_DIAMOND : LOD_HYBRID;
        lod_options.resident = resident;
        lod_options.serial = (uint32_t)i;
        assert_int_equal(lod_create(&lod_options, stage.terrain, &stage.lods[i]), RESULT_OK);
    }
    assert_int_equal(arena_create(1 << 20, &stage.arena), RESULT_OK);
    assert_int_equal(render_create(&options, stage.terrain, &stage.renderer), RESULT_OK);
    stage.rgb = malloc(BYTES);
    assert_non_null(stage.rgb);
    return stage;
}

static void stage_end(Stage *stage) {
    render_destroy(&stage->renderer);
    lod_destroy(&stage->lods[0]);
    lod_destroy(&stage->lods[1]);
    arena_destroy(&stage->arena);
    terrain_destroy(&stage->terrain);
    jobs_destroy(&stage->jobs);
    free(stage->rgb);
}

// ---- what is looked at ----

// A place on the ground, its local axes and its plane.
typedef struct Place {
    Vec3d at, east, north, up, normal;
} Place;

static Place place_at(const Stage *stage, double col, double row) {
    Place place = {.at = support_eye(stage->terrain, col, row, 0.0)};
    bool outside = col < 0.0;
    double lat, lon;
    grid_geodetic(terrain_grid(stage->terrain), col, row, &lat, &lon);
    Geodetic geodetic = {lat * GEODESY_RAD_PER_DEG, lon * GEODESY_RAD_PER_DEG, GROUND_M};
    Mat3d enu = geodesy_enu_from_ecef(geodetic.lat_rad, geodetic.lon_rad);
    place.east = mat3d_mul_vec_transposed(&enu, vec3d(1.0, 0.0, 0.0));
    place.north = mat3d_mul_vec_transposed(&enu, vec3d(0.0, 1.0, 0.0));
    place.up = mat3d_mul_vec_transposed(&enu, vec3d(0.0, 0.0, 1.0));
    geodetic.h_m /= vec3d_length(frame_round(place.up)); // the globe's height is one in round space
    if (outside)
        place.at = geodesy_to_ecef(geodetic);
    Vec3d east = vec3d_sub(support_eye(stage->terrain, col + 1.0, row, 0.0), place.at);
    Vec3d south = vec3d_sub(support_eye(stage->terrain, col, row + 1.0, 0.0), place.at);
    place.normal = outside ? place.up : vec3d_normalize(vec3d_cross(south, east));
    return place;
}

static Vec3d sun_at(const Place *place, double azimuth_rad, double elevation_rad) {
    Vec3d level = vec3d_mad(vec3d_scale(place->north, cos(azimuth_rad)), place->east, sin(azimuth_rad));
    return vec3d_mad(vec3d_scale(level, cos(elevation_rad)), place->up, sin(elevation_rad));
}

// Straight down at the place, north up; the aircraft, which is not shown, `away_m` from there towards the sun.
static RenderPacket packet_of(const Place *place, CraftKind kind, Vec3d sun, double away_m) {
    RenderPacket packet;
    memset(&packet, 0, sizeof packet);
    const Vec3d right = place->east, up = place->north, back = place->up;
    packet.camera = (RenderCamera){vec3d_mad(place->at, back, EYE_M),
                                   {{{right.x, right.y, right.z}, {up.x, up.y, up.z}, {back.x, back.y, back.z}}},
                                   FOV_RAD};
    packet.sun_ecef = sun;
    packet.craft = (RenderCraft){.casts = true, .kind = kind, .position_ecef = vec3d_mad(place->at, sun, away_m)};
    packet.craft.ecef_from_body = quatd_normalize((Quatd){0.3, 0.8, -0.4, 0.2});
    packet.craft.pose = (CraftPose){.gear = 1.0, .flaps_rad = 0.3};
    return packet;
}

static void draw(Stage *stage, RenderPacket *packet) {
    RenderStats stats;
    const double *back = packet->camera.camera_from_ecef.m[2];
    const LodView view = {.eye_ecef = packet->camera.eye_ecef,
                          .forward_ecef = {-back[0], -back[1], -back[2]},
                          .px_per_rad = HEIGHT / (2.0 * tan(FOV_RAD * 0.5)),
                          .tau_px = 1.0};
    arena_reset(stage->arena);
    assert_int_equal(lod_update(stage->lods[0], &view, stage->jobs, stage->arena, &packet->cut), RESULT_OK);
    assert_int_equal(lod_update(stage->lods[1], &view, stage->jobs, stage->arena, &packet->right), RESULT_OK);
    assert_int_equal(render_frame(stage->renderer, packet, &stats), RESULT_OK);
    lod_release(stage->lods[0], packet->cut.frame);
    lod_release(stage->lods[1], packet->right.frame);
    assert_int_equal(render_read_pixels(stage->renderer, stage->rgb), RESULT_OK);
    assert_int_equal(gl_take_error(), GL_NO_ERROR);
}

// ---- what should be there ----

typedef struct Point {
    double x, y; // pixels from the top left corner
} Point;

static double side_of(Point a, Point b, Point p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

static void fill_triangle(const Point p[3], uint8_t *mask) {
    int left = (int)fmax(fmin(p[0].x, fmin(p[1].x, p[2].x)), 0.0);
    int right = (int)fmin(fmax(p[0].x, fmax(p[1].x, p[2].x)), WIDTH - 1);
    int top = (int)fmax(fmin(p[0].y, fmin(p[1].y, p[2].y)), 0.0);
    int bottom = (int)fmin(fmax(p[0].y, fmax(p[1].y, p[2].y)), HEIGHT - 1);
    for (int y = top; y <= bottom; y++)
        for (int x = left; x <= right; x++) {
            Point at = {x + 0.5, y + 0.5};
            double a = side_of(p[0], p[1], at), b = side_of(p[1], p[2], at), c = side_of(p[2], p[0], at);
            if ((a >= 0.0 && b >= 0.0 && c >= 0.0) || (a <= 0.0 && b <= 0.0 && c <= 0.0))
                mask[y * WIDTH + x] = 1;
        }
}

#define PX_A_METRE (HEIGHT / (2.0 * tan(FOV_RAD * 0.5)) / EYE_M)

// The shadow of a sun without width, from the mesh along straight rays to the plane.
static void fill_sharp(const Place *place, const RenderPacket *packet, uint8_t *mask) {
    CraftModel model;
    const RenderCraft *craft = &packet->craft;
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
            at = vec3d_add(vec3d_sub(craft->position_ecef, place->at), quatd_rotate(craft->ecef_from_body, at));
            double along = vec3d_dot(at, place->normal) / vec3d_dot(packet->sun_ecef, place->normal);
            at = vec3d_mad(at, packet->sun_ecef, -along);
            double scale = PX_A_METRE * EYE_M / (EYE_M - vec3d_dot(at, place->up));
            points[j] = (Point){0.5 * WIDTH + vec3d_dot(at, place->east) * scale,
                                0.5 * HEIGHT - vec3d_dot(at, place->north) * scale};
        }
        if (model.mesh.vertices[model.mesh.indices[i]].finish != CRAFT_DISC)
            fill_triangle(points, mask);
    }
    craft_model_free(&model);
}

typedef struct Box {
    int left, top, right, bottom;
} Box;

// Of all pixels in the mask, and so many around.
static Box box_around(const uint8_t *mask, int around) {
    Box box = {WIDTH, HEIGHT, 0, 0};
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        int x = i % WIDTH, y = i / WIDTH;
        if (!mask[i])
            continue;
        box.left = x - around < box.left ? x - around : box.left;
        box.right = x + around > box.right ? x + around : box.right;
        box.top = y - around < box.top ? y - around : box.top;
        box.bottom = y + around > box.bottom ? y + around : box.bottom;
    }
    return box;
}

static int reach_px(const Place *place, Vec3d sun, double radius_m) {
    return (int)ceil(radius_m / vec3d_dot(sun, place->up) * PX_A_METRE);
}

// Share of the sun's disc that is covered at a pixel: the mean of the sharp shadow over what the disc spans there.
static double soft_at(const Place *place, Vec3d sun, double radius_m, const uint8_t *mask, int x, int y) {
    int reach = reach_px(place, sun, radius_m), inside = 0, covered = 0;
    for (int v = -reach; v <= reach; v++)
        for (int u = -reach; u <= reach; u++) {
            Vec3d aside = vec3d_mad(vec3d_scale(place->east, u / PX_A_METRE), place->north, -v / PX_A_METRE);
            double along = vec3d_dot(aside, sun), across2 = vec3d_dot(aside, aside) - along * along;
            if (across2 > radius_m * radius_m)
                continue;
            inside++;
            bool shown = x + u >= 0 && x + u < WIDTH && y + v >= 0 && y + v < HEIGHT;
            covered += shown && mask[(y + v) * WIDTH + x + u];
        }
    return (double)covered / inside;
}

// ---- what is there ----

// The inverse of shaders/tone.glsl: light in a pixel's green, but for the exposure.
static double light_in(const uint8_t *pixel) {
    double shown[3], luminance = 0.0;
    static const double WEIGHTS[3] = {0.2126, 0.7152, 0.0722};
    for (int i = 0; i < 3; i++) {
        shown[i] = pow(pixel[i] / 255.0, 2.2);
        luminance += WEIGHTS[i] * shown[i];
    }
    double y = luminance + (shown[1] - luminance) / 1.18;
    double a = 2.51 - 2.43 * y, b = 0.15 - 0.70 * y, c = -0.14 * y;
    return (-b + sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
}

// Of the light on nearly level ground, how much comes straight from the sun.
static double sun_share(double mu, double open_sky) {
    Atmosphere *atmosphere = NULL;
    assert_int_equal(atmosphere_create(&atmosphere), RESULT_OK);
    AtmosphereLight low = atmosphere_light(atmosphere, 0.0, mu), high = atmosphere_light(atmosphere, 4000.0, mu);
    atmosphere_destroy(&atmosphere);
    double up = GROUND_M / 4000.0;
    double sun = mu * ((double)low.sun.y + up * (double)(high.sun.y - low.sun.y));
    double sky = open_sky * SHADOW_FILL * ((double)low.sky.y + up * (double)(high.sky.y - low.sky.y));
    return sun / (sun + sky);
}

typedef struct Case {
    const char *name;
    CraftKind kind;
    bool resident;
    double col, away_m, elevation_deg, open_sky; // open_sky: of what is seen, as its shader has it
} Case;

static const Case CASES[] = {
    {"near", CRAFT_C172, false, 60.0, 25.0, 50.0, 1.0},
    {"far", CRAFT_JET_TRAINER, false, 60.0, 350.0, 70.0, 1.0},
    {"low sun", CRAFT_GLIDER, false, 60.0, 60.0, 30.0, 1.0},
    {"diamonds of the GPU", CRAFT_C172, true, 60.0, 120.0, 50.0, 1.0},
    {"beside the data", CRAFT_C172, false, -20.0, 120.0, 50.0, 0.6},
};

typedef struct Found {
    double expected, found, off; // sums of shares over the pixels, and of their differences
    int touched, stray;          // pixels in the shadow, and changed outside
} Found;

static Found compare(const Case *c, const Place *place, const RenderPacket *packet, const uint8_t *lit,
                     const uint8_t *shaded) {
    Found found = {0};
    uint8_t *mask = malloc(WIDTH * HEIGHT);
    assert_non_null(mask);
    fill_sharp(place, packet, mask);
    Vec3d sun = packet->sun_ecef;
    double radius_m = c->away_m * tan(SUN_RADIUS_RAD), wider_m = 1.7 * radius_m + 1.5 / PX_A_METRE;
    double direct = sun_share(vec3d_dot(sun, place->normal), c->open_sky);
    const Box box = box_around(mask, reach_px(place, sun, wider_m));
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        int x = i % WIDTH, y = i / WIDTH;
        bool near = x >= box.left && x <= box.right && y >= box.top && y <= box.bottom &&
                    soft_at(place, sun, wider_m, mask, x, y) > 0.0;
        found.stray += !near && memcmp(lit + 3 * i, shaded + 3 * i, 3) != 0;
        if (!near)
            continue;
        double expected = soft_at(place, sun, radius_m, mask, x, y);
        double share = (1.0 - light_in(shaded + 3 * i) / light_in(lit + 3 * i)) / direct;
        found.touched++;
        found.expected += expected;
        found.found += share;
        found.off += fabs(share - expected);
    }
    free(mask);
    return found;
}

// To 6 % in sum: as much sun is lost as the aircraft takes, however soft the shadow is.
static void check_case(Stage *stage, const Case *c) {
    const Place place = place_at(stage, c->col, 64.0);
    Vec3d sun = sun_at(&place, 2.3, c->elevation_deg * GEODESY_RAD_PER_DEG);
    RenderPacket packet = packet_of(&place, c->kind, sun, c->away_m);
    uint8_t *lit = malloc(BYTES);
    assert_non_null(lit);
    packet.craft.casts = false;
    draw(stage, &packet);
    memcpy(lit, stage->rgb, BYTES);
    packet.craft.casts = true;
    draw(stage, &packet);
    Found found = compare(c, &place, &packet, lit, stage->rgb);
    print_message("%s: %.1f pixels of sun lost, %.1f expected, off by %.1f in %d pixels; %d stray\n", c->name,
                  found.found, found.expected, found.off, found.touched, found.stray);
    assert_true(found.expected > 50.0);
    assert_true(fabs(found.found - found.expected) < 0.06 * found.expected);
    assert_true(found.off < 0.20 * found.expected);
    assert_int_equal(found.stray, 0);
    free(lit);
}

static void it_lies_where_the_sun_throws_it(void **state) {
    (void)state;
    for (int resident = 0; resident < 2; resident++) {
        Stage stage = stage_begin(resident);
        for (size_t i = 0; i < COUNT_OF(CASES); i++)
            if (CASES[i].resident == resident)
                check_case(&stage, &CASES[i]);
        stage_end(&stage);
    }
}

// ---- two halves, and none ----

#define LINE 4 // between them, pixels

static void both_halves_show_it(void **state) {
    (void)state;
    Stage stage = stage_begin(false);
    const Place place = place_at(&stage, 60.0, 64.0);
    RenderPacket packet = packet_of(&place, CRAFT_C172, sun_at(&place, 2.3, 0.9), 25.0);
    packet.split = true;
    draw(&stage, &packet);
    int dark = 0, differing = 0, middle = WIDTH / 2;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = LINE; x < middle - LINE; x++) {
            const uint8_t *left = stage.rgb + (y * WIDTH + x) * 3, *right = left + middle * 3;
            dark += left[1] < 70;
            differing += abs(left[1] - right[1]) > 1; // they are not dithered alike
        }
    print_message("%d pixels of shadow on the left, %d differ on the right\n", dark, differing);
    assert_true(dark > 300);
    assert_int_equal(differing, 0);
    stage_end(&stage);
}

static void where_none_falls_nothing_is_made(void **state) {
    (void)state;
    static const struct {
        const char *why;
        double away_m, elevation_deg, turn_rad;
    } NONE[] = {{"too high", 2000.0, 50.0, 0.0}, {"night", 30.0, -2.0, 0.0}, {"not in view", 30.0, 50.0, 2.0}};
    Stage stage = stage_begin(false);
    const Place place = place_at(&stage, 60.0, 64.0);
    uint8_t *without = malloc(BYTES);
    assert_non_null(without);
    for (size_t i = 0; i < COUNT_OF(NONE); i++) {
        Vec3d sun = sun_at(&place, 2.3, NONE[i].elevation_deg * GEODESY_RAD_PER_DEG);
        RenderPacket packet = packet_of(&place, CRAFT_C172, sun, NONE[i].away_m);
        double s = sin(NONE[i].turn_rad), c = cos(NONE[i].turn_rad);
        const Mat3d turn = {{{1.0, 0.0, 0.0}, {0.0, c, s}, {0.0, -s, c}}};
        packet.camera.camera_from_ecef = mat3d_mul(&turn, &packet.camera.camera_from_ecef);
        packet.craft.casts = false;
        draw(&stage, &packet);
        memcpy(without, stage.rgb, BYTES);
        packet.craft.casts = true;
        int before = gl_support_programs();
        draw(&stage, &packet);
        print_message("%s: %d programs more\n", NONE[i].why, gl_support_programs() - before);
        assert_memory_equal(without, stage.rgb, BYTES);
        assert_int_equal(gl_support_programs(), before);
    }
    free(without);
    stage_end(&stage);
}

// ---- where it is looked for ----

typedef struct Search {
    const Terrain *terrain;
    Frame frame;
    CraftCast cast;
    CraftBox box;
    Vec3d sun;
    double reach_m;
    int rays, missed;
} Search;

static bool is_within(const CraftPixels *pixels, double x, double y) {
    return x >= pixels->x && x < pixels->x + pixels->width && y >= pixels->y && y < pixels->y + pixels->height;
}

// The pixel at this place of the view is one of those that are shaded.
static bool is_shaded(const CraftCast *cast, double x, double y) {
    double column = (0.5 + 0.5 * x) * 1280.0, row = (0.5 + 0.5 * y) * 800.0;
    bool shaded = cast->falls && is_within(&cast->pixels, column, row);
    for (int i = 0; i < cast->beside_count; i++)
        shaded = shaded && !is_within(&cast->beside[i], column, row);
    return shaded;
}

// From a point of the aircraft down the sun's ray to the ground, by small steps; then to the picture.
static void follow_ray(Search *search, Vec3d from) {
    double last_m = search->reach_m / CRAFT_SUN_TANGENT, ground_m;
    for (double along = 0.0; along < last_m; along += 0.5) {
        Vec3d at = vec3d_mad(from, search->sun, -along);
        Geodetic place = geodesy_from_ecef(at);
        if (!terrain_ground_m(search->terrain, place.lat_rad / GEODESY_RAD_PER_DEG, place.lon_rad / GEODESY_RAD_PER_DEG,
                              &ground_m))
            return;
        if (place.h_m > ground_m)
            continue;
        if (along == 0.0 || !frame_sees_sphere(&search->frame, at, 0.0))
            return;
        const float(*m)[4] = search->frame.block.clip_from_eye;
        Vec3d p = vec3d_sub(at, search->frame.eye_ecef);
        double w = (double)m[0][3] * p.x + (double)m[1][3] * p.y + (double)m[2][3] * p.z;
        double x = ((double)m[0][0] * p.x + (double)m[1][0] * p.y + (double)m[2][0] * p.z) / w;
        double y = ((double)m[0][1] * p.x + (double)m[1][1] * p.y + (double)m[2][1] * p.z) / w;
        const CraftBounds *clip = &search->cast.clip;
        if (w < FRAME_NEAR_M)
            return;
        search->rays++;
        search->missed += !is_shaded(&search->cast, x, y) || x < clip->left || x > clip->right || y < clip->bottom ||
                          y > clip->top || along < search->cast.nearest_m - search->reach_m ||
                          vec3d_distance(at, search->cast.centre_ecef) > search->cast.radius_m;
        return;
    }
}

static double between(uint64_t *seed, double low, double high) {
    return support_between(seed, low, high);
}

static void random_search(uint64_t *seed, Search *search) {
    Vec3d ground = support_eye(search->terrain, between(seed, 30.0, 90.0), between(seed, 30.0, 90.0), 0.0);
    Geodetic geodetic = geodesy_from_ecef(ground);
    Mat3d enu = geodesy_enu_from_ecef(geodetic.lat_rad, geodetic.lon_rad);
    Place place = {.east = mat3d_mul_vec_transposed(&enu, vec3d(1.0, 0.0, 0.0)),
                   .north = mat3d_mul_vec_transposed(&enu, vec3d(0.0, 1.0, 0.0)),
                   .up = mat3d_mul_vec_transposed(&enu, vec3d(0.0, 0.0, 1.0))};
    search->sun = sun_at(&place, between(seed, 0.0, 6.28), between(seed, 0.02, 1.5));
    search->box.position_ecef = vec3d_mad(ground, place.up, exp(between(seed, 0.5, 6.0)));
    search->box.ecef_from_body = quatd_normalize((Quatd){between(seed, -1.0, 1.0), between(seed, -1.0, 1.0),
                                                         between(seed, -1.0, 1.0), between(seed, -1.0, 1.0)});
    search->box.low = vec3d(-5.0, -4.0, -1.0);
    search->box.high = vec3d(2.0, 4.0, 1.0);
    search->reach_m = 6.6;
    search->box.gone_m = search->reach_m / CRAFT_SUN_TANGENT;
    Vec3d eye = vec3d_mad(search->box.position_ecef, place.up, between(seed, -5.0, 60.0));
    eye = vec3d_mad(eye, search->sun, between(seed, -100.0, 30.0));
    Vec3d back = vec3d_normalize(vec3d_mad(vec3d_scale(search->sun, between(seed, -0.5, 1.0)), place.up, 0.8));
    Vec3d right = vec3d_normalize(vec3d_cross(place.north, back)), up = vec3d_cross(back, right);
    const RenderCamera camera = {
        eye, {{{right.x, right.y, right.z}, {up.x, up.y, up.z}, {back.x, back.y, back.z}}}, 1.0};
    search->frame = frame_make(&camera, 1280, 800);
    frame_set_sun(&search->frame, search->sun);
    frame_set_globe(&search->frame, GROUND_M);
}

// Both ends of the box and a rod between, which is the aircraft; this share of the pixels is spared.
static double narrow(const CraftLand *land, Search *search) {
    static const double ENDS[3][2] = {{-5.0, -4.0}, {-4.0, 1.0}, {1.0, 2.0}};
    CraftBox boxes[3];
    double spared = 0.0;
    for (int i = 0; i < 3; i++) {
        boxes[i] = search->box;
        Vec3d middle = {0.5 * (ENDS[i][0] + ENDS[i][1]), 0.0, 0.0};
        double half = 0.5 * (ENDS[i][1] - ENDS[i][0]), wide = i == 1 ? 0.4 : 1.0;
        boxes[i].position_ecef = vec3d_add(search->box.position_ecef, quatd_rotate(search->box.ecef_from_body, middle));
        boxes[i].high = vec3d(half, 4.0 * wide, wide);
        boxes[i].low = vec3d_scale(boxes[i].high, -1.0);
    }
    double before = (double)search->cast.pixels.width * search->cast.pixels.height;
    craft_cast_narrow(land, &search->frame, boxes, 3, &search->cast);
    double after = (double)search->cast.pixels.width * search->cast.pixels.height;
    for (int i = 0; i < search->cast.beside_count; i++)
        spared += (double)search->cast.beside[i].width * search->cast.beside[i].height;
    return (before - after + spared) / before;
}

static void all_of_it_is_looked_for(void **state) {
    (void)state;
    uint64_t seed = 20;
    Jobs *jobs = NULL;
    assert_int_equal(jobs_create(2, &jobs), RESULT_OK);
    Dem *dem = support_rough_dem(SIDE, SIDE, &GEOREF, 800.0, 7);
    Search search = {.terrain = support_terrain(dem, TERRAIN_ERROR_TOTAL, 12, jobs)};
    const CraftLand land = {.terrain = search.terrain, .view_width = 1280, .view_height = 800};
    double spared = 0.0;
    int falls = 0;
    for (int i = 0; i < 200; i++) {
        random_search(&seed, &search);
        search.cast = craft_cast_find(&land, &search.frame, &search.box, search.reach_m);
        if (search.cast.falls) {
            falls++;
            spared += narrow(&land, &search);
        }
        const Vec3d *low = &search.box.low, *high = &search.box.high;
        for (int j = 0; j < 8; j++) {
            Vec3d body = {between(&seed, low->x, high->x), between(&seed, low->y, high->y),
                          between(&seed, low->z, high->z)};
            if (body.x > -4.0 && body.x < 1.0)
                body = vec3d(body.x, 0.4 * body.y, 0.4 * body.z);
            follow_ray(&search, vec3d_add(search.box.position_ecef, quatd_rotate(search.box.ecef_from_body, body)));
        }
    }
    print_message("seed 20: %d rays to the ground in view, %d missed; %.0f %% of the pixels spared\n", search.rays,
                  search.missed, 100.0 * spared / falls);
    assert_true(spared > 0.03 * falls);
    assert_true(search.rays > 300);
    assert_int_equal(search.missed, 0);
    Terrain *terrain = (Terrain *)search.terrain;
    terrain_destroy(&terrain);
    jobs_destroy(&jobs);
}

static bool holds(const CraftSplit *split, const float at[3]) {
    for (int i = 0; i < split->count; i++) {
        const Vec3d low = split->low[i], high = split->high[i];
        if (at[0] >= low.x && at[0] <= high.x && at[1] >= low.y && at[1] <= high.y && at[2] >= low.z && at[2] <= high.z)
            return true;
    }
    return false;
}

static void no_part_is_out_of_reach(void **state) {
    (void)state;
    for (int kind = 0; kind < CRAFT_KIND_COUNT; kind++) {
        CraftModel model;
        CraftSplit split;
        const CraftShape *shape = craft_shape((CraftKind)kind);
        assert_int_equal(craft_model_create(shape, &model), RESULT_OK);
        print_message("%s: %.2f m, within %.2f\n", shape->name, model.radius_m, craft_shape_reach_m(shape));
        assert_true(model.radius_m <= craft_shape_reach_m(shape));
        assert_int_equal(craft_split_find(&model, &split), RESULT_OK);
        assert_true(split.count > 3);
        for (int i = 0; i < model.mesh.vertex_count; i++)
            assert_true(holds(&split, model.mesh.vertices[i].position));
        craft_model_free(&model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_lies_where_the_sun_throws_it),  cmocka_unit_test(both_halves_show_it),
        cmocka_unit_test(where_none_falls_nothing_is_made), cmocka_unit_test(all_of_it_is_looked_for),
        cmocka_unit_test(no_part_is_out_of_reach),
    };
    Context *context = NULL;
    if (!gl_support_begin(16, 16, &context))
        return GL_SKIP_STATUS;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    context_destroy(&context);
    return failed;
}
