// Writes the reports of the demonstration `stick`: a stick as a pilot would move it, who looks at the instruments sixty
// times a second. What it flies is what the program flies from the file, step by step.
//   make_stick_demo > assets/data/demos/stick.reports
#include "app/dynamics/flight_model.h"
#include "app/joystick/joystick_files.h"
#include "app/recording/recording.h"
#include "base/paths.h"
#include "input/hid/hid_descriptor.h"
#include "input/mapper.h"
#include "terrain/geo.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define REPORT_BYTES 7
#define STEPS_MOST (180 * 120)
#define TURN 6.283185307179586
#define STALL 48.0 // m/s, up there

// Of the layout that the Logitech Extreme 3D Pro's reports have: X and Y of 10 bits, hat of 4, twist of 8, 8 buttons,
// slider of 8, 4 buttons, 4 bits to spare.
static const uint8_t descriptor_bytes[] = {
    0x05, 0x01, 0x09, 0x04, 0xa1, 0x01, 0xa1, 0x02, 0x15, 0x00, 0x26, 0xff, 0x03, 0x75, 0x0a, 0x95, 0x02,
    0x09, 0x30, 0x09, 0x31, 0x81, 0x02, 0x25, 0x07, 0x35, 0x00, 0x46, 0x3b, 0x01, 0x75, 0x04, 0x95, 0x01,
    0x09, 0x39, 0x81, 0x42, 0x26, 0xff, 0x00, 0x75, 0x08, 0x09, 0x35, 0x81, 0x02, 0xa4, 0x05, 0x09, 0x25,
    0x01, 0x75, 0x01, 0x95, 0x08, 0x19, 0x01, 0x29, 0x08, 0x81, 0x02, 0xb4, 0x09, 0x36, 0x81, 0x02, 0x05,
    0x09, 0x25, 0x01, 0x75, 0x01, 0x95, 0x04, 0x19, 0x09, 0x29, 0x0c, 0x81, 0x02, 0x81, 0x01, 0xc0, 0xc0};

// Where the demonstration begins: assets/data/demos/stick.demo says the same.
#define START_LAT 36.520
#define START_LON (-84.140)
#define START_ALT_M 1400.0
#define START_HEADING 320.0
#define START_SPEED 120.0

typedef struct Hand {
    double aileron, elevator, throttle; // shares
} Hand;

typedef enum Figure { LEVEL, BANK_LEFT, BANK_RIGHT, ROLL, DIVE, LOOP, CLIMB, HOME, ROLL_OUT, REST, OVER } Figure;

typedef struct Pilot {
    Figure figure;
    double since_s, turned_rad; // in this figure
    double pull;                // what the hand holds already
} Pilot;

static double clamp(double value, double most) {
    return fmin(fmax(value, -most), most);
}

static Hand hold(Pilot *pilot, const Flight *flight, const FlightInstruments *now, double bank, double path) {
    const FlightState *state = &flight->state;
    double wanted = clamp(1.2 * (path - now->path_rad), 0.25) * fmax(cos(now->bank_rad), 0.2);
    double turning = now->bank_rad * tan(clamp(now->bank_rad, 1.2)) * 0.06;
    pilot->pull = clamp(pilot->pull + 0.35 * (wanted + turning - state->rate_body.y) / 120.0, 0.5);
    return (Hand){.aileron = clamp(0.9 * (bank - now->bank_rad) - 0.25 * state->rate_body.x, 0.9),
                  .elevator = clamp(0.8 * (wanted + turning - state->rate_body.y) + pilot->pull, 0.9),
                  .throttle = 0.75};
}

// The hand is taken off once the aircraft flies as it began: trimmed, level.
static Hand settle(Pilot *pilot, const Flight *flight, const FlightInstruments *now) {
    double trimmed = flight->controls.throttle;
    if (pilot->figure == REST)
        return (Hand){.throttle = trimmed};
    Hand hand = hold(pilot, flight, now, 0.0, 0.0);
    hand.throttle = fmin(fmax(trimmed + 0.06 * (START_SPEED - now->true_airspeed), 0.0), 1.0);
    return hand;
}

static void go_to(Pilot *pilot, Figure figure) {
    *pilot = (Pilot){.figure = figure, .pull = pilot->pull};
}

