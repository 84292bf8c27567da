// HID report descriptors: sticks that are sold, what the specification says of odd ones, and hostile bytes.
#define _GNU_SOURCE
#include "tests/hid_support.h"

#include <fenv.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#include "tests/heard.h"

#define MUTATIONS 200000

static HidDescriptor parsed(const HidSample *sample) {
    HidDescriptor descriptor;
    Result result = hid_descriptor_parse(sample->bytes, sample->count, &descriptor);
    if (result != RESULT_OK)
        fail_msg("%s: %s", sample->name, result_name(result));
    return descriptor;
}

static PadState decoded(const HidDescriptor *descriptor, const uint8_t *report, size_t count) {
    PadState state = pad_at_rest();
    assert_true(hid_report_decode(descriptor, report, count, &state));
    return state;
}

static void expect_shape(const HidSample *sample, const char *axes, int buttons, int hats, int bytes) {
    HidDescriptor descriptor = parsed(sample);
    PadInfo info = {.vendor = 7};
    hid_describe(&descriptor, &info);
    char found[256] = "";
    for (int i = 0; i < info.axis_count; i++)
        snprintf(found + strlen(found), sizeof found - strlen(found), "%s%s", i ? " " : "",
                 pad_axis_name(info.axes[i]));
    int id = descriptor.has_report_ids ? 1 : 0;
    if (strcmp(found, axes) != 0 || info.button_count != buttons || info.hat_count != hats ||
        descriptor.report_bytes[id] != bytes || info.vendor != 7)
        fail_msg("%s: axes %s, %d buttons, %d hats, %d bytes; expected %s, %d, %d, %d", sample->name, found,
                 info.button_count, info.hat_count, descriptor.report_bytes[id], axes, buttons, hats, bytes);
}

static void expect_axis(const PadState *state, int axis, double value, double greatest) {
    double expected = 2.0 * value / greatest - 1.0;
    if (state->axes_unknown >> axis & 1 || !(fabs(state->axes[axis] - expected) < 1e-12))
        fail_msg("axis %d: %.15g, expected %.15g", axis, state->axes[axis], expected);
}

static void expect_raw(const HidDescriptor *descriptor, const PadState *state, int axis, int64_t value, int64_t least,
                       int64_t most) {
    PadInfo info = {.bus = PAD_BUS_HID};
    hid_describe(descriptor, &info);
    assert_int_equal(pad_raw(&info, state, axis), value);
    assert_int_equal(info.ranges[axis].least, least);
    assert_int_equal(info.ranges[axis].most, most);
}

static void expect_hat(const PadState *state, int direction) {
    if (state->hats[0] != direction)
        fail_msg("hat: %d, expected %d", state->hats[0], direction);
}

static void expect_buttons(const PadState *state, uint64_t low) {
    if (state->buttons[0] != low || state->buttons[1] != 0)
        fail_msg("buttons: %llx %llx, expected %llx 0", (unsigned long long)state->buttons[0],
                 (unsigned long long)state->buttons[1], (unsigned long long)low);
}

#define BYTES(...) ((const uint8_t[]){__VA_ARGS__}), sizeof((const uint8_t[]){__VA_ARGS__})
#define JOYSTICK 0x05, 0x01, 0x09, 0x04, 0xa1, 0x01

static HidDescriptor of_bytes(const uint8_t *bytes, size_t count) {
    return parsed(&(HidSample){"made here", bytes, count});
}

// ---- Sticks that are sold ----

static void common_sticks_have_the_right_axes(void **state) {
    (void)state;
    expect_shape(&hid_x52, "x y rz z rx ry slider", 34, 1, 14);
    expect_shape(&hid_hotas4, "x y z rz rx ry", 14, 1, 64);
    expect_shape(&hid_raptor, "x y rx z rz ry slider", 29, 1, 64);
    expect_shape(&hid_extreme3d, "x y rz slider", 12, 1, 7);
    expect_shape(&hid_t16000m, "x y rz slider", 16, 1, 64);
    expect_shape(&hid_t16000m_short, "x y rz slider", 16, 1, 9);
    expect_shape(&hid_twcs, "x y rz rx ry slider dial z", 14, 1, 64);
    expect_shape(&hid_t_rudder, "x y z", 0, 0, 43);
}

#define AXIS HID_FIELD_AXIS
#define HAT HID_FIELD_HAT
#define BUTTON HID_FIELD_BUTTON

// Bits count from the report's first byte, which is its id where there are ids.
typedef struct FieldPlace {
    const HidSample *sample;
    HidFieldKind kind;
    int index;
    uint32_t bit;
    int bits, least, greatest;
} FieldPlace;

