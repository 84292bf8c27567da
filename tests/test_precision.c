// Hard cases 1 and 2 on the GPU: where vertices land on the screen when the Earth is 6.4e6 m across and the eye moves
// by millimetres, and which of two far planes is in front. Oracles: long double arithmetic of our own, and pictures of
// each plane alone.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "render/frame.h"
#include "render/gl.h"
#include "render/render.h"
#include "render/shader.h"
#include "terrain/geodesy.h"
#include "tests/cut_support.h"
#include "tests/gl_support.h"

#define WIDTH 1280
#define HEIGHT 800
#define FOV_RAD 1.0
#define MOST_OFF_PX 0.05
#define MOST_BACK_PX (1.0 / 256.0) // what rasterisers resolve

// --- a camera somewhere, and points in its view

typedef struct Place {
    const char *name;
    double lat_deg, lon_deg, heading_rad;
} Place;

static const Place PLACES[] = {
    {"equator", 0.0, 0.0, 0.3},
    {"near the pole", 89.99, 37.0, 2.0},
    {"antimeridian", -17.0, 180.0, 4.5},
    {"Tatras", 49.2, 20.1, 1.0},
};
static const double DISTANCES_M[] = {0.8, 3.0, 40.0, 1000.0, 60000.0, 400000.0, 2000000.0};

static Vec3d row(const Mat3d *m, int i) {
    return vec3d(m->m[i][0], m->m[i][1], m->m[i][2]);
}

static RenderCamera camera_at(const Place *place, double above_m) {
    double lat = place->lat_deg * GEODESY_RAD_PER_DEG, lon = place->lon_deg * GEODESY_RAD_PER_DEG;
    Mat3d enu = geodesy_enu_from_ecef(lat, lon);
    Vec3d east = row(&enu, 0), north = row(&enu, 1), up = row(&enu, 2);
    Vec3d ahead = vec3d_mad(vec3d_scale(north, cos(place->heading_rad)), east, sin(place->heading_rad));
    ahead = vec3d_normalize(vec3d_mad(ahead, up, -0.07));
    Vec3d right = vec3d_normalize(vec3d_cross(ahead, up)), top = vec3d_cross(right, ahead);
    RenderCamera camera = {.eye_ecef = geodesy_to_ecef((Geodetic){lat, lon, above_m}), .fov_y_rad = FOV_RAD};
    Vec3d rows[3] = {right, top, vec3d_scale(ahead, -1.0)};
    for (int i = 0; i < 3; i++) {
        camera.camera_from_ecef.m[i][0] = rows[i].x;
        camera.camera_from_ecef.m[i][1] = rows[i].y;
        camera.camera_from_ecef.m[i][2] = rows[i].z;
    }
    return camera;
}

static GridPoint point_ahead(const RenderCamera *camera, double metres, double aside, double down) {
    Vec3d to = vec3d_scale(row(&camera->camera_from_ecef, 2), -1.0);
    to = vec3d_mad(to, row(&camera->camera_from_ecef, 0), aside);
    to = vec3d_mad(to, row(&camera->camera_from_ecef, 1), -down);
    Vec3d at = vec3d_mad(camera->eye_ecef, to, metres);
    return (GridPoint){llrint(at.x * GRID_LATTICE_PER_M), llrint(at.y * GRID_LATTICE_PER_M),
                       llrint(at.z * GRID_LATTICE_PER_M)};
}

typedef struct Pixel {
    long double x, y;
} Pixel;

// The definition of a central projection, in long double.
static Pixel project(const RenderCamera *camera, GridPoint point) {
    long double to[3] = {(long double)point.x / GRID_LATTICE_PER_M - (long double)camera->eye_ecef.x,
                         (long double)point.y / GRID_LATTICE_PER_M - (long double)camera->eye_ecef.y,
                         (long double)point.z / GRID_LATTICE_PER_M - (long double)camera->eye_ecef.z};
    long double in[3];
    for (int i = 0; i < 3; i++)
        in[i] = camera->camera_from_ecef.m[i][0] * to[0] + camera->camera_from_ecef.m[i][1] * to[1] +
                camera->camera_from_ecef.m[i][2] * to[2];
    long double focal_px = HEIGHT * 0.5L / tanl((long double)camera->fov_y_rad * 0.5L);
    return (Pixel){WIDTH * 0.5L + focal_px * in[0] / -in[2], HEIGHT * 0.5L + focal_px * in[1] / -in[2]};
}

