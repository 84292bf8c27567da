// The head-up display as it is painted, before any GL: no overlap, true directions, continuity, no allocation.
#define _GNU_SOURCE
#include <fenv.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/paths.h"
#include "render/hud/hud_paint.h"
#include "terrain/geodesy.h"

#define RAD (3.14159265358979323846 / 180.0)

// Counts allocations of the code under test: the linker puts these before malloc and friends.
static long allocations;
void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);
void *__wrap_malloc(size_t size) {
    allocations++;
    return __real_malloc(size);
}
void *__wrap_calloc(size_t count, size_t size) {
    allocations++;
    return __real_calloc(count, size);
}
void *__wrap_realloc(void *old, size_t size) {
    allocations++;
    return __real_realloc(old, size);
}

typedef struct Bench {
    Text *text;
    Canvas *canvas;
} Bench;

static int set_up(void **state) {
    static Bench bench;
    char path[PATHS_BYTES_MAX];
    if (paths_find_data("fonts/DejaVuSans.ttf", path) != RESULT_OK || text_create(path, &bench.text) != RESULT_OK ||
        canvas_create(&bench.canvas) != RESULT_OK)
        return 1;
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
    *state = &bench;
    return 0;
}

static int tear_down(void **state) {
    Bench *bench = *state;
    fedisableexcept(FE_ALL_EXCEPT);
    canvas_destroy(&bench->canvas);
    text_destroy(&bench->text);
    return 0;
}

// ---- an attitude, independent of the code under test ----

typedef struct Place {
    double lat, lon, h;
} Place;

static Vec3d place_ecef(Place p) {
    double e2 = 0.0066943799901413165, n = 6378137.0 / sqrt(1.0 - e2 * sin(p.lat) * sin(p.lat));
    return (Vec3d){(n + p.h) * cos(p.lat) * cos(p.lon), (n + p.h) * cos(p.lat) * sin(p.lon),
                   (n * (1.0 - e2) + p.h) * sin(p.lat)};
}

static Vec3d place_up(Place p) {
    return (Vec3d){cos(p.lat) * cos(p.lon), cos(p.lat) * sin(p.lon), sin(p.lat)};
}

// Forward, right and up of the aircraft in ECEF after turning by heading, pitch and bank.
typedef struct Axes {
    Vec3d forward, right, up;
} Axes;

static Axes axes_turn(Place p, double heading, double pitch, double bank) {
    Vec3d up = place_up(p), east = {-sin(p.lon), cos(p.lon), 0.0};
    Vec3d north = {-sin(p.lat) * cos(p.lon), -sin(p.lat) * sin(p.lon), cos(p.lat)};
    Vec3d level = vec3d_mad(vec3d_scale(north, cos(heading)), east, sin(heading));
    Vec3d side = vec3d_mad(vec3d_scale(east, cos(heading)), north, -sin(heading));
    Vec3d forward = vec3d_mad(vec3d_scale(level, cos(pitch)), up, sin(pitch));
    Vec3d top = vec3d_mad(vec3d_scale(up, cos(pitch)), level, -sin(pitch));
    return (Axes){forward, vec3d_mad(vec3d_scale(side, cos(bank)), top, -sin(bank)),
                  vec3d_mad(vec3d_scale(top, cos(bank)), side, sin(bank))};
}

static RenderPacket packet_make(Place p, Axes axes, double fov) {
    RenderPacket packet;
    memset(&packet, 0, sizeof packet);
    Vec3d f = axes.forward, r = axes.right, u = axes.up;
    packet.camera = (RenderCamera){place_ecef(p), {{{r.x, r.y, r.z}, {u.x, u.y, u.z}, {-f.x, -f.y, -f.z}}}, fov};
    packet.cut.view.tau_px = packet.cut.reached_px = 1.0;
    Vec3d up = place_up(p), east = {-sin(p.lon), cos(p.lon), 0.0}, north = vec3d_cross(up, east);
    packet.hud = (RenderHud){.show_flight = true,
                             .heading_rad = atan2(vec3d_dot(f, east), vec3d_dot(f, north)),
                             .pitch_rad = asin(fmin(fmax(vec3d_dot(f, up), -1.0), 1.0)),
                             .bank_rad = atan2(-vec3d_dot(r, up), vec3d_dot(u, up)),
                             .speed_m_s = 70.0,
                             .altitude_m = 1500.0,
                             .above_ground_m = 700.0,
                             .throttle = 0.5,
                             .velocity_ecef = vec3d_scale(f, 70.0),
                             .over_terrain = true,
                             .datum = "EGM96",
                             .method = "hybrid"};
    return packet;
}

// ---- layout ----

typedef struct NamedRect {
    const char *name;
    CanvasRect rect;
} NamedRect;