static void expect_place(const FieldPlace *place) {
    HidDescriptor descriptor = parsed(place->sample);
    for (int i = 0; i < descriptor.field_count; i++) {
        const HidField *field = &descriptor.fields[i];
        if (field->kind != place->kind || field->index != place->index)
            continue;
        if (field->bit != place->bit || field->bits != place->bits || field->logical_min != place->least ||
            field->logical_max != place->greatest)
            fail_msg("%s, field %d of kind %d: bit %u, %d bits, %lld to %lld; expected %u, %d, %d, %d",
                     place->sample->name, place->index, (int)place->kind, field->bit, field->bits,
                     (long long)field->logical_min, (long long)field->logical_max, place->bit, place->bits,
                     place->least, place->greatest);
        return;
    }
    fail_msg("%s: no field %d of kind %d", place->sample->name, place->index, (int)place->kind);
}

static void the_fields_lie_where_the_descriptors_say(void **state) {
    (void)state;
    static const FieldPlace places[] = {
        {&hid_extreme3d, AXIS, 0, 0, 10, 0, 1023},
        {&hid_extreme3d, AXIS, 1, 10, 10, 0, 1023},
        {&hid_extreme3d, HAT, 0, 20, 4, 0, 7},
        {&hid_extreme3d, AXIS, 2, 24, 8, 0, 255},
        {&hid_extreme3d, BUTTON, 0, 32, 1, 0, 1},
        {&hid_extreme3d, BUTTON, 7, 39, 1, 0, 1},
        {&hid_extreme3d, AXIS, 3, 40, 8, 0, 255},
        {&hid_extreme3d, BUTTON, 8, 48, 1, 0, 1},
        {&hid_extreme3d, BUTTON, 11, 51, 1, 0, 1},
        {&hid_t16000m, BUTTON, 0, 0, 1, 0, 1},
        {&hid_t16000m, BUTTON, 15, 15, 1, 0, 1},
        {&hid_t16000m, HAT, 0, 16, 4, 0, 7},
        {&hid_t16000m, AXIS, 0, 24, 14, 0, 16383},
        {&hid_t16000m, AXIS, 1, 40, 14, 0, 16383},
        {&hid_t16000m, AXIS, 2, 56, 8, 0, 255},
        {&hid_t16000m, AXIS, 3, 64, 8, 0, 255},
        {&hid_x52, AXIS, 0, 0, 11, 0, 2047},
        {&hid_x52, AXIS, 1, 11, 11, 0, 2047},
        {&hid_x52, AXIS, 2, 22, 10, 0, 1023},
        {&hid_x52, AXIS, 3, 32, 8, 0, 255},
        {&hid_x52, AXIS, 6, 56, 8, 0, 255},
        {&hid_x52, BUTTON, 0, 64, 1, 0, 1},
        {&hid_x52, BUTTON, 33, 97, 1, 0, 1},
        {&hid_x52, HAT, 0, 100, 4, 1, 8},
        {&hid_hotas4, AXIS, 0, 8, 8, 0, 255},
        {&hid_hotas4, HAT, 0, 40, 4, 0, 7},
        {&hid_hotas4, BUTTON, 0, 44, 1, 0, 1},
        {&hid_hotas4, BUTTON, 13, 57, 1, 0, 1},
        {&hid_hotas4, AXIS, 5, 72, 8, 0, 255},
        {&hid_raptor, AXIS, 0, 8, 16, 0, 2047},
        {&hid_raptor, AXIS, 2, 40, 16, 0, 1023},
        {&hid_raptor, BUTTON, 28, 164, 1, 0, 1},
        {&hid_raptor, HAT, 0, 264, 16, 0, 239},
        {&hid_twcs, AXIS, 0, 8, 16, 0, 1023},
        {&hid_twcs, AXIS, 6, 104, 16, 0, 1023},
        {&hid_twcs, AXIS, 7, 120, 16, 0, 65535},
        {&hid_twcs, HAT, 0, 136, 4, 0, 7},
        {&hid_twcs, BUTTON, 13, 153, 1, 0, 1},
        {&hid_t_rudder, AXIS, 0, 0, 16, 0, 1023},
        {&hid_t_rudder, AXIS, 2, 32, 16, 0, 1023},
        {&hid_t16000m_short, AXIS, 3, 64, 8, 0, 255},
    };
    for (size_t i = 0; i < COUNT_OF(places); i++)
        expect_place(&places[i]);
}