// --- the vertex shader, captured

typedef struct Capture {
    unsigned program, vertex_array, vertices, instances, output, frame_buffer, ground_buffer;
} Capture;

typedef struct CaptureInstance { // as terrain_pass feeds it
    int32_t lo[4], hi[4];
    uint32_t info;
    float phase[2];
} CaptureInstance;

static Capture capture_begin(void) {
    static const char *const FEEDBACK[] = {"gl_Position"};
    const ShaderSpec spec = {.stages = {"terrain.vert"}, .feedback = FEEDBACK, .feedback_count = 1};
    Capture capture;
    assert_int_equal(shader_create_program(&spec, &capture.program), RESULT_OK);
    glCreateVertexArrays(1, &capture.vertex_array);
    glCreateBuffers(1, &capture.vertices);
    glCreateBuffers(1, &capture.instances);
    glCreateBuffers(1, &capture.output);
    glCreateBuffers(1, &capture.frame_buffer);
    glCreateBuffers(1, &capture.ground_buffer);
    glNamedBufferData(capture.output, 16, NULL, GL_DYNAMIC_READ);
    glNamedBufferData(capture.ground_buffer, 256, NULL, GL_STATIC_DRAW);
    const GLuint array = capture.vertex_array;
    glVertexArrayAttribIFormat(array, 0, 3, GL_INT, offsetof(LodVertex, x));
    glVertexArrayAttribIFormat(array, 1, 2, GL_UNSIGNED_SHORT, offsetof(LodVertex, col));
    glVertexArrayAttribIFormat(array, 2, 4, GL_INT, offsetof(CaptureInstance, lo));
    glVertexArrayAttribIFormat(array, 3, 4, GL_INT, offsetof(CaptureInstance, hi));
    glVertexArrayAttribIFormat(array, 4, 1, GL_UNSIGNED_INT, offsetof(CaptureInstance, info));
    glVertexArrayAttribFormat(array, 5, 2, GL_FLOAT, GL_FALSE, offsetof(CaptureInstance, phase));
    for (GLuint i = 0; i < 6; i++) {
        glEnableVertexArrayAttrib(array, i);
        glVertexArrayAttribBinding(array, i, i < 2 ? 0 : 1);
    }
    glVertexArrayBindingDivisor(array, 1, 1);
    glVertexArrayVertexBuffer(array, 0, capture.vertices, 0, sizeof(LodVertex));
    glVertexArrayVertexBuffer(array, 1, capture.instances, 0, sizeof(CaptureInstance));
    return capture;
}

static void capture_end(Capture *capture) {
    const GLuint buffers[] = {capture->vertices, capture->instances, capture->output, capture->frame_buffer,
                              capture->ground_buffer};
    glDeleteBuffers(COUNT_OF(buffers), buffers);
    glDeleteVertexArrays(1, &capture->vertex_array);
    glDeleteProgram(capture->program);
}

// The clip coordinates that the GPU gives a lattice point which a page with this origin holds.
static void capture_clip(const Capture *capture, const Frame *frame, GridPoint origin, GridPoint point, float clip[4]) {
    FrameOffset offset = frame_offset(frame, origin);
    LodVertex vertex = {
        .x = (int32_t)(point.x - origin.x), .y = (int32_t)(point.y - origin.y), .z = (int32_t)(point.z - origin.z)};
    CaptureInstance instance = {.info = 0};
    memcpy(instance.lo, offset.lo, sizeof offset.lo);
    memcpy(instance.hi, offset.hi, sizeof offset.hi);
    glNamedBufferData(capture->vertices, sizeof vertex, &vertex, GL_STREAM_DRAW);
    glNamedBufferData(capture->instances, sizeof instance, &instance, GL_STREAM_DRAW);
    glNamedBufferData(capture->frame_buffer, sizeof frame->block, &frame->block, GL_STREAM_DRAW);
    glBindBufferBase(GL_UNIFORM_BUFFER, FRAME_BLOCK_BINDING, capture->frame_buffer);
    glBindBufferBase(GL_UNIFORM_BUFFER, 1, capture->ground_buffer);
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, capture->output);
    glEnable(GL_RASTERIZER_DISCARD);
    glUseProgram(capture->program);
    glBindVertexArray(capture->vertex_array);
    glBeginTransformFeedback(GL_POINTS);
    glDrawArraysInstanced(GL_POINTS, 0, 1, 1);
    glEndTransformFeedback();
    glDisable(GL_RASTERIZER_DISCARD);
    glGetNamedBufferSubData(capture->output, 0, 4 * sizeof(float), clip);
}

