// The head-up display as GL draws it: in its place to a fraction of a pixel, and without a trace in GL's state.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/log.h"
#include "render/context/context.h"
#include "render/gl.h"
#include "render/hud/hud.h"
#include "render/hud/hud_paint.h"
#include "terrain/geodesy.h"

#define WIDTH 1280
#define HEIGHT 800
#define SKIP_STATUS 77

typedef struct Bench {
    Context *context;
    Hud *hud;
    uint8_t rgb[HEIGHT][WIDTH][3]; // bottom row first
} Bench;

// At latitude 0, longitude 0: east is +y, north +z, up +x. Looking north, pitched and then banked to the right.
static RenderPacket packet_make(double pitch, double bank) {
    RenderPacket packet;
    memset(&packet, 0, sizeof packet);
    Vec3d forward = {sin(pitch), 0.0, cos(pitch)}, top = {cos(pitch), 0.0, -sin(pitch)}, east = {0.0, 1.0, 0.0};
    Vec3d right = vec3d_mad(vec3d_scale(east, cos(bank)), top, -sin(bank));
    Vec3d up = vec3d_mad(vec3d_scale(top, cos(bank)), east, sin(bank));
    packet.camera =
        (RenderCamera){{GEODESY_A_M + 1000.0, 0.0, 0.0},
                       {{{right.x, right.y, right.z}, {up.x, up.y, up.z}, {-forward.x, -forward.y, -forward.z}}},
                       60.0 * GEODESY_RAD_PER_DEG};
    packet.cut.view.tau_px = packet.cut.reached_px = 1.0;
    packet.hud = (RenderHud){.show_flight = true,
                             .pitch_rad = pitch,
                             .bank_rad = bank,
                             .speed_m_s = 70.0,
                             .altitude_m = 1000.0,
                             .above_ground_m = 500.0,
                             .throttle = 0.5,
                             .over_terrain = true,
                             .datum = "EGM96",
                             .method = "hybrid",
                             .velocity_ecef = vec3d_scale(forward, 70.0)};
    return packet;
}

static void draw_over(Bench *bench, const RenderPacket *packet, float grey) {
    glClearColor(grey, grey, grey, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    hud_draw(bench->hud, packet, NULL, WIDTH, HEIGHT);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGB, GL_UNSIGNED_BYTE, bench->rgb);
}

static void draw(Bench *bench, const RenderPacket *packet) {
    draw_over(bench, packet, 0.0f);
}

static int set_up(void **state) {
    ContextOptions options = {.width = WIDTH, .height = HEIGHT, .title = "test"};
    HudOptions hud = hud_default_options();
    Bench *bench = calloc(1, sizeof *bench);
    if (!bench)
        return 1;
    if (context_create_offscreen(&options, &bench->context) != RESULT_OK) {
        printf("skipped: no OpenGL 4.5 without a window\n");
        exit(SKIP_STATUS);
    }
    *state = bench;
    return context_make_current(bench->context) != RESULT_OK || hud_create(&hud, &bench->hud) != RESULT_OK;
}

static int tear_down(void **state) {
    Bench *bench = *state;
    hud_destroy(&bench->hud);
    context_release_current(bench->context);
    context_destroy(&bench->context);
    free(bench);
    return 0;
}

// The middle of the light in a column of the picture around `row`, pixels from the top.
static double light_centre(const Bench *bench, int column, double row) {
    double sum = 0.0, moment = 0.0;
    for (int y = (int)row - 5; y <= (int)row + 5; y++) {
        double light = bench->rgb[HEIGHT - 1 - y][column][1];
        sum += light;
        moment += light * (y + 0.5);
    }
    return sum > 0.0 ? moment / sum : -1.0;
}