static bool rects_overlap(CanvasRect a, CanvasRect b) {
    return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

static int list_rects(const HudLayout *l, NamedRect out[16]) {
    const NamedRect all[] = {
        {"heading", l->heading},
        {"states", l->states},
        {"speed title", l->speed_title},
        {"speed notes", l->speed_notes},
        {"altitude title", l->altitude_title},
        {"altitude notes", l->altitude_notes},
        {"note", l->note},
        {"message", l->message},
        {"panel", l->panel},
        {"legend", l->legend},
        {"low legend", l->legend_low},
        {"accuracy", l->accuracy},
        {"speed", l->speed_scale.y1 > l->speed_scale.y0 ? l->speed_scale : l->speed_box},
        {"altitude", l->altitude_scale.y1 > l->altitude_scale.y0 ? l->altitude_scale : l->altitude_box},
    };
    memcpy(out, all, sizeof all);
    return (int)COUNT_OF(all);
}

// Distance from the centre to the nearest point of a rectangle.
static float rect_distance(CanvasPoint c, CanvasRect r) {
    float x = fmaxf(fmaxf(r.x0 - c.x, c.x - r.x1), 0.0f), y = fmaxf(fmaxf(r.y0 - c.y, c.y - r.y1), 0.0f);
    return hypotf(x, y);
}

static int count_layout_faults(int width, int height, bool numbers, bool accuracy) {
    HudLayout layout = hud_layout_make(width, height, numbers);
    if (accuracy)
        hud_layout_add_accuracy(&layout, false);
    NamedRect rects[16];
    int count = list_rects(&layout, rects), faults = 0;
    for (int i = 0; i < count; i++) {
        CanvasRect r = rects[i].rect;
        bool outside =
            r.x0 < 0 || r.y0 < 0 || r.x1 > (float)width || r.y1 > (float)height || r.x1 < r.x0 || r.y1 < r.y0;
        bool empty = r.x0 == r.x1;
        bool in_circle = !empty && rect_distance(layout.centre, r) < layout.radius + 11.0f * layout.unit;
        for (int j = 0; j < i; j++)
            if (!empty && rects_overlap(r, rects[j].rect) && ++faults)
                print_error("%dx%d: %s over %s\n", width, height, rects[i].name, rects[j].name);
        if ((outside || in_circle) && ++faults)
            print_error("%dx%d: %s %s (%.0f %.0f %.0f %.0f)\n", width, height, rects[i].name,
                        outside ? "leaves the window" : "lies in the circle", (double)r.x0, (double)r.y0, (double)r.x1,
                        (double)r.y1);
    }
    bool alone = layout.speed_scale.y1 <= layout.speed_scale.y0; // then no scale keeps the title off the readout
    if (alone && layout.speed_box.y0 - layout.speed_title.y1 < 4.0f * layout.unit && ++faults)
        print_error("%dx%d: a title %.0f pixels above the readout\n", width, height,
                    (double)(layout.speed_box.y0 - layout.speed_title.y1));
    float least = width >= 640 && height >= 400 ? 60.0f : 14.0f;
    if (layout.radius < least && ++faults)
        print_error("%dx%d: a circle of %.0f pixels\n", width, height, (double)layout.radius);
    return faults;
}

static void parts_do_not_overlap_at_any_size(void **state) {
    (void)state;
    int faults = 0, sizes = 0;
    for (int width = HUD_WIDTH_LEAST; width <= 4096; width += 32)
        for (int height = HUD_HEIGHT_LEAST; height <= 2400; height += 16, sizes++)
            for (int numbers = 0; numbers < 4 && faults < 40; numbers++)
                faults += count_layout_faults(width, height, numbers % 2 != 0, numbers >= 2);
    print_message("%d sizes: expected 0 faults, found %d\n", sizes, faults);
    assert_int_equal(faults, 0);
}

static void the_replay_bar_is_taken_hold_of_where_it_lies(void **state) {
    (void)state;
    for (int width = HUD_WIDTH_LEAST; width <= 2048; width += 96) {
        HudLayout layout = hud_layout_make(width, width * 5 / 8, false);
        HudReplayPlace place = hud_layout_replay(&layout, width % 64 != 0);
        double x0 = place.bar.x0, x1 = place.bar.x1, y = 0.5 * (place.bar.y0 + place.bar.y1);
        assert_true(x0 >= place.plate.x0 && x1 <= place.plate.x1 && place.plate.y1 <= layout.message.y0);
        assert_int_equal(hud_replay_is_on(&place, x0, y), x1 > x0);
        assert_int_equal(hud_replay_is_on(&place, x1, place.plate.y0), x1 > x0);
        assert_false(hud_replay_is_on(&place, x0 - place.inset, y)); // the times
        assert_false(hud_replay_is_on(&place, x1 + place.inset, y));
        assert_false(hud_replay_is_on(&place, x0, place.plate.y0 - 1.0));
        assert_true(hud_replay_share(&place, x0 - 1e6) == 0.0 && hud_replay_share(&place, x0) == 0.0);
        if (x1 > x0)
            assert_true(fabs(hud_replay_share(&place, x0 + 0.75 * (x1 - x0)) - 0.75) < 1e-9 &&
                        hud_replay_share(&place, x1 + 1e6) == 1.0);
        assert_true(width < 1024 || x1 - x0 > 100.0);
    }
}

// Under the panel of the left half, beside its circle, and in no way of the scales.
static void accuracy_of_a_split_picture_does_not_overlap_at_any_size(void **state) {
    (void)state;
    int faults = 0, shown = 0;
    for (int width = 640; width <= 4096; width += 32)
        for (int height = 400; height <= 2400; height += 16) {
            HudLayout layout = hud_layout_make(width, height, true);
            hud_layout_split(&layout);
            hud_layout_add_accuracy(&layout, true);
            CanvasRect r = layout.accuracy;
            if (r.x1 <= r.x0)
                continue;
            shown++;
            const CanvasRect others[] = {layout.panel,  layout.heading,     layout.note,        layout.message,
                                         layout.legend, layout.speed_title, layout.speed_notes, layout.speed_scale};
            for (size_t i = 0; i < COUNT_OF(others); i++)
                faults += rects_overlap(r, others[i]);
            faults += r.x0 < 0.0f || r.y0 < 0.0f || r.x1 > 0.5f * (float)width || r.y1 > (float)height;
        }
    print_message("%d sizes with a panel: expected 0 faults, found %d\n", shown, faults);
    assert_true(shown > 10000);
    assert_int_equal(faults, 0);
}

static const RenderHelpRow HELP[] = {
    {"PgUp", "more throttle"},
    {"PgDn", "less throttle"},
    {"Up", "nose down"},
    {"Down", "nose up"},
    {"Enter", "rudder right"},
    {"0", "rudder left"},
    {"Esc", "leave"},
    {"F1", "help on and off"},
    {"F3", "write a picture"},
    {"t", "smaller error"},
    {"T", "larger error"},
    {"m", "next level-of-detail method"},
    {"w", "edges on and off"},
    {"Home", "to the start"},
    {"p", "pause"},
    {"x", "narrower field of view"},
    {"a", "time runs faster"},
    {"h", "display on, off"},
    {"X", "wider field of view"},
    {"v", "next view"},
    {"l", "next colouring: land, level, cache, partition"},
};

// Numbers as wide as they get.
static RenderAccuracy extreme_accuracy(void) {
    RenderAccuracy told;
    memset(&told, 0, sizeof told);
    told.show = true;
    told.error = (RenderAccuracyError){.state = RENDER_ACCURACY_MEASURED,
                                       .max_px = 98765.4321,
                                       .p999_px = 98765.4321,
                                       .above_tau_share = 0.99999,
                                       .cracks = 123456789,
                                       .tau_px = 999.99,
                                       .promised_px = 99999.99,
                                       .promises = true,
                                       .age_s = 99999.9};
    for (int i = 0; i < RENDER_ACCURACY_POINTS; i++)
        told.points[told.point_count++] = (RenderAccuracyPoint){.tau_px = 0.01f * exp2f(0.25f * (float)i),
                                                                .frame_ms = 12345.6f / (float)(i + 1),
                                                                .least_ms = 1.0f,
                                                                .most_ms = 99999.0f,
                                                                .freshness = (float)i / RENDER_ACCURACY_POINTS,
                                                                .flown = i % 3 == 0};
    told.slope_known = true;
    told.tau_px = 0.013;
    told.frame_ms = told.p50_ms = told.p99_ms = 12345.6;
    told.seconds = 60.0;
    told.target_ms = 9000.0;
    told.axis_ms = 20000.0;
    told.frame_count = RENDER_ACCURACY_FRAMES;
    for (int i = 0; i < RENDER_ACCURACY_FRAMES; i++)
        told.frames[i] = (RenderAccuracyFrame){1234.5f, 2345.6f, 3456.7f, 99999.0f};
    told.mean = told.frames[0];
    return told;
}

// Values as wide as they get.
static RenderPacket extreme_packet(void) {
    Place place = {0.6, -1.4, 12000.0};
    RenderPacket packet = packet_make(place, axes_turn(place, 3.0, 0.05, 0.1), 60.0 * RAD);
    packet.hud.show_numbers = true;
    packet.hud.speed_m_s = 9876.5;
    packet.hud.altitude_m = 987654321.0;
    packet.hud.above_ground_m = 98765432.0;
    packet.hud.vertical_speed_m_s = -9876.5;
    packet.hud.frame_ms = packet.hud.frame_p99_ms = 12345.6;
    packet.hud.brakes = packet.hud.gear_retracts = packet.hud.autopilot = packet.hud.stalls = true;
    packet.hud.gear = packet.hud.flaps = 1.0;
    packet.hud.trim = packet.hud.rudder = -1.0;
    packet.hud.datum = "ellipsoid";
    packet.hud.crashed = true;
    packet.hud.help = HELP;
    packet.hud.help_count = COUNT_OF(HELP);
    packet.hud.message =
        "a message that is far longer than any window of this program is ever likely to be wide, so that "
        "something has to be left out of it at the end, which is shown by three dots as it should be; "
        "and still it goes on and on, for the sake of the widest of all screens, with \xCF\x84 and \xC3\xA9";
    packet.cut.view.tau_px = 999.99;
    packet.cut.reached_px = 1000.5;
    packet.cut.stats = (LodStats){.triangles = 40000000,
                                  .patches = 1234567,
                                  .patches_reused = 1234567,
                                  .triangles_rebuilt = 40000000,
                                  .refine_ns = 12345678901,
                                  .partitions = 64,
                                  .balance = 1234.56};
    return packet;
}

// Where the ink of a glyph can be: its field less the spread around it.
static CanvasRect glyph_ink(const CanvasShape *glyph) {
    float s = glyph->spread;
    return (CanvasRect){glyph->a[0] + s, glyph->a[1] + s, glyph->a[2] - s, glyph->a[3] - s};
}

static int count_text_faults(const Canvas *canvas, int width, int height) {
    const CanvasShape *shapes;
    int count = canvas_over(canvas, &shapes), faults = 0;
    for (int i = 0; i < count; i++) {
        if (shapes[i].kind != CANVAS_GLYPH)
            continue;
        CanvasRect ink = glyph_ink(&shapes[i]);
        faults += ink.x0 < 0.0f || ink.y0 < 0.0f || ink.x1 > (float)width || ink.y1 > (float)height;
        for (int j = 0; j < i; j++) {
            CanvasRect other = glyph_ink(&shapes[j]);
            // Neighbours in a word may touch, and fields are rounded to whole samples.
            float slack = 0.8f + 0.2f * shapes[j].spread;
            other.x1 -= slack, other.y1 -= slack, other.x0 += slack, other.y0 += slack;
            faults += shapes[j].kind == CANVAS_GLYPH && rects_overlap(ink, other);
        }
    }
    return faults;
}

static void text_stays_inside_and_apart_at_its_widest(void **state) {
    Bench *bench = *state;
    RenderStats previous = {
        .upload_bytes = 999949999, .vram_bytes = 99994999999, .upload_ms = 1234.5, .draw_ms = 1234.5, .software = true};
    int faults = 0;
    const int SIZES[][2] = {{320, 200},   {320, 1200},  {480, 300},   {639, 399},  {1200, 200},
                            {640, 400},   {640, 480},   {640, 1200},  {800, 400},  {800, 600},
                            {921, 576},   {1024, 768},  {1280, 720},  {1280, 800}, {1366, 768},
                            {1920, 1080}, {2560, 1080}, {3840, 2160}, {4096, 500}};
    previous.right = (RenderCutStats){.upload_bytes = 1, .upload_ms = 1234.5, .draw_ms = 1234.5};
    for (size_t i = 0; i < COUNT_OF(SIZES); i++)
        for (int variant = 0; variant < 18; variant++) { // without and with the panel of accuracy; of the map
            int help = variant % 6;                      // and help; for whole pictures, split ones, with names only
            LodItem items[2] = {{.level = 0, .partition = 0}, {.level = 30, .partition = 63}};
            RenderPacket packet = extreme_packet();
            packet.hud.show_help = help % 2;
            packet.split = help >= 2;
            packet.right = packet.cut;
            packet.right.promises = true;
            packet.right.items = items;
            packet.right.item_count = packet.split ? 2 : 0;
            packet.colouring = packet.split ? RENDER_COLOUR_LEVEL : RENDER_COLOUR_LAND;
            packet.hud.right_method = "roam-parallel";
            packet.hud.show_numbers = help < 4;
            packet.hud.show_names = help >= 4;
            packet.hud.target_ms = 12345.6;
            packet.hud.target_out_of_reach = variant % 3 == 1;
            packet.hud.target_missed = variant % 3 == 2;
            if (variant >= 6 && variant < 12)
                packet.hud.accuracy = extreme_accuracy();
            packet.hud.outside = packet.hud.map.show = variant >= 12;
            packet.hud.map.ground_m = 12345.6;
            packet.hud.crashed = variant % 2;
            packet.hud.replay = (RenderReplay){true, 35999.0, 35999.0, -64.0, false, true, true};
            hud_paint(bench->canvas, bench->text, &packet, &previous, SIZES[i][0], SIZES[i][1]);
            int found = count_text_faults(bench->canvas, SIZES[i][0], SIZES[i][1]);
            if (found)
                print_error("%dx%d, variant %d: %d glyphs outside or over others\n", SIZES[i][0], SIZES[i][1], variant,
                            found);
            faults += found;
        }
    assert_int_equal(faults, 0);
}

static bool is_glyph(const CanvasShape *shape, const TextGlyph *glyph) {
    return shape->kind == CANVAS_GLYPH && shape->b[0] == glyph->u0 && shape->b[1] == glyph->v0;
}

// The size of a text that was painted, from the box of its first glyph; 0: it was not.
static float find_text(Bench *bench, const char *ascii) {
    const CanvasShape *shapes;
    int count = canvas_over(bench->canvas, &shapes), length = (int)strlen(ascii);
    for (int i = 0; i + length <= count; i++) {
        int same = 0;
        while (same < length && is_glyph(&shapes[i + same], text_find_glyph(bench->text, (uint32_t)ascii[same])))
            same++;
        const TextGlyph *first = text_find_glyph(bench->text, (uint32_t)ascii[0]);
        if (same == length)
            return (shapes[i].a[3] - shapes[i].a[1]) / (first->y1 - first->y0);
    }
    return 0.0f;
}

// Of all at once, at their widest.
static void every_state_is_told_at_every_size(void **state) {
    Bench *bench = *state;
    static const char *const WORDS[] = {"BRAKE", "GEAR", "DN", "FLP", "AP", "TRIM", "RUD", "STALL"};
    float least_px = INFINITY;
    int told = 0;
    for (int width = HUD_WIDTH_LEAST; width <= 1700; width += 46)
        for (int height = HUD_HEIGHT_LEAST; height <= 1100; height += 50)
            for (int variant = 0; variant < 4; variant++) {
                RenderPacket packet = extreme_packet();
                packet.hud.show_numbers = variant % 2;
                packet.split = packet.hud.show_names = variant / 2;
                hud_paint(bench->canvas, bench->text, &packet, NULL, width, height);
                for (size_t i = 0; i < COUNT_OF(WORDS); i++, told++) {
                    float size_px = find_text(bench, WORDS[i]);
                    if (size_px == 0.0f)
                        fail_msg("%dx%d, variant %d: no %s", width, height, variant, WORDS[i]);
                    least_px = fminf(least_px, size_px);
                }
            }
    print_message("%d words; expected in 8 px or more, found in %.1f\n", told, (double)least_px);
    assert_true(least_px >= 8.0f);
}

static void what_is_neutral_is_not_told(void **state) {
    Bench *bench = *state;
    Place place = {0.6, -1.4, 12000.0};
    RenderPacket packet = packet_make(place, axes_turn(place, 3.0, 0.05, 0.1), 60.0 * RAD);
    hud_paint(bench->canvas, bench->text, &packet, NULL, 1280, 800);
    static const char *const WORDS[] = {"BRAKE", "GEAR", "FLP", "AP", "TRIM", "RUD", "STALL"};
    for (size_t i = 0; i < COUNT_OF(WORDS); i++)
        if (find_text(bench, WORDS[i]) != 0.0f)
            fail_msg("%s without a reason", WORDS[i]);
    packet.hud.rudder = 0.25;
    packet.hud.trim = -0.12;
    hud_paint(bench->canvas, bench->text, &packet, NULL, 1280, 800);
    assert_true(find_text(bench, "R") > 0.0f && find_text(bench, "25") > 0.0f && find_text(bench, "12") > 0.0f);
}

static void an_aircraft_without_engine_has_no_throttle(void **state) {
    Bench *bench = *state;
    Place place = {0.6, -1.4, 12000.0};
    RenderPacket packet = packet_make(place, axes_turn(place, 3.0, 0.05, 0.1), 60.0 * RAD);
    for (int none = 0; none < 2; none++) {
        packet.hud.no_engine = none;
        hud_paint(bench->canvas, bench->text, &packet, NULL, 1280, 800);
        assert_int_equal(find_text(bench, "THR") > 0.0f, !none);
    }
}

static void a_target_says_whether_it_is_held(void **state) {
    Bench *bench = *state;
    Place place = {0.6, -1.4, 12000.0};
    for (int reach = 0; reach < 3; reach++) {
        RenderPacket packet = packet_make(place, axes_turn(place, 3.0, 0.05, 0.1), 60.0 * RAD);
        packet.hud.show_numbers = true;
        packet.hud.target_ms = 16.7;
        packet.hud.target_out_of_reach = reach == 1;
        packet.hud.target_missed = reach == 2;
        hud_paint(bench->canvas, bench->text, &packet, NULL, 1280, 800);
        assert_true(find_text(bench, "target") > 0.0f && find_text(bench, "16.7") > 0.0f);
        // a space is no shape
        assert_int_equal(find_text(bench, "outofreach") > 0.0f, reach == 1);
        assert_int_equal(find_text(bench, "notmet") > 0.0f, reach == 2);
    }
}

// Too small to be read: nothing; but numbers stay finite, which the trap checks.
static void smaller_windows_have_no_display(void **state) {
    Bench *bench = *state;
    const int SIZES[][2] = {{1, 1}, {2, 900}, {900, 2}, {16, 16}, {160, 100}, {319, 200}, {320, 199}, {320, 200}};
    for (size_t i = 0; i < COUNT_OF(SIZES); i++)
        for (int help = 0; help < 2; help++) {
            RenderPacket packet = extreme_packet();
            packet.hud.show_help = help;
            hud_paint(bench->canvas, bench->text, &packet, NULL, SIZES[i][0], SIZES[i][1]);
            const CanvasShape *shapes;
            bool large = SIZES[i][0] >= HUD_WIDTH_LEAST && SIZES[i][1] >= HUD_HEIGHT_LEAST;
            assert_true((canvas_under(bench->canvas, &shapes) > 0) == large);
        }
}

// The first disc of that radius, in the accent's colour: a ring as wide as its radius.
static bool find_disc(const Canvas *canvas, double radius, double *x, double *y) {
    const CanvasShape *shapes;
    int count = canvas_over(canvas, &shapes);
    for (int i = 0; i < count; i++) {
        double outer = 0.5 * (double)(shapes[i].a[2] - shapes[i].a[0]) + (double)shapes[i].b[1];
        if (shapes[i].kind != CANVAS_BOX || fabs(outer - radius) > 0.01)
            continue;
        *x = 0.5 * (double)(shapes[i].a[0] + shapes[i].a[2]);
        *y = 0.5 * (double)(shapes[i].a[1] + shapes[i].a[3]);
        return true;
    }
    return false;
}

// The panel from nothing, from what is no number, and from each state: all shapes are finite and inside the plate.
static int count_accuracy_shapes(Bench *bench, const RenderAccuracy *told, int width, int height) {
    RenderPacket packet = extreme_packet();
    packet.hud.accuracy = *told;
    hud_paint_accuracy_alone(bench->canvas, bench->text, &packet, width, height);
    CanvasRect place = hud_accuracy_place(&packet, width, height);
    const CanvasShape *shapes;
    int count = canvas_over(bench->canvas, &shapes);
    for (int i = 0; i < count; i++) {
        float spread = shapes[i].kind == CANVAS_GLYPH ? shapes[i].spread : 0.0f;
        bool inside = fminf(shapes[i].a[0], shapes[i].a[2]) + spread >= place.x0 &&
                      fmaxf(shapes[i].a[0], shapes[i].a[2]) - spread <= place.x1 &&
                      fminf(shapes[i].a[1], shapes[i].a[3]) + spread >= place.y0 &&
                      fmaxf(shapes[i].a[1], shapes[i].a[3]) - spread <= place.y1;
        if (!inside)
            print_error("%dx%d: a shape of kind %.0f outside, %.1f %.1f to %.1f %.1f of %.1f %.1f to %.1f %.1f\n",
                        width, height, (double)shapes[i].kind, (double)shapes[i].a[0], (double)shapes[i].a[1],
                        (double)shapes[i].a[2], (double)shapes[i].a[3], (double)place.x0, (double)place.y0,
                        (double)place.x1, (double)place.y1);
        assert_true(inside);
    }
    return count;
}

static void accuracy_is_painted_whatever_it_is_told(void **state) {
    Bench *bench = *state;
    const int SIZES[][2] = {{640, 400}, {800, 600}, {1280, 800}, {1920, 1080}, {4096, 500}};
    fenv_t trapping;
    feholdexcept(&trapping); // to compare with what is no number is an exception
    const double NUMBERS[] = {0.0, (double)NAN, (double)INFINITY, -(double)INFINITY, -1.0, 1e300, 1e-300};
    for (size_t i = 0; i < COUNT_OF(SIZES); i++) {
        RenderAccuracy told = {.show = true};
        int empty = count_accuracy_shapes(bench, &told, SIZES[i][0], SIZES[i][1]);
        told = extreme_accuracy();
        int full = count_accuracy_shapes(bench, &told, SIZES[i][0], SIZES[i][1]);
        print_message("%dx%d: %d shapes for nothing, %d for much\n", SIZES[i][0], SIZES[i][1], empty, full);
        assert_true(empty > 40 && full > empty);
        told.slope_known = false; // no line through what was only guessed
        assert_true(count_accuracy_shapes(bench, &told, SIZES[i][0], SIZES[i][1]) < full);
        for (size_t k = 0; k < COUNT_OF(NUMBERS); k++)
            for (int where = 0; where < 4; where++) {
                told = extreme_accuracy();
                double odd = NUMBERS[k];
                told.error.state = (RenderAccuracyState)(k % RENDER_ACCURACY_STATE_COUNT);
                *(double *[]){&told.axis_ms, &told.tau_px, &told.frame_ms, &told.error.max_px}[where] = odd;
                told.p50_ms = told.p99_ms = told.target_ms = told.error.age_s = told.seconds = odd;
                told.points[3] =
                    (RenderAccuracyPoint){(float)NUMBERS[k % 5], (float)NUMBERS[k % 5], 1.0f, 1.0f, 1.0f, k % 2};
                told.frames[7].draw_ms = told.mean.refine_ms = (float)NUMBERS[k % 5];
                count_accuracy_shapes(bench, &told, SIZES[i][0], SIZES[i][1]);
            }
    }
    fesetenv(&trapping);
}

// The point that the flight is at moves with the tolerance: to the right where that grows, and up where time does.
static void the_present_point_moves_along_the_curve(void **state) {
    Bench *bench = *state;
    double x = -1.0, y = 1e9;
    for (double tau = 0.25; tau <= 16.0; tau *= 2.0) {
        RenderPacket packet = extreme_packet();
        packet.hud.accuracy =
            (RenderAccuracy){.show = true, .tau_px = tau, .frame_ms = 10.0 + 4.0 * log2(tau), .axis_ms = 50.0};
        hud_paint_accuracy_alone(bench->canvas, bench->text, &packet, 1280, 800);
        double now_x = 0.0, now_y = 0.0;
        assert_true(find_disc(bench->canvas, 5.0, &now_x, &now_y));
        print_message("tau %.2f: at %.1f, %.1f\n", tau, now_x, now_y);
        assert_true(now_x > x + 10.0 && now_y < y - 2.0);
        x = now_x;
        y = now_y;
    }
}

// ---- directions ----

// Degrees above the horizon of the pixel's direction, in long double from the packet's camera.
static long double pixel_elevation(const RenderCamera *camera, Place place, int width, int height, double x, double y) {
    long double focal = height * 0.5L / tanl((long double)camera->fov_y_rad * 0.5L);
    long double c[3] = {(x - width * 0.5L) / focal, (height * 0.5L - y) / focal, -1.0L}, world[3];
    for (int i = 0; i < 3; i++)
        world[i] = c[0] * camera->camera_from_ecef.m[0][i] + c[1] * camera->camera_from_ecef.m[1][i] +
                   c[2] * camera->camera_from_ecef.m[2][i];
    Vec3d up = place_up(place);
    long double length = sqrtl(world[0] * world[0] + world[1] * world[1] + world[2] * world[2]);
    return asinl((world[0] * up.x + world[1] * up.y + world[2] * up.z) / length) / (long double)RAD;
}

static bool is_colour(const CanvasShape *shape, CanvasColour colour) {
    return abs(shape->rgba[0] - (int)(colour.r * 255.0f + 0.5f)) < 2 &&
           abs(shape->rgba[1] - (int)(colour.g * 255.0f + 0.5f)) < 2 &&
           abs(shape->rgba[2] - (int)(colour.b * 255.0f + 0.5f)) < 2;
}

// True when the horizon passes within half a pixel of the point: half a pixel to both sides of the drawn line lie on
// different sides of it.
static bool near_horizon(const RenderPacket *packet, Place place, int width, int height, const float *line, float x,
                         float y) {
    double along_x = line[2] - line[0], along_y = line[3] - line[1], length = hypot(along_x, along_y);
    double nx = -along_y / length * 0.5, ny = along_x / length * 0.5;
    long double a = pixel_elevation(&packet->camera, place, width, height, x + nx, y + ny);
    long double b = pixel_elevation(&packet->camera, place, width, height, x - nx, y - ny);
    if (a * b > 0.0L)
        print_error("at %.2f %.2f: elevations %.5Lf and %.5Lf degrees\n", (double)x, (double)y, a, b);
    return a * b <= 0.0L;
}

static int horizon_lines_checked(Bench *bench, const RenderPacket *packet, Place place, int width, int height) {
    HudPainter painter = {bench->canvas, bench->text, hud_layout_make(width, height, true),
                          hud_view_make(&packet->camera, width, height)};
    canvas_begin(bench->canvas, 1.0f);
    hud_paint_attitude(&painter, packet);
    const CanvasShape *shapes;
    int count = canvas_over(bench->canvas, &shapes), checked = 0;
    for (int i = 0; i < count; i++) {
        const float *line = shapes[i].a;
        bool horizon = shapes[i].kind == CANVAS_LINE && is_colour(&shapes[i], HUD_ACCENT) &&
                       hypotf(line[2] - line[0], line[3] - line[1]) > 20.0f * painter.layout.unit;
        if (!horizon)
            continue;
        assert_true(near_horizon(packet, place, width, height, line, line[0], line[1]));
        assert_true(near_horizon(packet, place, width, height, line, line[2], line[3]));
        checked++;
    }
    return checked;
}

static double random_between(uint64_t *seed, double low, double high) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(*seed >> 11) / 9007199254740992.0;
}