static void an_x52_report_is_decoded(void **state) {
    (void)state;
    HidDescriptor descriptor = parsed(&hid_x52);
    // Bits from the low end: x 11 = 1024, y 11 = 3, rz 10 = 1023, z 0, rx 255, ry 128, slider 1, buttons 1 and 34,
    // hat 3.
    const uint8_t report[14] = {0x00, 0x1c, 0xc0, 0xff, 0x00, 0xff, 0x80, 0x01, 0x01, 0x00, 0x00, 0x00, 0x32, 0x88};
    PadState pad = decoded(&descriptor, report, sizeof report);
    expect_axis(&pad, 0, 1024, 2047);
    expect_axis(&pad, 1, 3, 2047);
    expect_axis(&pad, 2, 1023, 1023);
    expect_axis(&pad, 3, 0, 255);
    expect_axis(&pad, 4, 255, 255);
    expect_axis(&pad, 5, 128, 255);
    expect_axis(&pad, 6, 1, 255);
    expect_buttons(&pad, 1 | (uint64_t)1 << 33);
    expect_hat(&pad, 2); // 1 is ahead, 3 right; 0 is the null state
    uint8_t centred[14];
    memcpy(centred, report, sizeof report);
    centred[12] = 0x02;
    assert_true(hid_report_decode(&descriptor, centred, sizeof centred, &pad));
    expect_hat(&pad, PAD_HAT_CENTRED);
}

static void a_report_with_an_id_is_decoded(void **state) {
    (void)state;
    HidDescriptor descriptor = parsed(&hid_hotas4);
    uint8_t report[64] = {0x01, 0x80, 0x7f, 0xff, 0x00, 0x16, 0x80, 0x02, 0x40, 0xc0};
    PadState pad = decoded(&descriptor, report, sizeof report);
    expect_axis(&pad, 0, 0x80, 255);
    expect_axis(&pad, 1, 0x7f, 255);
    expect_axis(&pad, 2, 0xff, 255);
    expect_axis(&pad, 3, 0x00, 255);
    expect_axis(&pad, 4, 0x40, 255);
    expect_axis(&pad, 5, 0xc0, 255);
    expect_hat(&pad, 6);
    expect_buttons(&pad, 1 | 1 << 11 | 1 << 13);
}

static void a_hat_that_counts_degrees_is_decoded(void **state) {
    (void)state;
    HidDescriptor descriptor = parsed(&hid_raptor);
    uint8_t report[64] = {0x01, 0xff, 0x07, 0x00, 0x04};
    report[1 + 16] = 0x03;     // buttons 1, 2
    report[1 + 16 + 3] = 0xf0; // button 29, and bits that are no buttons
    for (int direction = 0; direction < 8; direction++) {
        report[33] = (uint8_t)(30 * direction); // as the kernel's driver divides it
        PadState pad = decoded(&descriptor, report, sizeof report);
        expect_hat(&pad, direction);
        expect_axis(&pad, 0, 2047, 2047);
        expect_axis(&pad, 1, 1024, 2047);
        expect_buttons(&pad, 3 | 1 << 28);
    }
    report[33] = 240;
    PadState pad = decoded(&descriptor, report, sizeof report);
    expect_hat(&pad, PAD_HAT_CENTRED);
}

static void a_hat_of_316_degrees_is_decoded_by_its_physical_range(void **state) {
    (void)state;
    HidDescriptor descriptor = of_bytes(BYTES(JOYSTICK, 0x15, 0x00, 0x26, 0x3b, 0x01, 0x35, 0x00, 0x46, 0x3b, 0x01,
                                              0x75, 0x10, 0x95, 0x01, 0x09, 0x39, 0x81, 0x42, 0xc0));
    for (int direction = 0; direction < 8; direction++) {
        int degrees = 45 * direction;
        PadState pad = decoded(&descriptor, BYTES((uint8_t)degrees, (uint8_t)(degrees >> 8)));
        expect_hat(&pad, direction);
    }
}

static void a_hat_of_four_directions_turns_by_quarters(void **state) {
    (void)state;
    HidDescriptor descriptor =
        of_bytes(BYTES(JOYSTICK, 0x15, 0x00, 0x25, 0x03, 0x75, 0x08, 0x95, 0x01, 0x09, 0x39, 0x81, 0x42, 0xc0));
    for (int quarter = 0; quarter < 4; quarter++) {
        PadState pad = decoded(&descriptor, BYTES((uint8_t)quarter));
        expect_hat(&pad, 2 * quarter);
    }
}