static void drawn_horizon_is_within_half_a_pixel(void **state) {
    Bench *bench = *state;
    double worst = 0.0, focal = HEIGHT * 0.5 / tan(30.0 * GEODESY_RAD_PER_DEG);
    for (int i = 0; i < 40; i++) {
        double pitch = (-6.0 + 0.31 * i) * GEODESY_RAD_PER_DEG, bank = (i % 5 - 2) * 3.7 * GEODESY_RAD_PER_DEG;
        RenderPacket packet = packet_make(pitch, bank);
        packet.hud.velocity_ecef = (Vec3d){0.0, 0.0, 0.0}; // no marker in the way
        draw(bench, &packet);
        for (int side = -1; side <= 1; side += 2) {
            // Level flight directions lie on y = -tan(pitch) / cos(bank) - x tan(bank), in units of the focal length, y
            // upwards and x to the right: the horizon rises to the right in a right bank.
            int column = WIDTH / 2 + side * 150;
            double x = (column + 0.5 - WIDTH * 0.5) / focal;
            double expected = HEIGHT * 0.5 - focal * (x * tan(bank) - tan(pitch) / cos(bank));
            worst = fmax(worst, fabs(light_centre(bench, column, expected) - expected));
        }
    }
    print_message("80 crossings: expected within 0.5 px, found %.3f px\n", worst);
    assert_true(worst < 0.5);
}

static void marker_is_drawn_where_the_flight_path_points(void **state) {
    Bench *bench = *state;
    RenderPacket packet = packet_make(0.2, 0.0);
    Vec3d forward = {sin(0.2), 0.0, cos(0.2)}, top = {cos(0.2), 0.0, -sin(0.2)};
    packet.hud.velocity_ecef = vec3d_mad(vec3d_mad(vec3d_scale(forward, 70.0), top, -6.0), vec3d(0.0, 1.0, 0.0), 9.0);
    packet.hud.show_numbers = true;
    draw(bench, &packet);
    double focal = HEIGHT * 0.5 / tan(30.0 * GEODESY_RAD_PER_DEG);
    int x = (int)round(WIDTH * 0.5 + focal * 9.0 / 70.0);
    double y = HEIGHT * 0.5 + focal * 6.0 / 70.0;
    double wings = light_centre(bench, x + 13, y);
    print_message("wing of the marker: expected at %.2f, found %.2f\n", y, wings);
    assert_true(fabs(wings - y) < 0.5);
}

// The pointer under the bank scale: its tip touches the marks, at the bank angle from straight down to the right.
static void bank_pointer_stands_at_the_bank_angle(void **state) {
    Bench *bench = *state;
    for (int degrees = -150; degrees <= 150; degrees += 50) {
        double bank = degrees * GEODESY_RAD_PER_DEG;
        RenderPacket packet = packet_make(0.3, bank);
        draw(bench, &packet);
        int x = (int)(WIDTH * 0.5 + 226.0 * sin(bank)), y = (int)(HEIGHT * 0.5 + 226.0 * cos(bank));
        int light = bench->rgb[HEIGHT - 1 - y][x][1], beside = bench->rgb[HEIGHT - 1 - y][WIDTH - 1 - x][1];
        print_message("bank %4d: light %d on the pointer, %d on the other side\n", degrees, light, beside);
        assert_true(light > 200);
        assert_true(degrees == 0 || beside < 60);
    }
}

// A panel of accuracy as it is told.
static void tell_accuracy(RenderPacket *packet, uint64_t revision, double tau_px) {
    packet->hud.accuracy =
        (RenderAccuracy){.show = true, .revision = revision, .tau_px = tau_px, .frame_ms = 20.0, .axis_ms = 50.0};
}