static void horizon_is_within_half_a_pixel(void **state) {
    Bench *bench = *state;
    const uint64_t first_seed = 20260101;
    uint64_t seed = first_seed;
    int checked = 0;
    const int SIZES[][2] = {{640, 400}, {1280, 800}, {3840, 2160}};
    for (int i = 0; i < 3000; i++) {
        Place place = {random_between(&seed, -1.57, 1.57), random_between(&seed, -3.2, 3.2),
                       random_between(&seed, -400, 20000)};
        Axes axes = axes_turn(place, random_between(&seed, 0, 6.3), random_between(&seed, -0.6, 0.6),
                              random_between(&seed, -3.2, 3.2));
        RenderPacket packet = packet_make(place, axes, random_between(&seed, 5, 150) * RAD);
        checked += horizon_lines_checked(bench, &packet, place, SIZES[i % 3][0], SIZES[i % 3][1]);
    }
    print_message("seed %llu: %d halves of horizon lines checked\n", (unsigned long long)first_seed, checked);
    assert_true(checked > 1500);
}

// The true place of a direction, in long double.
static void true_pixel(const RenderCamera *camera, Vec3d direction, int width, int height, long double out[2]) {
    long double d[3] = {direction.x, direction.y, direction.z}, c[3];
    for (int i = 0; i < 3; i++)
        c[i] = camera->camera_from_ecef.m[i][0] * d[0] + camera->camera_from_ecef.m[i][1] * d[1] +
               camera->camera_from_ecef.m[i][2] * d[2];
    long double scale = height / (2.0L * tanl((long double)camera->fov_y_rad / 2.0L));
    out[0] = width / 2.0L + scale * c[0] / -c[2];
    out[1] = height / 2.0L - scale * c[1] / -c[2];
}