// Reports of a device, and what the hand did, beside the descriptor (tests/hid_support.c).
static void reports_of_an_extreme_3d_pro_are_decoded(void **state) {
    (void)state;
    static const struct {
        uint8_t report[7];
        int x, y, twist, slider, hat;
        uint64_t buttons;
    } moves[] = {
        {{0x08, 0x02, 0x88, 0x80, 0x00, 0x00, 0x00}, 520, 512, 128, 0, PAD_HAT_CENTRED, 0},
        {{0xd4, 0x01, 0x80, 0x91, 0x00, 0xff, 0x00}, 468, 0, 145, 255, PAD_HAT_CENTRED, 0},    // ahead
        {{0x98, 0xfe, 0x8f, 0x75, 0x00, 0xff, 0x00}, 664, 1023, 117, 255, PAD_HAT_CENTRED, 0}, // back
        {{0x00, 0x70, 0x87, 0x80, 0x00, 0xff, 0x00}, 0, 476, 128, 255, PAD_HAT_CENTRED, 0},    // left
        {{0xff, 0xf3, 0x87, 0x7b, 0x00, 0xff, 0x00}, 1023, 508, 123, 255, PAD_HAT_CENTRED, 0}, // right
        {{0x02, 0xf2, 0x87, 0x00, 0x00, 0xff, 0x00}, 514, 508, 0, 255, PAD_HAT_CENTRED, 0},    // twisted left
        {{0x00, 0xf2, 0x87, 0xff, 0x00, 0xff, 0x00}, 512, 508, 255, 255, PAD_HAT_CENTRED, 0},  // twisted right
        {{0x00, 0x22, 0x88, 0x80, 0x00, 0xb4, 0x00}, 512, 520, 128, 180, PAD_HAT_CENTRED, 0},
        {{0x00, 0x22, 0x88, 0x80, 0x00, 0x00, 0x08}, 512, 520, 128, 0, PAD_HAT_CENTRED, 1 << 11},
        {{0x00, 0x22, 0x88, 0x80, 0x20, 0x00, 0x00}, 512, 520, 128, 0, PAD_HAT_CENTRED, 1 << 5},
        {{0x08, 0xf2, 0x07, 0x80, 0x00, 0x00, 0x00}, 520, 508, 128, 0, 0, 0},
        {{0x08, 0xf2, 0x37, 0x80, 0x00, 0x00, 0x00}, 520, 508, 128, 0, 3, 0},
        {{0x08, 0xf2, 0x77, 0x80, 0x00, 0x00, 0x00}, 520, 508, 128, 0, 7, 0},
    };
    HidDescriptor descriptor = parsed(&hid_extreme3d);
    for (size_t i = 0; i < COUNT_OF(moves); i++) {
        PadState pad = decoded(&descriptor, moves[i].report, sizeof moves[i].report);
        expect_axis(&pad, 0, moves[i].x, 1023);
        expect_axis(&pad, 1, moves[i].y, 1023);
        expect_axis(&pad, 2, moves[i].twist, 255);
        expect_axis(&pad, 3, moves[i].slider, 255);
        expect_hat(&pad, moves[i].hat);
        expect_buttons(&pad, moves[i].buttons);
    }
}

// Reports at rest, as the tests of a HID reader in Rust have them (T16000M_INPUT, TWCS_INPUT, TFRP_INPUT, whose
// further bytes are the maker's own).
static void published_reports_are_decoded(void **state) {
    (void)state;
    const uint8_t stick[64] = {0x00, 0x00, 0x3f, 0x00, 0x20, 0x00, 0x20, 0xb2, 0xde};
    const struct {
        const HidSample *sample;
        size_t count;
    } firmwares[] = {{&hid_t16000m, 64}, {&hid_t16000m_short, 9}};
    for (size_t i = 0; i < COUNT_OF(firmwares); i++) {
        HidDescriptor descriptor = parsed(firmwares[i].sample);
        PadState pad = decoded(&descriptor, stick, firmwares[i].count);
        expect_axis(&pad, 0, 8192, 16383);
        expect_axis(&pad, 1, 8192, 16383);
        expect_axis(&pad, 2, 178, 255);
        expect_axis(&pad, 3, 222, 255);
        expect_hat(&pad, PAD_HAT_CENTRED);
        expect_buttons(&pad, 0);
    }
    HidDescriptor descriptor = parsed(&hid_twcs);
    const uint8_t lever[64] = {0x01, 0xfe, 0x01, 0x09, 0x02, 0x00, 0x02, 0xff, 0x03, 0xff,
                               0x03, 0x00, 0x02, 0x75, 0x02, 0xfc, 0x89, 0x08, 0x00, 0x00};
    static const int at_rest[] = {510, 521, 512, 1023, 1023, 512, 629};
    PadState pad = decoded(&descriptor, lever, sizeof lever);
    for (int i = 0; i < (int)COUNT_OF(at_rest); i++)
        expect_axis(&pad, i, at_rest[i], 1023);
    expect_axis(&pad, 7, 35324, 65535);
    expect_hat(&pad, PAD_HAT_CENTRED);
    expect_buttons(&pad, 0);
    descriptor = parsed(&hid_t_rudder);
    const uint8_t pedals[43] = {0xff, 0x03, 0xff, 0x03, 0xfb, 0x01};
    pad = decoded(&descriptor, pedals, sizeof pedals);
    expect_axis(&pad, 0, 1023, 1023); // the brakes are at their greatest when let go
    expect_axis(&pad, 1, 1023, 1023);
    expect_axis(&pad, 2, 507, 1023);
}

// ---- What the specification says ----