#define STATE_VALUES 64
static int read_state(GLint out[STATE_VALUES]) {
    const GLenum INTEGERS[] = {
        GL_CURRENT_PROGRAM,    GL_VERTEX_ARRAY_BINDING, GL_ARRAY_BUFFER_BINDING,     GL_ACTIVE_TEXTURE,
        GL_BLEND_SRC_RGB,      GL_BLEND_DST_RGB,        GL_BLEND_SRC_ALPHA,          GL_BLEND_DST_ALPHA,
        GL_BLEND_EQUATION_RGB, GL_UNPACK_ALIGNMENT,     GL_UNPACK_ROW_LENGTH,        GL_PIXEL_UNPACK_BUFFER_BINDING,
        GL_DEPTH_FUNC,         GL_DEPTH_WRITEMASK,      GL_DRAW_FRAMEBUFFER_BINDING, GL_TEXTURE_BINDING_2D,
        GL_SAMPLER_BINDING,    GL_CLIP_ORIGIN,          GL_CLIP_DEPTH_MODE};
    const GLenum SWITCHES[] = {GL_BLEND,     GL_DEPTH_TEST,   GL_STENCIL_TEST,
                               GL_CULL_FACE, GL_SCISSOR_TEST, GL_FRAMEBUFFER_SRGB};
    int count = 0;
    for (size_t i = 0; i < COUNT_OF(INTEGERS); i++)
        glGetIntegerv(INTEGERS[i], &out[count++]);
    for (size_t i = 0; i < COUNT_OF(SWITCHES); i++)
        out[count++] = glIsEnabled(SWITCHES[i]);
    glGetIntegerv(GL_VIEWPORT, &out[count]);
    glGetIntegerv(GL_POLYGON_MODE, &out[count + 4]);
    glGetIntegerv(GL_COLOR_WRITEMASK, &out[count + 6]);
    return count + 10;
}

static void set_odd_state(GLuint texture, GLuint sampler, GLuint vertex_array) {
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_CULL_FACE);
    glEnable(GL_SCISSOR_TEST);
    glEnable(GL_STENCIL_TEST);
    glEnable(GL_FRAMEBUFFER_SRGB);
    glDepthFunc(GL_GREATER);
    glBlendFuncSeparate(GL_ONE, GL_SRC_COLOR, GL_DST_ALPHA, GL_ZERO);
    glBlendEquation(GL_FUNC_SUBTRACT);
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    glColorMask(GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE);
    glViewport(3, 5, 77, 55);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 8);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 17);
    glBindTextureUnit(0, texture);
    glBindSampler(0, sampler);
    glBindVertexArray(vertex_array);
    glActiveTexture(GL_TEXTURE0);
}

// Leaves GL as a new context has it, for the tests after.
static void set_plain_state(void) {
    const GLenum SWITCHES[] = {GL_DEPTH_TEST, GL_CULL_FACE, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_FRAMEBUFFER_SRGB};
    for (size_t i = 0; i < COUNT_OF(SWITCHES); i++)
        glDisable(SWITCHES[i]);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    glViewport(0, 0, WIDTH, HEIGHT);
}

static void state_of_gl_is_as_before(void **state) {
    Bench *bench = *state;
    GLuint texture, sampler, vertex_array;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glCreateSamplers(1, &sampler);
    glCreateVertexArrays(1, &vertex_array);
    set_odd_state(texture, sampler, vertex_array);
    GLint before[STATE_VALUES], after[STATE_VALUES];
    RenderPacket packet = packet_make(0.0, 0.0);
    packet.hud.message = "characters that no frame before had: \xD0\x96 \xD0\xA9 \xC3\x9F"; // uploads the atlas
    int count = read_state(before), differing = 0;
    tell_accuracy(&packet, 0, 1.0);
    hud_draw(bench->hud, &packet, NULL, WIDTH, HEIGHT);
    read_state(after);
    for (int i = 0; i < count; i++)
        if (before[i] != after[i] && ++differing)
            print_error("value %d: 0x%x before, 0x%x after\n", i, before[i], after[i]);
    assert_int_equal(differing, 0);
    assert_int_equal(glGetError(), GL_NO_ERROR);
    set_plain_state();
    glDeleteTextures(1, &texture);
    glDeleteSamplers(1, &sampler);
    glDeleteVertexArrays(1, &vertex_array);
}

static uint64_t hash_of(const Bench *bench) {
    const uint8_t *bytes = &bench->rgb[0][0][0];
    uint64_t hash = UINT64_C(14695981039346656037);
    for (size_t i = 0; i < sizeof bench->rgb; i++)
        hash = (hash ^ bytes[i]) * UINT64_C(1099511628211);
    return hash;
}