// The middle of the marker's ring: the only accent-coloured outline.
static bool find_marker(const Canvas *canvas, double *x, double *y) {
    const CanvasShape *shapes;
    int count = canvas_over(canvas, &shapes);
    for (int i = 0; i < count; i++)
        if (shapes[i].kind == CANVAS_BOX && is_colour(&shapes[i], HUD_ACCENT)) {
            *x = (double)(shapes[i].a[0] + shapes[i].a[2]) * 0.5;
            *y = (double)(shapes[i].a[1] + shapes[i].a[3]) * 0.5;
            return true;
        }
    return false;
}

static void flight_path_marker_is_within_half_a_pixel(void **state) {
    Bench *bench = *state;
    const uint64_t first_seed = 77;
    uint64_t seed = first_seed;
    double worst = 0.0;
    int checked = 0;
    for (int i = 0; i < 3000; i++) {
        Place place = {random_between(&seed, -1.57, 1.57), random_between(&seed, -3.2, 3.2),
                       random_between(&seed, -400, 20000)};
        Axes axes = axes_turn(place, random_between(&seed, 0, 6.3), random_between(&seed, -1.57, 1.57),
                              random_between(&seed, -3.2, 3.2));
        RenderPacket packet = packet_make(place, axes, random_between(&seed, 20, 150) * RAD);
        Vec3d drift =
            vec3d_mad(vec3d_scale(axes.right, random_between(&seed, -6, 6)), axes.up, random_between(&seed, -6, 6));
        packet.hud.velocity_ecef = vec3d_mad(drift, axes.forward, random_between(&seed, 60, 300));
        hud_paint(bench->canvas, bench->text, &packet, NULL, 1280, 800);
        long double expected[2];
        true_pixel(&packet.camera, packet.hud.velocity_ecef, 1280, 800, expected);
        if (hypotl(expected[0] - 640.0L, expected[1] - 400.0L) > 180.0L)
            continue; // beyond the circle it stands on the edge, dimmed
        double x, y;
        assert_true(find_marker(bench->canvas, &x, &y));
        worst = fmax(worst, (double)hypotl(x - expected[0], y - expected[1]));
        checked++;
    }
    print_message("seed %llu: %d markers; expected within 0.5 px, found %.6f px\n", (unsigned long long)first_seed,
                  checked, worst);
    assert_true(checked > 1000);
    assert_true(worst < 0.5);
}