static void numbers_are_signed_when_the_minimum_is(void **state) {
    (void)state;
    // Signed 12 bits at bit 4; then an unsigned byte whose maximum was written in one byte; then 32 signed bits.
    HidDescriptor descriptor =
        of_bytes(BYTES(JOYSTICK, 0x75, 0x04, 0x95, 0x01, 0x81, 0x03, 0x09, 0x30, 0x16, 0x00, 0xf8, 0x26, 0xff, 0x07,
                       0x75, 0x0c, 0x81, 0x02, 0x15, 0x00, 0x25, 0xff, 0x75, 0x08, 0x09, 0x31, 0x81, 0x02, 0x17, 0x00,
                       0x00, 0x00, 0x80, 0x27, 0xff, 0xff, 0xff, 0x7f, 0x75, 0x20, 0x09, 0x32, 0x81, 0x02, 0xc0));
    PadState pad = decoded(&descriptor, BYTES(0x0f, 0x80, 0xff, 0x00, 0x00, 0x00, 0x80));
    expect_axis(&pad, 0, 0, 4095);
    expect_axis(&pad, 1, 255, 255);
    expect_axis(&pad, 2, 0, 4294967295.0);
    expect_raw(&descriptor, &pad, 0, -2048, -2048, 2047);
    expect_raw(&descriptor, &pad, 1, 255, 0, 255);
    expect_raw(&descriptor, &pad, 2, INT32_MIN, INT32_MIN, INT32_MAX);
    pad = decoded(&descriptor, BYTES(0xf0, 0xff, 0x80, 0xff, 0xff, 0xff, 0x7f));
    expect_axis(&pad, 0, 2047, 4095); // -1 is 2047 steps above -2048
    expect_axis(&pad, 1, 128, 255);
    expect_axis(&pad, 2, 4294967295.0, 4294967295.0);
}

static void a_value_outside_its_range_is_clamped_or_no_change(void **state) {
    (void)state;
    HidDescriptor clamps =
        of_bytes(BYTES(JOYSTICK, 0x09, 0x30, 0x15, 0x0a, 0x25, 0x64, 0x75, 0x08, 0x95, 0x01, 0x81, 0x02, 0xc0));
    PadState pad = decoded(&clamps, BYTES(0xff));
    expect_axis(&pad, 0, 1, 1);
    expect_raw(&clamps, &pad, 0, 255, 10, 100); // as it came
    pad = decoded(&clamps, BYTES(0x00));
    expect_axis(&pad, 0, 0, 1);
    HidDescriptor null =
        of_bytes(BYTES(JOYSTICK, 0x09, 0x30, 0x15, 0x0a, 0x25, 0x64, 0x75, 0x08, 0x95, 0x01, 0x81, 0x42, 0xc0));
    pad = decoded(&null, BYTES(0xff));
    assert_true(pad.axes_unknown & 1); // nothing was told yet
    pad = decoded(&null, BYTES(0x64));
    assert_true(hid_report_decode(&null, BYTES(0x00), &pad));
    expect_axis(&pad, 0, 1, 1);
}

static void push_and_pop_keep_the_global_items(void **state) {
    (void)state;
    HidDescriptor descriptor =
        of_bytes(BYTES(JOYSTICK, 0x15, 0x00, 0x25, 0x7f, 0x75, 0x08, 0x95, 0x01, 0xa4, 0x05, 0x09, 0x25, 0x01, 0x75,
                       0x01, 0x95, 0x08, 0x19, 0x01, 0x29, 0x08, 0x81, 0x02, 0xb4, 0x09, 0x36, 0x81, 0x02, 0xc0));
    PadState pad = decoded(&descriptor, BYTES(0x81, 0x7f));
    expect_buttons(&pad, 0x81);
    expect_axis(&pad, 0, 127, 127);
}

static void usages_may_bring_their_page_or_change_it_between(void **state) {
    (void)state;
    // Rudder with a page of its own; X, then the page of simulation, then throttle; accelerator by a later page.
    HidDescriptor descriptor = of_bytes(BYTES(JOYSTICK, 0x15, 0x00, 0x26, 0xff, 0x00, 0x75, 0x08, 0x95, 0x03, 0x0b,
                                              0xba, 0x00, 0x02, 0x00, 0x09, 0x30, 0x05, 0x02, 0x09, 0xbb, 0x81, 0x02,
                                              0x05, 0x01, 0x09, 0xc4, 0x05, 0x02, 0x95, 0x01, 0x81, 0x02, 0xc0));
    PadInfo info = {.bus = PAD_BUS_HID};
    hid_describe(&descriptor, &info);
    static const PadAxisKind expected[] = {PAD_AXIS_RUDDER, PAD_AXIS_X, PAD_AXIS_THROTTLE, PAD_AXIS_ACCELERATOR};
    assert_int_equal(info.axis_count, COUNT_OF(expected));
    for (size_t i = 0; i < COUNT_OF(expected); i++)
        if (info.axes[i] != expected[i])
            fail_msg("axis %zu: %s, expected %s", i, pad_axis_name(info.axes[i]), pad_axis_name(expected[i]));
}