// Drawn from the kept picture in frames that tell the same, and painted anew where another revision is told.
static void accuracy_is_kept_until_it_changes(void **state) {
    Bench *bench = *state;
    RenderPacket packet = packet_make(0.05, 0.0);
    draw(bench, &packet);
    uint64_t without = hash_of(bench);
    tell_accuracy(&packet, 1, 1.0);
    draw(bench, &packet);
    uint64_t first = hash_of(bench);
    draw(bench, &packet);
    assert_true(hash_of(bench) == first && first != without);
    tell_accuracy(&packet, 1, 4.0); // the same revision: nobody looks
    draw(bench, &packet);
    assert_true(hash_of(bench) == first);
    tell_accuracy(&packet, 2, 4.0);
    draw(bench, &packet);
    assert_true(hash_of(bench) != first);
    tell_accuracy(&packet, 3, 1.0);
    draw(bench, &packet);
    assert_true(hash_of(bench) == first);
    packet.hud.accuracy.show = false;
    draw(bench, &packet);
    assert_true(hash_of(bench) == without);
}

// What lies under the panel shows at its round corners and nowhere else, which is why it may be copied.
static void accuracy_is_opaque_but_for_its_corners(void **state) {
    Bench *bench = *state;
    RenderPacket packet = packet_make(0.05, 0.0);
    tell_accuracy(&packet, 7, 1.0);
    CanvasRect place = hud_accuracy_place(&packet, WIDTH, HEIGHT);
    int x0 = (int)place.x0, x1 = (int)place.x1, y0 = HEIGHT - (int)place.y1, y1 = HEIGHT - (int)place.y0;
    uint8_t(*dark)[WIDTH][3] = malloc(sizeof bench->rgb);
    assert_true(dark && x1 - x0 > 100 && y1 - y0 > 40);
    draw_over(bench, &packet, 0.0f);
    memcpy(dark, bench->rgb, sizeof bench->rgb);
    draw_over(bench, &packet, 1.0f);
    int edge = hud_accuracy_edge_px(&packet, WIDTH, HEIGHT), showing = 0, unpainted = 0;
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++) {
            bool is_corner = (y < y0 + edge || y >= y1 - edge) && (x < x0 + edge || x >= x1 - edge);
            showing += !is_corner && memcmp(dark[y][x], bench->rgb[y][x], 3) != 0;
            unpainted += dark[y][x][2] == 0;
        }
    print_message("%d pixels let the ground through, %d are not painted\n", showing, unpainted);
    assert_int_equal(showing, 0);
    assert_in_range(unpainted, 4, 40);
    for (int i = 0; i < 4; i++) {
        const uint8_t *corner = bench->rgb[i < 2 ? y0 : y1 - 1][i % 2 ? x0 : x1 - 1];
        assert_true(corner[0] > 200 && corner[1] > 200 && corner[2] > 200);
    }
    free(dark);
}

// Odd state of the caller changes nothing of the picture.
static void picture_does_not_depend_on_the_state_before(void **state) {
    Bench *bench = *state;
    RenderPacket packet = packet_make(0.05, 0.2);
    draw(bench, &packet);
    uint8_t *plain = malloc(sizeof bench->rgb);
    assert_non_null(plain);
    memcpy(plain, bench->rgb, sizeof bench->rgb);
    glClear(GL_COLOR_BUFFER_BIT);
    set_odd_state(0, 0, 0);
    hud_draw(bench->hud, &packet, NULL, WIDTH, HEIGHT);
    set_plain_state();
    glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGB, GL_UNSIGNED_BYTE, bench->rgb);
    long lit = 0, differing = 0;
    const uint8_t *now = &bench->rgb[0][0][0];
    for (size_t i = 0; i < sizeof bench->rgb; i++) {
        lit += now[i] > 128;
        differing += now[i] != plain[i];
    }
    free(plain);
    print_message("%ld bright bytes; expected 0 others than before, found %ld\n", lit, differing);
    assert_true(lit > 2000);
    assert_int_equal(differing, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(drawn_horizon_is_within_half_a_pixel),
        cmocka_unit_test(marker_is_drawn_where_the_flight_path_points),
        cmocka_unit_test(bank_pointer_stands_at_the_bank_angle),
        cmocka_unit_test(accuracy_is_kept_until_it_changes),
        cmocka_unit_test(accuracy_is_opaque_but_for_its_corners),
        cmocka_unit_test(state_of_gl_is_as_before),
        cmocka_unit_test(picture_does_not_depend_on_the_state_before),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