static void marker_hides_at_rest_and_stays_finite_behind(void **state) {
    Bench *bench = *state;
    Place place = {0.5, 0.5, 1000.0};
    Axes axes = axes_turn(place, 1.0, 0.1, 0.0);
    RenderPacket packet = packet_make(place, axes, 60.0 * RAD);
    double x, y;
    packet.hud.velocity_ecef = (Vec3d){0.0, 0.0, 0.0};
    hud_paint(bench->canvas, bench->text, &packet, NULL, 1280, 800);
    assert_false(find_marker(bench->canvas, &x, &y));
    packet.hud.velocity_ecef = vec3d_scale(axes.forward, -70.0);
    hud_paint(bench->canvas, bench->text, &packet, NULL, 1280, 800);
    packet.hud.velocity_ecef = vec3d_mad(vec3d_scale(axes.forward, -70.0), axes.right, 60.0);
    hud_paint(bench->canvas, bench->text, &packet, NULL, 1280, 800);
    assert_true(find_marker(bench->canvas, &x, &y));
    print_message("a path behind and to the right: marker at %.1f, right of 640\n", x);
    assert_true(x > 640.0 && x < 1280.0);
}

// ---- the map ----

// Looking down from a height, the map turned: `heading` is up.
static RenderPacket map_packet(Place ground, double above_m, double heading, double fov) {
    Place eye = {ground.lat, ground.lon, ground.h + above_m};
    RenderPacket packet = packet_make(eye, axes_turn(eye, heading, -90.0 * RAD, 0.0), fov);
    packet.hud.pitch_rad = packet.hud.bank_rad = 0.0;
    packet.hud.outside = packet.hud.map.show = true;
    packet.hud.map.ground_m = above_m;
    packet.hud.map.next = -1;
    packet.hud.aircraft_ecef = place_ecef(ground);
    return packet;
}