static void of_alternative_usages_the_first_counts(void **state) {
    (void)state;
    HidDescriptor descriptor = of_bytes(BYTES(JOYSTICK, 0x15, 0x00, 0x25, 0x7f, 0x75, 0x08, 0x95, 0x02, 0xa9, 0x01,
                                              0x09, 0x36, 0x09, 0x37, 0xa9, 0x00, 0x09, 0x30, 0x81, 0x02, 0xc0));
    PadInfo info = {.bus = PAD_BUS_HID};
    hid_describe(&descriptor, &info);
    assert_int_equal(info.axis_count, 2);
    assert_int_equal(info.axes[0], PAD_AXIS_SLIDER);
    assert_int_equal(info.axes[1], PAD_AXIS_X);
}

static void an_array_names_the_buttons_that_are_down(void **state) {
    (void)state;
    HidDescriptor descriptor =
        of_bytes(BYTES(JOYSTICK, 0x05, 0x09, 0x19, 0x00, 0x29, 0x0a, 0x15, 0x00, 0x25, 0x0a, 0x75, 0x04, 0x95, 0x03,
                       0x81, 0x00, 0x75, 0x04, 0x95, 0x01, 0x81, 0x01, 0xc0));
    assert_int_equal(descriptor.button_count, 10);
    PadState pad = decoded(&descriptor, BYTES(0xa1, 0x0f)); // buttons 1, 10, and 15, which there is not
    expect_buttons(&pad, 1 | 1 << 9);
    assert_true(hid_report_decode(&descriptor, BYTES(0x30, 0x00), &pad));
    expect_buttons(&pad, 1 << 2);
}

static void each_report_id_keeps_the_fields_of_the_others(void **state) {
    (void)state;
    HidDescriptor descriptor = of_bytes(BYTES(JOYSTICK, 0x15, 0x00, 0x26, 0xff, 0x00, 0x75, 0x08, 0x95, 0x01, 0x85,
                                              0x01, 0x09, 0x30, 0x81, 0x02, 0x85, 0x02, 0x09, 0x31, 0x81, 0x02, 0xc0));
    PadState pad = decoded(&descriptor, BYTES(0x01, 0xff));
    expect_axis(&pad, 0, 1, 1);
    assert_int_equal(pad.axes_unknown & 3, 2);
    assert_true(hid_report_decode(&descriptor, BYTES(0x02, 0x00), &pad));
    expect_axis(&pad, 0, 1, 1);
    expect_axis(&pad, 1, 0, 1);
}

static void reports_too_short_or_unknown_change_nothing(void **state) {
    (void)state;
    HidDescriptor descriptor = parsed(&hid_hotas4);
    uint8_t report[64] = {0x01, 0xff, 0xff, 0xff, 0xff, 0x00, 0xff, 0xff, 0xff, 0xff};
    PadState before = pad_at_rest(), after = before;
    assert_false(hid_report_decode(&descriptor, report, 63, &after));
    assert_false(hid_report_decode(&descriptor, report, 0, &after));
    report[0] = 0x05; // an output report
    assert_false(hid_report_decode(&descriptor, report, 64, &after));
    report[0] = 0x00;
    assert_false(hid_report_decode(&descriptor, report, 64, &after));
    assert_memory_equal(&before, &after, sizeof before);
    report[0] = 0x01;
    uint8_t longer[70] = {0};
    memcpy(longer, report, sizeof report);
    assert_true(hid_report_decode(&descriptor, longer, sizeof longer, &after));
}

static void relative_constant_and_senseless_fields_are_left_out(void **state) {
    (void)state;
    HidDescriptor descriptor =
        of_bytes(BYTES(JOYSTICK, 0x15, 0x00, 0x25, 0x7f, 0x75, 0x08, 0x95, 0x01, 0x09, 0x30, 0x81, 0x06, // relative
                       0x09, 0x31, 0x81, 0x03,                                                           // constant
                       0x15, 0x7f, 0x09, 0x32, 0x81, 0x02,             // minimum = maximum
                       0x15, 0x00, 0x75, 0x28, 0x09, 0x33, 0x81, 0x02, // 40 bits
                       0x75, 0x00, 0x09, 0x34, 0x81, 0x02, 0x75, 0x08, 0x95, 0x00, 0x09, 0x35, 0x81, 0x02, // no bits
                       0x95, 0x01, 0x09, 0x36, 0x81, 0x02, 0xc0));
    assert_int_equal(descriptor.axis_count, 1);
    PadState pad = decoded(&descriptor, BYTES(9, 9, 9, 9, 9, 9, 9, 9, 127));
    expect_axis(&pad, 0, 127, 127);
}

