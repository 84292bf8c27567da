// input/mapper.h: from the pads that are plugged in, and the keyboard, to what the pilot's hands and feet do.
// Shares of full deflection; axes -1..1; seconds. It has no clock: time is what mapper_sample is told.
// A Mapper is a value of a few hundred kilobytes without pointers; one thread at a time.
#pragma once
#include "input/calibration.h"
#include "input/keyboard.h"
#include "input/profile.h"

#define MAPPER_SLOTS 16
#define MAPPER_MOVED 0.04   // of an axis' -1..1: less is noise, and no hand
#define MAPPER_PICK_UP 0.02 // this near, a lever takes over a control that stays where it is left
#define MAPPER_CENTRE_S 0.5 // from where a control was when its pad was unplugged to its rest
#define MAPPER_FADE_S 0.25  // from where a control was when an axis took it over to where the axis has it

typedef enum MapperDriverKind {
    MAPPER_KEYS,    // the keyboard; also: nobody, the control stays
    MAPPER_AXIS,    // of a pad
    MAPPER_BUTTONS, // held buttons of a pad
    MAPPER_RESTING  // its pad is gone, and it returns to its rest
} MapperDriverKind;

typedef struct MapperDriver {
    MapperDriverKind kind;
    int slot, mapping; // of the pad, and of the axis in its profile
} MapperDriver;

typedef struct MapperAxis {
    int index;     // in the pad's state; -1: this pad lacks it
    bool known;    // a report has told where it is
    bool moved;    // by a hand, since it was plugged in or lost its control
    double value;  // as last reported
    double looked; // where it was before it moved
} MapperAxis;

typedef struct MapperSlot {
    bool connected, reported;
    PadProfile profile;
    PadCalibration calibration;
    MapperAxis axes[PAD_AXES_MAX];     // as profile.axes
    bool pressed[PROFILE_BUTTONS_MAX]; // as profile.buttons: the action was told of the press
    PadState state;
} MapperSlot;

typedef struct Mapper {
    MapperSlot slots[MAPPER_SLOTS];
    MapperDriver drivers[PAD_CONTROL_COUNT];
    double values[PAD_CONTROL_COUNT];
    double rest_per_s[PAD_CONTROL_COUNT];   // of those that return to their rest
    double offsets[PAD_CONTROL_COUNT];      // what is left of where they were when an axis took them over
    double fade_per_s[PAD_CONTROL_COUNT];   // of the offsets
    double keys[PAD_CONTROL_COUNT];         // what the keyboard was left with
    uint8_t held_before[ACTION_HELD_COUNT]; // by keys and buttons, at the last sample
} Mapper;

// No pad; the keyboard drives everything.
void mapper_init(Mapper *mapper);

// `profile` NULL: profile_default; `calibration` NULL: none. The pad moves nothing until something on it was moved.
void mapper_connect(Mapper *mapper, int slot, const PadInfo *info, const PadProfile *profile,
                    const PadCalibration *calibration);
// What the pad held returns to its rest within MAPPER_CENTRE_S (stick, rudder, brakes, view) or stays (throttle, flaps,
// trim); what its buttons held is released.
void mapper_disconnect(Mapper *mapper, int slot, Keyboard *keyboard);

// The keyboard's controls were set by somebody else: what stays where it is left (throttle, flaps, trim) has to be met
// or crossed by an axis before that may have it again.
void mapper_keep(Mapper *mapper, Keyboard *keyboard);

// A pad's state, whenever it may have changed; acts in the next sample. Buttons become actions of the keyboard's queue,
// once a press, or hold theirs; those that are down in the first report after plugging in (switches) count from when
// they change. Values that are no numbers are ignored. An axis that does not drive its control takes it over when it
// was moved; where the control stays where it is left, only once it comes within MAPPER_PICK_UP of it, or crosses it.
// Other controls do not jump either: they move as the axis moved, if that is towards it, and what is between the two
// then fades evenly within MAPPER_FADE_S.
void mapper_report(Mapper *mapper, int slot, const PadState *state, Keyboard *keyboard);

// Moves everything on by `dt_s`, the keyboard too, and gives the controls; whatever was touched last drives each. What
// a pad drives is written to the keyboard, so that keys go on from there.
Controls mapper_sample(Mapper *mapper, Keyboard *keyboard, double dt_s);

// Where the pilot looks: right and up are +. Of the last sample.
void mapper_look(const Mapper *mapper, double *right, double *up);