// The longest level line of the display's ink below the middle.
static double scale_px(const Canvas *canvas, int height) {
    const CanvasShape *shapes;
    int count = canvas_over(canvas, &shapes);
    double longest = 0.0;
    for (int i = 0; i < count; i++)
        if (shapes[i].kind == CANVAS_LINE && shapes[i].a[1] == shapes[i].a[3] && shapes[i].a[1] > 0.5f * (float)height)
            longest = fmax(longest, fabs((double)(shapes[i].a[2] - shapes[i].a[0])));
    return longest;
}

// Where a place of the ground appears.
static void place_pixel(const RenderPacket *packet, Place place, int width, int height, long double out[2]) {
    true_pixel(&packet->camera, vec3d_sub(place_ecef(place), packet->camera.eye_ecef), width, height, out);
}

// A round number of metres, as told, between two places that are so far apart.
static void check_scale(Bench *bench, double above_m, double fov, const int size[2]) {
    Place ground = {0.6, -1.4, 400.0};
    RenderPacket packet = map_packet(ground, above_m, 1.0, fov);
    hud_paint(bench->canvas, bench->text, &packet, NULL, size[0], size[1]);
    double px = scale_px(bench->canvas, size[1]), e2 = 0.0066943799901413165;
    double s = sin(ground.lat), across = 1.0 - e2 * s * s, along_m = 6378137.0 * (1.0 - e2) / (across * sqrt(across));
    double step_m = 0.01 * above_m; // to the north, so little that the Earth is flat
    long double here[2], there[2];
    place_pixel(&packet, ground, size[0], size[1], here);
    place_pixel(&packet, (Place){ground.lat + step_m / (along_m + ground.h), ground.lon, ground.h}, size[0], size[1],
                there);
    double told_m = px * step_m / (double)hypotl(there[0] - here[0], there[1] - here[1]);
    double decade = pow(10.0, floor(log10(told_m * 1.001))), digit = round(told_m / decade);
    char text[32];
    bool far = digit * decade > 999.0;
    snprintf(text, sizeof text, far ? "%.0fkm" : "%.0fm", digit * decade / (far ? 1000.0 : 1.0));
    print_message("%dx%d, %.0f m, %.0f degrees: %.1f px, %.3f m: \"%s\"\n", size[0], size[1], above_m, fov / RAD, px,
                  told_m, text);
    assert_true(px > 25.0 && fabs(told_m / (digit * decade) - 1.0) < 1e-3);
    assert_true(digit == 1.0 || digit == 2.0 || digit == 5.0);
    assert_true(find_text(bench, text) > 0.0f); // spaces are no shapes
}

static void the_scale_of_the_map_is_as_long_as_it_says(void **state) {
    Bench *bench = *state;
    const int SIZES[][2] = {{320, 200}, {640, 400}, {1280, 800}, {1920, 1080}};
    for (size_t i = 0; i < COUNT_OF(SIZES); i++)
        for (double above_m = 700.0; above_m < 90000.0; above_m *= 3.7)
            check_scale(bench, above_m, (i % 2 ? 60.0 : 25.0) * RAD, SIZES[i]);
}

// The middle and the tip of the lowest triangle: the tip is farthest from the middle.
static bool find_arrow(const Canvas *canvas, int height, double middle[2], double tip[2]) {
    const CanvasShape *shapes;
    int count = canvas_over(canvas, &shapes);
    for (int i = count - 1; i >= 0; i--) {
        const float *a = shapes[i].a, *b = shapes[i].b;
        const double corners[3][2] = {
            {(double)a[0], (double)a[1]}, {(double)a[2], (double)a[3]}, {(double)b[0], (double)b[1]}};
        double farthest = 0.0;
        if (shapes[i].kind != CANVAS_TRIANGLE || corners[0][1] < 0.5 * height)
            continue;
        for (int k = 0; k < 2; k++)
            middle[k] = (corners[0][k] + corners[1][k] + corners[2][k]) / 3.0;
        for (int k = 0; k < 3; k++) {
            double away = hypot(corners[k][0] - middle[0], corners[k][1] - middle[1]);
            if (away > farthest)
                memcpy(tip, corners[k], sizeof corners[k]);
            farthest = fmax(farthest, away);
        }
        return true;
    }
    return false;
}