static Hand roll(Pilot *pilot, const Flight *flight) {
    pilot->turned_rad += flight->state.rate_body.x / 120.0;
    if (pilot->turned_rad > TURN - 0.5)
        go_to(pilot, pilot->figure + 1);
    double upside_down = 0.5 - 0.5 * cos(pilot->turned_rad);
    return (Hand){.aileron = 0.9, .elevator = pilot->pull - 0.12 * upside_down, .throttle = 0.9};
}

static Hand loop(Pilot *pilot, const Flight *flight, const FlightInstruments *now) {
    pilot->turned_rad += flight->state.rate_body.y / 120.0;
    if (pilot->turned_rad > TURN - 0.25)
        go_to(pilot, pilot->figure + 1);
    // As much as the wing carries short of the stall, up to 3.6 g.
    double load = fmin(0.8 * now->true_airspeed * now->true_airspeed / (STALL * STALL), 3.6);
    pilot->pull = clamp(pilot->pull + 0.7 * (load - now->load_factor) / 120.0, 0.9);
    return (Hand){.aileron = clamp(-0.4 * flight->state.rate_body.x, 0.5),
                  .elevator = clamp(pilot->pull + 0.06 * (load - now->load_factor), 0.9),
                  .throttle = 1.0};
}

static bool lasts(Pilot *pilot, double seconds) {
    if (pilot->since_s < seconds)
        return true;
    go_to(pilot, pilot->figure + 1);
    return false;
}

static Hand move(Pilot *pilot, const Flight *flight) {
    static const struct {
        double seconds, bank, path;
    } HELD[OVER + 1] = {
        [LEVEL] = {5.0, 0.0, 0.02},    [BANK_LEFT] = {11.0, -0.9, 0.0}, [BANK_RIGHT] = {12.0, 0.9, 0.02},
        [DIVE] = {7.0, 0.0, -0.2},     [CLIMB] = {9.0, 0.0, 0.2},       [HOME] = {9.0, -0.5, -0.03},
        [ROLL_OUT] = {11.0, 0.0, 0.0}, [REST] = {6.5, 0.0, 0.0},        [OVER] = {1e9, 0.0, 0.0}};
    FlightInstruments now = flight_instruments(flight);
    pilot->since_s += 1.0 / 120.0;
    if (pilot->figure == ROLL)
        return roll(pilot, flight);
    if (pilot->figure == LOOP)
        return loop(pilot, flight, &now);
    Figure figure = pilot->figure;
    (void)lasts(pilot, HELD[figure].seconds);
    if (figure == ROLL_OUT || figure == REST)
        return settle(pilot, flight, &now);
    return hold(pilot, flight, &now, HELD[figure].bank, HELD[figure].path);
}

// ---- from the hand to the report ----

static const AxisMapping *mapping_of(const PadProfile *profile, PadControl control) {
    for (int i = 0; i < profile->axis_count; i++)
        if (profile->axes[i].control == control)
            return &profile->axes[i];
    return NULL;
}

// Where the axis has to be for its control to be there: by halving, as the mapping is monotonic.
static unsigned code_for(const PadProfile *profile, PadControl control, double wanted, unsigned most) {
    const AxisMapping *mapping = mapping_of(profile, control);
    double low = -1.0, high = 1.0;
    bool rises = profile_axis_value(mapping, 1.0) > profile_axis_value(mapping, -1.0);
    for (int i = 0; i < 40; i++) {
        double middle = 0.5 * (low + high);
        if ((profile_axis_value(mapping, middle) < wanted) == rises)
            low = middle;
        else
            high = middle;
    }
    return (unsigned)lround((0.5 * (low + high) + 1.0) * 0.5 * most);
}

static void report_of(const PadProfile *profile, const Hand *hand, uint8_t report[REPORT_BYTES]) {
    uint64_t bits = code_for(profile, PAD_CONTROL_AILERON, hand->aileron, 1023);
    bits |= (uint64_t)code_for(profile, PAD_CONTROL_ELEVATOR, hand->elevator, 1023) << 10;
    bits |= (uint64_t)8 << 20;   // the hat at rest
    bits |= (uint64_t)128 << 24; // twist in the middle
    bits |= (uint64_t)code_for(profile, PAD_CONTROL_THROTTLE, hand->throttle, 255) << 40;
    for (int i = 0; i < REPORT_BYTES; i++)
        report[i] = (uint8_t)(bits >> (8 * i));
}