static Pixel pixel_from_clip(const float clip[4]) {
    return (Pixel){WIDTH * 0.5L * (1.0L + (long double)clip[0] / clip[3]),
                   HEIGHT * 0.5L * (1.0L + (long double)clip[1] / clip[3])};
}

// A page's origin: whole metres, some way off the point.
static GridPoint origin_near(GridPoint point, int64_t off_m) {
    return (GridPoint){((point.x >> 12) + off_m) * GRID_LATTICE_PER_M, ((point.y >> 12) - off_m) * GRID_LATTICE_PER_M,
                       ((point.z >> 12) + off_m / 2) * GRID_LATTICE_PER_M};
}

typedef struct Walk {
    double off_px, back_px; // worst distance from the truth, worst step the wrong way
} Walk;

// 300 steps of 1 mm to the side.
static Walk walk_by(const Capture *capture, RenderCamera camera, GridPoint point) {
    Walk walk = {0.0, 0.0};
    Vec3d right = row(&camera.camera_from_ecef, 0), start = camera.eye_ecef;
    double previous = INFINITY;
    for (int step = 0; step < 300; step++) {
        float clip[4];
        camera.eye_ecef = vec3d_mad(start, right, step * 1e-3);
        Frame frame = frame_make(&camera, WIDTH, HEIGHT);
        capture_clip(capture, &frame, origin_near(point, 1000), point, clip);
        Pixel found = pixel_from_clip(clip), truth = project(&camera, point);
        walk.off_px = fmax(walk.off_px, (double)hypotl(found.x - truth.x, found.y - truth.y));
        walk.back_px = fmax(walk.back_px, (double)found.x - previous); // to the right the point goes left
        previous = (double)found.x;
    }
    return walk;
}

static void a_millimetre_of_the_eye_moves_every_vertex_rightly(void **state) {
    (void)state;
    Capture capture = capture_begin();
    Walk worst = {0.0, 0.0};
    for (size_t p = 0; p < COUNT_OF(PLACES); p++) {
        for (size_t d = 0; d < COUNT_OF(DISTANCES_M); d++) {
            RenderCamera camera = camera_at(&PLACES[p], 2.0);
            Walk walk = walk_by(&capture, camera, point_ahead(&camera, DISTANCES_M[d], 0.3, 0.2));
            print_message("%-14s %9.1f m: %.2e px off, %.2e px back\n", PLACES[p].name, DISTANCES_M[d], walk.off_px,
                          walk.back_px);
            worst.off_px = fmax(worst.off_px, walk.off_px);
            worst.back_px = fmax(worst.back_px, walk.back_px);
        }
    }
    capture_end(&capture);
    print_message("worst: %.2e px off (at most %g), %.2e px back (at most %g)\n", worst.off_px, MOST_OFF_PX,
                  worst.back_px, MOST_BACK_PX);
    assert_true(worst.off_px < MOST_OFF_PX);
    assert_true(worst.back_px < MOST_BACK_PX);
}