static void north_is_north_however_the_map_is_turned(void **state) {
    Bench *bench = *state;
    double worst = 0.0;
    for (int degrees = 0; degrees < 360; degrees += 15) {
        Place ground = {-0.9 + 0.08 * (degrees / 15), 0.2 * degrees / 15, 100.0};
        RenderPacket packet = map_packet(ground, 4000.0, degrees * RAD, 60.0 * RAD);
        hud_paint(bench->canvas, bench->text, &packet, NULL, 1280, 800);
        double middle[2] = {0}, tip[2] = {0};
        assert_true(find_arrow(bench->canvas, 800, middle, tip));
        long double here[2], there[2];
        place_pixel(&packet, ground, 1280, 800, here);
        place_pixel(&packet, (Place){ground.lat + 1e-5, ground.lon, ground.h}, 1280, 800, there);
        double pointed = atan2(tip[1] - middle[1], tip[0] - middle[0]);
        double north = atan2((double)(there[1] - here[1]), (double)(there[0] - here[0]));
        worst = fmax(worst, fabs(remainder(pointed - north, 2.0 * 180.0 * RAD)));
        assert_true(find_text(bench, "N") > 0.0f);
    }
    print_message("24 maps: north within %.4f degrees\n", worst / RAD);
    assert_true(worst < 0.01 * RAD);
}

// Whether a line of that colour, below all else, begins or ends within half a pixel of a point.
static bool way_touches(const Canvas *canvas, CanvasColour colour, const long double at[2]) {
    const CanvasShape *shapes;
    int count = canvas_under(canvas, &shapes);
    for (int i = 0; i < count; i++) {
        const float *a = shapes[i].a;
        if (shapes[i].kind == CANVAS_LINE && is_colour(&shapes[i], colour) &&
            fminf(hypotf(a[0] - (float)at[0], a[1] - (float)at[1]), hypotf(a[2] - (float)at[0], a[3] - (float)at[1])) <
                0.5f)
            return true;
    }
    return false;
}

static void ways_lie_on_their_places_and_inside_the_picture(void **state) {
    Bench *bench = *state;
    Place ground = {0.7, 0.2, 500.0};
    RenderMapPlace route[5];
    for (int i = 0; i < 5; i++) // to the north-east, the last ones outside
        route[i] = (RenderMapPlace){place_ecef((Place){0.7 + 1e-4 * i, 0.2 + 1e-4 * i, 100.0 * i}), i == 0, true};
    RenderPacket packet = map_packet(ground, 2000.0, 0.6, 60.0 * RAD);
    packet.hud.map.route = route;
    packet.hud.map.route_count = COUNT_OF(route);
    packet.hud.map.next = 1;
    for (int i = 0; i < 4; i++) // with a gap in the middle
        packet.hud.map.trail[packet.hud.map.trail_count++] =
            (RenderMapPlace){place_ecef((Place){0.7 - 4e-5 * i, 0.2, 500.0}), i == 2, false};
    hud_paint(bench->canvas, bench->text, &packet, NULL, 1280, 800);
    const CanvasShape *shapes;
    int count = canvas_under(bench->canvas, &shapes), trail_lines = 0;
    for (int i = 0; i < 2; i++) {
        long double at[2];
        true_pixel(&packet.camera, vec3d_sub(route[i].ecef, packet.camera.eye_ecef), 1280, 800, at);
        assert_true(way_touches(bench->canvas, HUD_INK, at));
        true_pixel(&packet.camera, vec3d_sub(packet.hud.map.trail[i].ecef, packet.camera.eye_ecef), 1280, 800, at);
        assert_true(way_touches(bench->canvas, HUD_ACCENT, at));
    }
    for (int i = 0; i < count; i++) {
        const float *a = shapes[i].a;
        if (shapes[i].kind != CANVAS_LINE)
            continue;
        bool way = is_colour(&shapes[i], HUD_INK) || is_colour(&shapes[i], HUD_ACCENT);
        trail_lines += is_colour(&shapes[i], HUD_ACCENT);
        assert_true(!way || (fminf(a[0], a[2]) > -1.0f && fmaxf(a[0], a[2]) < 1281.0f && fminf(a[1], a[3]) > -1.0f &&
                             fmaxf(a[1], a[3]) < 801.0f));
    }
    assert_int_equal(trail_lines, 2);
}

// ---- continuity ----

#define CELL_PX 32
#define CELLS_X (1280 / CELL_PX + 2)
#define CELLS_Y (800 / CELL_PX + 2)
typedef struct Ink {
    float cells[CELLS_Y][CELLS_X];
} Ink;

static void drop_ink(Ink *ink, float x, float y, float amount) {
    float column = x / CELL_PX, row = y / CELL_PX;
    if (!(column >= 0.0f && row >= 0.0f && column < CELLS_X - 1 && row < CELLS_Y - 1))
        return;
    int i = (int)column, j = (int)row;
    float u = column - (float)i, v = row - (float)j;
    ink->cells[j][i] += amount * (1 - u) * (1 - v);
    ink->cells[j][i + 1] += amount * u * (1 - v);
    ink->cells[j + 1][i] += amount * (1 - u) * v;
    ink->cells[j + 1][i + 1] += amount * u * v;
}

// Where the picture has how much ink, blurred so that small movements change it little.
static Ink ink_of(const Canvas *canvas, bool with_text) {
    Ink ink;
    memset(&ink, 0, sizeof ink);
    const CanvasShape *shapes;
    int count = canvas_over(canvas, &shapes);
    for (int i = 0; i < count; i++) {
        const float *a = shapes[i].a;
        float opacity = (float)shapes[i].rgba[3] / 255.0f, length = hypotf(a[2] - a[0], a[3] - a[1]);
        if (shapes[i].kind == CANVAS_GLYPH && !with_text)
            continue;
        for (int piece = 0; piece < 8; piece++) {
            float t = ((float)piece + 0.5f) / 8.0f;
            drop_ink(&ink, a[0] + (a[2] - a[0]) * t, a[1] + (a[3] - a[1]) * t, opacity * length / 8.0f);
        }
    }
    return ink;
}

static double ink_change(const Ink *a, const Ink *b) {
    double sum = 0.0;
    for (int j = 0; j < CELLS_Y; j++)
        for (int i = 0; i < CELLS_X; i++)
            sum += fabs((double)(a->cells[j][i] - b->cells[j][i]));
    return sum;
}

// A manoeuvre: the aircraft turns once around an axis fixed in its own frame (x forward, y right, z down), from an
// attitude.
typedef struct Manoeuvre {
    const char *name;
    double pitch, bank; // at the start, degrees
    Vec3d axis;
} Manoeuvre;

static Axes turn_about(Axes from, Vec3d body_axis, double angle) {
    Vec3d k = vec3d_normalize(vec3d_add(vec3d_mad(vec3d_scale(from.forward, body_axis.x), from.right, body_axis.y),
                                        vec3d_scale(from.up, -body_axis.z)));
    Quatd q = quatd_from_axis_angle(k, -angle);
    return (Axes){quatd_rotate(q, from.forward), quatd_rotate(q, from.right), quatd_rotate(q, from.up)};
}