static void keyboards_and_mice_are_no_pads(void **state) {
    (void)state;
    HidDescriptor descriptor;
    Heard heard;
    heard_begin(&heard);
    Result keyboard = hid_descriptor_parse(BYTES(0x05, 0x01, 0x09, 0x06, 0xa1, 0x01, 0x05, 0x09, 0x19, 0x01, 0x29, 0x08,
                                                 0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x81, 0x02, 0xc0),
                                           &descriptor);
    Result mouse = hid_descriptor_parse(BYTES(0x05, 0x01, 0x09, 0x02, 0xa1, 0x01, 0x09, 0x30, 0x15, 0x00, 0x25, 0x7f,
                                              0x75, 0x08, 0x95, 0x01, 0x81, 0x02, 0xc0),
                                        &descriptor);
    Result empty = hid_descriptor_parse(BYTES(0x05, 0x01), &descriptor);
    heard_end();
    assert_int_equal(keyboard, RESULT_UNSUPPORTED);
    assert_int_equal(mouse, RESULT_UNSUPPORTED);
    assert_int_equal(empty, RESULT_UNSUPPORTED);
    assert_int_equal(heard.errors, 0);
}

static void long_items_are_skipped(void **state) {
    (void)state;
    HidDescriptor descriptor = of_bytes(BYTES(JOYSTICK, 0xfe, 0x03, 0x10, 0xc0, 0xc0, 0xc0, 0x15, 0x00, 0x25, 0x7f,
                                              0x75, 0x08, 0x95, 0x01, 0x09, 0x30, 0x81, 0x02, 0xc0));
    assert_int_equal(descriptor.axis_count, 1);
}

static void damaged_descriptors_are_refused_with_offset_and_item(void **state) {
    (void)state;
    static const struct {
        uint8_t bytes[16];
        size_t count;
        const char *said;
    } damaged[] = {
        {{0x05, 0x01, 0x26, 0xff}, 4, "byte 2, item 0x26 (Logical Maximum): expected 2 bytes of data, found 1"},
        {{0xfe, 0x30, 0x00}, 3, "byte 0, item 0xfe"},
        {{0xfe}, 1, "byte 0, item 0xfe"},
        {{0x05, 0x01, 0xc0}, 3, "byte 2, item 0xc0 (End Collection): no collection is open"},
        {{0xb4}, 1, "byte 0, item 0xb4 (Pop): nothing was pushed"},
        {{0xa4, 0xa4, 0xa4, 0xa4, 0xa4, 0xa4, 0xa4, 0xa4, 0xa4}, 9, "byte 8, item 0xa4 (Push): more than 8"},
        {{0x85, 0x00}, 2, "byte 0, item 0x85 (Report ID): expected a report id of 1 to 255, found 0"},
        {{0x86, 0x00, 0x01}, 3, "expected a report id of 1 to 255, found 256"},
        {{0xa1, 0x01}, 2, "ends with 1 collections open"},
        {{0x77, 0xff, 0xff, 0xff, 0xff, 0x97, 0xff, 0xff, 0xff, 0xff, 0x81, 0x02},
         12,
         "byte 10, item 0x81 (Input): 4294967295 values of 4294967295 bits make the report longer than 4096 bytes"},
    };
    for (size_t i = 0; i < COUNT_OF(damaged); i++) {
        HidDescriptor descriptor;
        Heard heard;
        heard_begin(&heard);
        Result result = hid_descriptor_parse(damaged[i].bytes, damaged[i].count, &descriptor);
        heard_end();
        if (result != RESULT_FORMAT || heard.errors != 1 || !strstr(heard.text, damaged[i].said))
            fail_msg("%zu: %s, %d messages: %s; expected one with \"%s\"", i, result_name(result), heard.errors,
                     heard.text, damaged[i].said);
    }
}

// ---- Hostile bytes ----

static void drop_message(void *user, LogLevel level, const char *message) {
    (void)user, (void)level, (void)message;
}

// Bytes changed, inserted, left out, or cut off: a few of them at a time.
static size_t mutate(uint8_t *bytes, size_t count, size_t room, uint64_t *random) {
    for (uint64_t changes = 1 + hid_random(random) % 4; changes > 0 && count > 1; changes--) {
        size_t at = hid_random(random) % count;
        switch (hid_random(random) % 5) {
        case 0:
            bytes[at] = (uint8_t)hid_random(random);
            break;
        case 1:
            bytes[at] ^= (uint8_t)(1u << hid_random(random) % 8);
            break;
        case 2:
            memmove(bytes + at, bytes + at + 1, count - at - 1);
            count--;
            break;
        case 3:
            if (count < room) {
                memmove(bytes + at + 1, bytes + at, count - at);
                bytes[at] = (uint8_t)hid_random(random);
                count++;
            }
            break;
        default:
            if (hid_random(random) % 8 == 0)
                count = at + 1;
        }
    }
    return count;
}

