// input/hid/hid_descriptor.h: what a stick's input reports hold, from its HID report descriptor, and their decoding.
// Bits count from a report's first byte, lowest bit first; numbers are those of "Device Class Definition for HID" 1.11.
// Values without pointers; no device is touched. Any thread.
#pragma once
#include "input/pad.h"

#define HID_DESCRIPTOR_BYTES_MAX 4096 // as Linux
#define HID_REPORT_BYTES_MAX 4096
#define HID_FIELDS_MAX 256

typedef enum HidFieldKind { HID_FIELD_AXIS, HID_FIELD_HAT, HID_FIELD_BUTTON, HID_FIELD_BUTTON_ARRAY } HidFieldKind;

typedef struct HidField {
    HidFieldKind kind;
    PadAxisKind axis;                   // of axes
    uint8_t report_id;                  // 0: the device's reports have none
    uint8_t bits;                       // 1..32, of one value
    bool has_null;                      // a value outside the logical range says "no change"
    uint16_t slots;                     // values one after another: of arrays, else 1
    uint32_t bit;                       // where the first value begins
    int index;                          // of the axis, the hat, the (first) button
    int button_count;                   // buttons an array can name; the first by first_value
    int64_t first_value;                // of arrays
    int64_t logical_min, logical_max;   // minimum < maximum; values are signed when the minimum is
    int64_t physical_min, physical_max; // equal: not told
} HidField;

typedef struct HidDescriptor {
    HidField fields[HID_FIELDS_MAX];
    int field_count;
    int axis_count, button_count, hat_count; // within PAD_*_MAX; what is beyond is left out
    bool has_report_ids;                     // each report opens with a byte that says which one it is
    uint16_t report_bytes[256];              // length of the input report of each id, id included; 0: there is none
} HidDescriptor;

// Of the application collections that are joysticks, gamepads, multi-axis controllers or simulation devices: absolute
// axes (Generic Desktop X .. Wheel, Simulation), hats and buttons; relative, constant and vendor fields are left out,
// as are those whose logical minimum is not below the maximum. Time and memory are bounded whatever the bytes say.
// FORMAT: the descriptor is damaged; one message names the byte's offset and the item. UNSUPPORTED: it is sound, but a
// keyboard, a mouse or the like: not a pad; nothing is logged. Source: HID 1.11, section 6.2.2.
MUST_USE Result hid_descriptor_parse(const uint8_t *bytes, size_t count, HidDescriptor *out);

// The counts, and the kinds and ranges of axes, in the order of the descriptor; the rest of `info` stays.
void hid_describe(const HidDescriptor *descriptor, PadInfo *info);

// Updates what this report tells, and nothing else: reports with other ids keep their fields. `state` begins as
// pad_at_rest(). False, and nothing changes: the report is shorter than the descriptor says, or of an unknown id. A
// hat's value outside its range is its null state: centred. An axis outside its range stays when the field has a null
// state, else it is at the nearer end (HID 1.11, section 6.2.2.5).
bool hid_report_decode(const HidDescriptor *descriptor, const uint8_t *report, size_t count, PadState *state);