static void print_head(void) {
    printf("# The reports of a stick, by make_stick_demo: turns, a roll, a loop.\n"
           "device 046d:c215 Logitech Extreme 3D\n");
    for (size_t i = 0; i < sizeof descriptor_bytes; i++)
        printf("%s%02x%s", i % 16 ? " " : "descriptor ", descriptor_bytes[i],
               i % 16 == 15 || i + 1 == sizeof descriptor_bytes ? "\n" : "");
}

static void print_report(double t_s, const uint8_t report[REPORT_BYTES]) {
    printf("%.4f", floor(t_s * 1e4) * 1e-4); // not later than its step
    for (int i = 0; i < REPORT_BYTES; i++)
        printf(" %02x", report[i]);
    printf("\n");
}

static void tell(const Flight *flight, const Pilot *pilot, double t_s) {
    FlightInstruments now = flight_instruments(flight);
    fprintf(stderr, "%5.1f s figure %d: %.0f m, %.0f m/s, bank %.0f, path %.0f, %.1f g\n", t_s, pilot->figure, now.h_m,
            now.speed_m_s, now.bank_rad * 57.3, now.path_rad * 57.3, now.load_factor);
}

// Everything that is flown with.
typedef struct Studio {
    Aircraft aircraft;
    PadInfo info;
    PadProfile profile;
    HidDescriptor descriptor;
    Mapper mapper;
    Keyboard keyboard;
    PadState state;
    Flight flight;
} Studio;

static Result read_files(Studio *s, double *h_m) {
    char path[PATHS_BYTES_MAX];
    Geoid *geoid = NULL;
    Result result = paths_find_data("geoid/egm96-15.pgm", path);
    if (result == RESULT_OK)
        result = geoid_open(path, &geoid);
    if (result != RESULT_OK)
        return result;
    *h_m = START_ALT_M + geoid_undulation_m(geoid, START_LAT, START_LON);
    geoid_close(&geoid);
    result = aircraft_load("t37", &s->aircraft);
    if (result == RESULT_OK)
        result = joystick_find_profile(&s->info, &s->profile, path);
    return result == RESULT_OK ? hid_descriptor_parse(descriptor_bytes, sizeof descriptor_bytes, &s->descriptor)
                               : result;
}

// No ground: high enough for all of it.
static void begin(Studio *s, double h_m) {
    const FlightStart start = {.lat_rad = START_LAT * GEODESY_RAD_PER_DEG,
                               .lon_rad = START_LON * GEODESY_RAD_PER_DEG,
                               .h_m = h_m,
                               .heading_rad = START_HEADING * GEODESY_RAD_PER_DEG,
                               .speed_m_s = START_SPEED};
    s->flight = flight_create(&s->aircraft, &start, (FlightGround){NULL, NULL});
    s->keyboard = keyboard_create(s->flight.controls.throttle);
    s->keyboard.controls = s->flight.controls;
    s->state = pad_at_rest();
    hid_describe(&s->descriptor, &s->info);
    mapper_init(&s->mapper);
    mapper_connect(&s->mapper, 0, &s->info, &s->profile, NULL);
}

static void move_stick(Studio *s, const Hand *hand, int step) {
    uint8_t report[REPORT_BYTES];
    report_of(&s->profile, hand, report);
    print_report(step / 120.0, report);
    if (hid_report_decode(&s->descriptor, report, sizeof report, &s->state))
        mapper_report(&s->mapper, 0, &s->state, &s->keyboard);
}

static void fly(Studio *s) {
    Pilot pilot = {.figure = LEVEL};
    Hand hand = {.throttle = s->flight.controls.throttle};
    for (int step = 0; pilot.figure != OVER && step < STEPS_MOST; step++) {
        if (step % 2 == 0)
            move_stick(s, &hand, step);
        Controls controls = mapper_sample(&s->mapper, &s->keyboard, FLIGHT_STEP_S);
        controls = recording_controls(recording_quantise(&controls));
        flight_step(&s->flight, &controls, FLIGHT_STEP_S);
        hand = move(&pilot, &s->flight);
        if (step % 120 == 0)
            tell(&s->flight, &pilot, step / 120.0);
    }
}

int main(void) {
    double h_m;
    Studio *studio = calloc(1, sizeof *studio);
    if (!studio)
        return 1;
    studio->info = (PadInfo){.vendor = 0x046d, .product = 0xc215, .name = "Logitech Extreme 3D"};
    Result result = read_files(studio, &h_m);
    if (result == RESULT_OK) {
        print_head();
        begin(studio, h_m);
        fly(studio);
    }
    free(studio);
    return result == RESULT_OK ? 0 : 1;
}