static void hostile_descriptors_are_parsed_or_refused(void **state) {
    (void)state;
    const HidSample *samples[] = HID_SAMPLES;
    uint64_t seed = 20260101, random = seed;
    log_set_sink(drop_message, NULL);
    for (int i = 0; i < MUTATIONS; i++) {
        const HidSample *sample = samples[i % (int)COUNT_OF(samples)];
        uint8_t bytes[512];
        memcpy(bytes, sample->bytes, sample->count);
        size_t count = mutate(bytes, sample->count, sizeof bytes, &random);
        const char *broken = hid_exercise(bytes, count, random);
        if (broken) {
            log_set_sink(NULL, NULL);
            fail_msg("%s, seed %llu, mutation %d: %s", sample->name, (unsigned long long)seed, i, broken);
        }
    }
    log_set_sink(NULL, NULL);
}

// 255 reports of 4096 bytes whose every bit is a value of `page`, from 2.3 kilobytes.
static size_t claim_much(uint8_t page, uint8_t bytes[HID_DESCRIPTOR_BYTES_MAX]) {
    const uint8_t begin[] = {JOYSTICK, 0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x96, 0xf8, 0x7f, 0x05, page};
    size_t count = sizeof begin;
    memcpy(bytes, begin, sizeof begin);
    for (int id = 1; id < 256; id++) {
        const uint8_t report[] = {0x85, (uint8_t)id, 0x19, 0x01, 0x2a, 0xff, 0xff, 0x81, 0x02};
        memcpy(bytes + count, report, sizeof report);
        count += sizeof report;
    }
    bytes[count++] = 0xc0;
    return count;
}

// Two reports hold more values than any stick; those behind them are not even looked at.
static void a_descriptor_that_claims_much_in_few_bytes_is_read_in_part(void **state) {
    (void)state;
    static uint8_t bytes[HID_DESCRIPTOR_BYTES_MAX + 1];
    static const struct {
        uint8_t page;
        int axes, hats, buttons;
    } claims[] = {{0x01, 18, 2, 0}, {0x02, 12, 0, 0}, {0x09, 0, 0, 128}, {0xff, 0, 0, 0}};
    HidDescriptor descriptor;
    for (size_t i = 0; i < COUNT_OF(claims); i++) {
        size_t count = claim_much(claims[i].page, bytes);
        (void)!hid_descriptor_parse(bytes, count, &descriptor);
        if (descriptor.axis_count != claims[i].axes || descriptor.hat_count != claims[i].hats ||
            descriptor.button_count != claims[i].buttons || descriptor.report_bytes[255] != 4096)
            fail_msg("page %d: %d axes, %d hats, %d buttons, %d bytes; expected %d, %d, %d, 4096", claims[i].page,
                     descriptor.axis_count, descriptor.hat_count, descriptor.button_count, descriptor.report_bytes[255],
                     claims[i].axes, claims[i].hats, claims[i].buttons);
    }
    log_set_sink(drop_message, NULL);
    assert_int_equal(hid_descriptor_parse(bytes, sizeof bytes, &descriptor), RESULT_FORMAT);
    log_set_sink(NULL, NULL);
}

int main(void) {
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(common_sticks_have_the_right_axes),
        cmocka_unit_test(the_fields_lie_where_the_descriptors_say),
        cmocka_unit_test(an_x52_report_is_decoded),
        cmocka_unit_test(a_report_with_an_id_is_decoded),
        cmocka_unit_test(a_hat_that_counts_degrees_is_decoded),
        cmocka_unit_test(a_hat_of_316_degrees_is_decoded_by_its_physical_range),
        cmocka_unit_test(a_hat_of_four_directions_turns_by_quarters),
        cmocka_unit_test(reports_of_an_extreme_3d_pro_are_decoded),
        cmocka_unit_test(published_reports_are_decoded),
        cmocka_unit_test(numbers_are_signed_when_the_minimum_is),
        cmocka_unit_test(a_value_outside_its_range_is_clamped_or_no_change),
        cmocka_unit_test(push_and_pop_keep_the_global_items),
        cmocka_unit_test(usages_may_bring_their_page_or_change_it_between),
        cmocka_unit_test(of_alternative_usages_the_first_counts),
        cmocka_unit_test(an_array_names_the_buttons_that_are_down),
        cmocka_unit_test(each_report_id_keeps_the_fields_of_the_others),
        cmocka_unit_test(reports_too_short_or_unknown_change_nothing),
        cmocka_unit_test(relative_constant_and_senseless_fields_are_left_out),
        cmocka_unit_test(keyboards_and_mice_are_no_pads),
        cmocka_unit_test(long_items_are_skipped),
        cmocka_unit_test(damaged_descriptors_are_refused_with_offset_and_item),
        cmocka_unit_test(hostile_descriptors_are_parsed_or_refused),
        cmocka_unit_test(a_descriptor_that_claims_much_in_few_bytes_is_read_in_part),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