static void a_shared_vertex_has_the_same_clip_coordinates_from_every_page(void **state) {
    (void)state;
    static const int64_t OFFSETS_M[] = {0, 17, -4000, 120000, -500000};
    Capture capture = capture_begin();
    uint64_t seed = 5;
    int differing = 0, tried = 0;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int i = 0; i < 400; i++) {
        const Place *place = &PLACES[i % (int)COUNT_OF(PLACES)];
        RenderCamera camera = camera_at(place, support_between(&seed, 1.0, 3e4));
        double metres = pow(10.0, support_between(&seed, 0.0, 6.5));
        GridPoint point =
            point_ahead(&camera, metres, support_between(&seed, -0.6, 0.6), support_between(&seed, -0.4, 0.4));
        Frame frame = frame_make(&camera, WIDTH, HEIGHT);
        float first[4], other[4];
        capture_clip(&capture, &frame, origin_near(point, OFFSETS_M[0]), point, first);
        for (size_t k = 1; k < COUNT_OF(OFFSETS_M); k++, tried++) {
            capture_clip(&capture, &frame, origin_near(point, OFFSETS_M[k]), point, other);
            differing += memcmp(first, other, sizeof first) != 0;
        }
    }
    capture_end(&capture);
    print_message("%d of %d differ\n", differing, tried);
    assert_int_equal(differing, 0);
}

// --- two planes

#define PLANE_SIDE 9 // vertices

typedef struct Plane {
    LodVertex vertices[PLANE_SIDE * PLANE_SIDE];
    uint16_t indices[(PLANE_SIDE - 1) * (PLANE_SIDE - 1) * 6];
    LodPage page;
    LodItem item;
} Plane;

// A square `half_m` to each side, `metres` ahead, leaning away by `slope` per metre up.
static void make_plane(Plane *plane, uint64_t id, const RenderCamera *camera, double metres, double half_m,
                       double slope, uint8_t level) {
    GridPoint middle = point_ahead(camera, metres, 0.0, 0.0), origin = origin_near(middle, 3);
    Vec3d right = row(&camera->camera_from_ecef, 0), up = row(&camera->camera_from_ecef, 1);
    Vec3d back = row(&camera->camera_from_ecef, 2), centre = vec3d_mad(camera->eye_ecef, back, -metres);
    for (int y = 0; y < PLANE_SIDE; y++) {
        for (int x = 0; x < PLANE_SIDE; x++) {
            double u = half_m * (2.0 * x / (PLANE_SIDE - 1) - 1.0), v = half_m * (2.0 * y / (PLANE_SIDE - 1) - 1.0);
            Vec3d at = vec3d_mad(vec3d_mad(vec3d_mad(centre, right, u), up, v), back, -v * slope);
            plane->vertices[y * PLANE_SIDE + x] =
                (LodVertex){(int32_t)(llrint(at.x * GRID_LATTICE_PER_M) - origin.x),
                            (int32_t)(llrint(at.y * GRID_LATTICE_PER_M) - origin.y),
                            (int32_t)(llrint(at.z * GRID_LATTICE_PER_M) - origin.z), (uint16_t)x, (uint16_t)y};
        }
    }
    int count = 0;
    for (int y = 0; y < PLANE_SIDE - 1; y++) {
        for (int x = 0; x < PLANE_SIDE - 1; x++) {
            int a = y * PLANE_SIDE + x,
                corners[6] = {a, a + 1, a + PLANE_SIDE + 1, a, a + PLANE_SIDE + 1, a + PLANE_SIDE};
            for (int i = 0; i < 6; i++)
                plane->indices[count++] = (uint16_t)corners[i];
        }
    }
    plane->page =
        (LodPage){.id = id, .vertex_count = PLANE_SIDE * PLANE_SIDE, .origin = origin, .vertices = plane->vertices};
    plane->item = (LodItem){.page = &plane->page,
                            .revision = id,
                            .indices = plane->indices,
                            .index_count = count,
                            .level = level,
                            .centre_ecef = centre,
                            .radius_m = half_m * 3.0};
}

typedef struct Planes {
    Jobs *jobs;
    Terrain *terrain;
    Renderer *renderer;
    uint8_t *near_alone, *far_alone, *both;
    uint64_t next_id; // a page id is never used again
} Planes;

static void draw_planes(Planes *planes, const RenderCamera *camera, const LodItem *items, int count, uint8_t *rgb) {
    RenderPacket packet;
    RenderStats stats;
    memset(&packet, 0, sizeof packet);
    packet.cut = (LodCut){.frame = 1, .item_count = count, .items = items};
    packet.camera = *camera;
    packet.sun_ecef = vec3d_normalize(camera->eye_ecef);
    packet.colouring = RENDER_COLOUR_LEVEL;
    packet.magenta_background = true;
    assert_int_equal(render_frame(planes->renderer, &packet, &stats), RESULT_OK);
    assert_int_equal(render_read_pixels(planes->renderer, rgb), RESULT_OK);
}