typedef void PaintPart(const HudPainter *painter, const RenderPacket *packet);

static void paint_scales_only(const HudPainter *painter, const RenderPacket *packet) {
    hud_paint_scales(painter, &packet->hud);
}

// From step to step, and from each second step to the next.
static void worst_changes(Bench *bench, const Manoeuvre *m, PaintPart *paint, bool with_text, double *fine,
                          double *coarse) {
    enum { STEPS = 7200 };
    Place place = {0.7, 0.3, 3000.0};
    Axes start = axes_turn(place, 0.4, m->pitch * RAD, m->bank * RAD);
    static Ink inks[3];
    *fine = *coarse = 0.0;
    for (int i = 0; i <= STEPS; i++) {
        Axes axes = turn_about(start, m->axis, 2.0 * 180.0 * RAD * i / STEPS);
        RenderPacket packet = packet_make(place, axes, 60.0 * RAD);
        packet.hud.velocity_ecef = vec3d_mad(vec3d_scale(axes.forward, 70.0), axes.up, -5.0);
        HudPainter painter = {bench->canvas, bench->text, hud_layout_make(1280, 800, true),
                              hud_view_make(&packet.camera, 1280, 800)};
        canvas_begin(bench->canvas, 1.0f);
        paint(&painter, &packet);
        inks[i % 3] = ink_of(bench->canvas, with_text);
        if (i > 0)
            *fine = fmax(*fine, ink_change(&inks[(i + 2) % 3], &inks[i % 3]));
        if (i > 0 && i % 2 == 0)
            *coarse = fmax(*coarse, ink_change(&inks[(i + 1) % 3], &inks[i % 3]));
    }
}

// Steps half as large change a continuous picture about half as much at most; a jump stays as large as it was.
static void picture_is_continuous_through_loops_and_rolls(void **state) {
    Bench *bench = *state;
    const Manoeuvre MANOEUVRES[] = {
        {"loop", 0, 0, {0, 1, 0}},
        {"loop, a degree beside the zenith", 0, 1, {0, 1, 0}},
        {"loop, four degrees beside the zenith", 0, 4, {0, 1, 0}},
        {"loop, banked", 0, 30, {0, 1, 0}},
        {"loop on one wing", 0, 90, {0, 0, 1}},
        {"roll", 0, 0, {1, 0, 0}},
        {"roll, climbing at 60 degrees", 60, 0, {1, 0, 0}},
        {"roll, climbing at 90 degrees", 90, 0, {1, 0, 0}},
        {"roll, diving at 88 degrees", -88, 0, {1, 0, 0}},
        {"tumble", 10, 20, {0.4, 1, 0.3}},
    };
    int faults = 0;
    for (size_t i = 0; i < COUNT_OF(MANOEUVRES); i++)
        for (int part = 0; part < 2; part++) {
            PaintPart *paint = part == 0 ? hud_paint_attitude : paint_scales_only;
            double fine, coarse;
            worst_changes(bench, &MANOEUVRES[i], paint, part == 0, &fine, &coarse);
            print_message("%-40s %-9s 0.1 deg: %8.3f px of ink, 0.05 deg: %8.3f\n", MANOEUVRES[i].name,
                          part == 0 ? "attitude" : "scales", coarse, fine);
            faults += fine > 0.75 * coarse + 1.5;
        }
    assert_int_equal(faults, 0);
}

// ---- numbers ----

static void numbers_are_written_for_people(void **state) {
    (void)state;
    char text[HUD_NUMBER_BYTES];
    const char *unit;
    hud_format_fixed(text, 1234567.0, 0);
    assert_string_equal(text, "1\xE2\x80\x89"
                              "234\xE2\x80\x89"
                              "567");
    hud_format_fixed(text, -0.04, 1);
    assert_string_equal(text, "0.0");
    hud_format_fixed(text, -999.96, 1);
    assert_string_equal(text, "\xE2\x88\x92"
                              "1\xE2\x80\x89"
                              "000.0");
    hud_format_signed(text, 2.34, 1);
    assert_string_equal(text, "+2.3");
    hud_format_fixed(text, (double)INFINITY, 1);
    assert_string_equal(text, "---");
    hud_format_heading(text, 0.001);
    assert_string_equal(text, "360");
    hud_format_heading(text, -90.0 * RAD);
    assert_string_equal(text, "270");
    hud_format_heading(text, 359.6 * RAD);
    assert_string_equal(text, "360");
    hud_format_bytes(text, 999.0, &unit);
    assert_string_equal(text, "999");
    assert_string_equal(unit, "B");
    hud_format_bytes(text, 45678901.0, &unit);
    assert_string_equal(text, "45.7");
    assert_string_equal(unit, "MB");
}

static void painting_allocates_nothing_after_warm_up(void **state) {
    Bench *bench = *state;
    Place place = {0.7, 0.3, 3000.0};
    long before = 0;
    for (int i = 0; i < 2000; i++) {
        if (i == 1000)
            before = allocations;
        Axes axes = axes_turn(place, 0.01 * i, 0.0063 * i, 0.02 * i);
        RenderPacket packet = packet_make(place, axes, 60.0 * RAD);
        packet.hud.show_numbers = true;
        packet.hud.show_help = i % 100 == 99;
        packet.hud.help = HELP;
        packet.hud.help_count = COUNT_OF(HELP);
        packet.hud.message = i % 3 ? "written to overfly-0001.png" : NULL;
        packet.hud.altitude_m = 1.7 * i;
        packet.hud.accuracy = extreme_accuracy();
        packet.hud.accuracy.show = i % 2;
        hud_paint(bench->canvas, bench->text, &packet, NULL, 1280, 800);
    }
    print_message("allocations in 1000 frames: expected 0, found %ld\n", allocations - before);
    assert_int_equal(allocations - before, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_do_not_overlap_at_any_size),
        cmocka_unit_test(the_replay_bar_is_taken_hold_of_where_it_lies),
        cmocka_unit_test(accuracy_of_a_split_picture_does_not_overlap_at_any_size),
        cmocka_unit_test(accuracy_is_painted_whatever_it_is_told),
        cmocka_unit_test(the_present_point_moves_along_the_curve),
        cmocka_unit_test(text_stays_inside_and_apart_at_its_widest),
        cmocka_unit_test(every_state_is_told_at_every_size),
        cmocka_unit_test(what_is_neutral_is_not_told),
        cmocka_unit_test(an_aircraft_without_engine_has_no_throttle),
        cmocka_unit_test(a_target_says_whether_it_is_held),
        cmocka_unit_test(smaller_windows_have_no_display),
        cmocka_unit_test(horizon_is_within_half_a_pixel),
        cmocka_unit_test(flight_path_marker_is_within_half_a_pixel),
        cmocka_unit_test(marker_hides_at_rest_and_stays_finite_behind),
        cmocka_unit_test(the_scale_of_the_map_is_as_long_as_it_says),
        cmocka_unit_test(north_is_north_however_the_map_is_turned),
        cmocka_unit_test(ways_lie_on_their_places_and_inside_the_picture),
        cmocka_unit_test(picture_is_continuous_through_loops_and_rolls),
        cmocka_unit_test(numbers_are_written_for_people),
        cmocka_unit_test(painting_allocates_nothing_after_warm_up),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