// How many pixels of the nearer plane show something else when the farther one is there as well.
static int count_swaps(Planes *planes, const RenderCamera *camera, double metres, double slope, int *covered) {
    Plane near_plane, far_plane;
    double half_m = metres * 0.2;
    make_plane(&near_plane, ++planes->next_id, camera, metres, half_m, slope, 0);
    make_plane(&far_plane, ++planes->next_id, camera, metres + 1.0, half_m * 1.5, slope, 1);
    LodItem items[2] = {far_plane.item, near_plane.item};
    items[0].radius_m *= 2.0; // drawn first
    draw_planes(planes, camera, &near_plane.item, 1, planes->near_alone);
    draw_planes(planes, camera, &far_plane.item, 1, planes->far_alone);
    draw_planes(planes, camera, items, 2, planes->both);
    int swaps = 0;
    *covered = 0;
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++) {
        const uint8_t *alone = planes->near_alone + i * 3;
        if (alone[0] == 255 && alone[1] == 0 && alone[2] == 255)
            continue;
        (*covered)++;
        // The two must be tellable apart for the comparison to mean something.
        assert_memory_not_equal(alone, planes->far_alone + i * 3, 3);
        swaps += memcmp(alone, planes->both + i * 3, 3) != 0;
    }
    return swaps;
}

static Planes planes_begin(void) {
    Planes planes = {.jobs = NULL};
    const DemGeoref georef = {.crs = DEM_CRS_GEOGRAPHIC, .x0 = 20.0, .y0 = 49.5, .dx = 0.001, .dy = -0.001};
    assert_int_equal(jobs_create(2, &planes.jobs), RESULT_OK);
    planes.terrain = support_terrain(support_rough_dem(33, 33, &georef, 100.0, 1), TERRAIN_ERROR_TOTAL, 8, planes.jobs);
    RenderOptions options = render_default_options();
    options.samples = 1;
    options.vram_bytes_max = (size_t)8 << 20;
    assert_int_equal(render_create(&options, planes.terrain, &planes.renderer), RESULT_OK);
    planes.near_alone = malloc((size_t)WIDTH * HEIGHT * 3);
    planes.far_alone = malloc((size_t)WIDTH * HEIGHT * 3);
    planes.both = malloc((size_t)WIDTH * HEIGHT * 3);
    assert_true(planes.near_alone && planes.far_alone && planes.both);
    return planes;
}

static void planes_end(Planes *planes) {
    free(planes->near_alone);
    free(planes->far_alone);
    free(planes->both);
    render_destroy(&planes->renderer);
    terrain_destroy(&planes->terrain);
    jobs_destroy(&planes->jobs);
}

static void planes_one_metre_apart_never_swap(void **state) {
    (void)state;
    static const double SLOPES[] = {0.0, 0.5, 2.0};
    static const double METRES[] = {10.0, 1000.0, 100000.0};
    Planes planes = planes_begin();
    int swaps = 0;
    for (size_t i = 0; i < COUNT_OF(METRES); i++) {
        for (size_t k = 0; k < COUNT_OF(SLOPES); k++) {
            RenderCamera camera = camera_at(&PLACES[3], 3000.0);
            int covered = 0, here = count_swaps(&planes, &camera, METRES[i], SLOPES[k], &covered);
            print_message("%.0f m ahead, leaning %.1f: %d of %d pixels\n", METRES[i], SLOPES[k], here, covered);
            assert_true(covered > 20000);
            swaps += here;
        }
    }
    planes_end(&planes);
    assert_int_equal(swaps, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_millimetre_of_the_eye_moves_every_vertex_rightly),
        cmocka_unit_test(a_shared_vertex_has_the_same_clip_coordinates_from_every_page),
        cmocka_unit_test(planes_one_metre_apart_never_swap),
    };
    Context *context = NULL;
    if (!gl_support_begin(WIDTH, HEIGHT, &context))
        return GL_SKIP_STATUS;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    context_destroy(&context);
    return failed;
}
