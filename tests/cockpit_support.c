#define _GNU_SOURCE // RUSAGE_THREAD
#include "tests/cockpit_support.h"

#include "app/joystick/joystick_files.h"
#include "tests/device_timing.h"
#include "tests/flight_support.h"

#include <stdatomic.h>
#include <stdlib.h>

#define FRAME_NS (INT64_C(1000000000) / 60)
#define WAIT_S 20 // for what comes at once where nothing else runs

static Cockpit *present; // that the wrapped functions write to

// ---- What is listened to ----

void __real_flight_step(Flight *flight, const Controls *controls, double dt_s);
void __wrap_flight_step(Flight *flight, const Controls *controls, double dt_s);
int __real_devices_poll(Devices *devices, DeviceEvent *out, int max);
int __wrap_devices_poll(Devices *devices, DeviceEvent *out, int max);
int __real_hid_read_timeout(void *device, unsigned char *data, size_t size, int wait_ms);
int __wrap_hid_read_timeout(void *device, unsigned char *data, size_t size, int wait_ms);

Result __real_joystick_find_profile(const PadInfo *info, PadProfile *out, char path[PATHS_BYTES_MAX]);
Result __wrap_joystick_find_profile(const PadInfo *info, PadProfile *out, char path[PATHS_BYTES_MAX]);

static atomic_long read_bytes;               // of all reports, by the devices' threads
static atomic_int files_read[2];             // elsewhere, here
static _Thread_local bool is_cockpit_thread; // whether it created a cockpit

Result __wrap_joystick_find_profile(const PadInfo *info, PadProfile *out, char path[PATHS_BYTES_MAX]) {
    atomic_fetch_add(&files_read[is_cockpit_thread], 1);
    return __real_joystick_find_profile(info, out, path);
}

int cockpit_files_read(bool here) {
    return atomic_load(&files_read[here]);
}

int __wrap_hid_read_timeout(void *device, unsigned char *data, size_t size, int wait_ms) {
    int count = __real_hid_read_timeout(device, data, size, wait_ms);
    if (count > 0)
        atomic_fetch_add(&read_bytes, count);
    return count;
}

void __wrap_flight_step(Flight *flight, const Controls *controls, double dt_s) {
    Cockpit *c = present;
    assert_true(c && c->step_count < COCKPIT_STEPS_MAX);
    double begin_ns = (double)(c->step_count - c->origin_step) * COCKPIT_STEP_NS;
    c->steps[c->step_count++] =
        (CockpitStep){.controls = *controls, .begin_ns = c->origin_ns ? c->origin_ns + llround(begin_ns) : 0};
    __real_flight_step(flight, controls, dt_s);
}

int __wrap_devices_poll(Devices *devices, DeviceEvent *out, int max) {
    Cockpit *c = present;
    int count = __real_devices_poll(devices, out, max);
    for (int i = 0; c && i < count; i++) {
        c->heard[out[i].kind]++;
        if (out[i].kind == DEVICE_REPORT && c->report_count < COCKPIT_REPORTS_MAX)
            c->reports[c->report_count++] = (CockpitReport){out[i].time_ns, out[i].state};
    }
    return count;
}

// ---- Begin and end ----

static FlightSettings default_settings(void) {
    Options *options = NULL;
    assert_int_equal(options_create(COMMAND_FLY, &options), RESULT_OK);
    FlightSettings settings = flight_settings_create(options);
    options_destroy(&options);
    return settings;
}

static void start_session(Cockpit *cockpit, const char *aircraft, bool assist) {
    FlightSession *session = cockpit->session = calloc(1, sizeof *session);
    session->settings = default_settings();
    session->aircraft = flight_type(aircraft);
    session->flight = flight_at(&session->aircraft, 1500.0, 0.3, 0.0, session->aircraft.cruise_speed,
                                (FlightGround){flight_flat, &cockpit->ground_m});
    session->begin = session->flight.state;
    session->keyboard = keyboard_create(session->flight.controls.throttle);
    session->keyboard.controls = session->flight.controls;
    session->assist = assist;
    assert_int_equal(pilot_create(&session->pilot), RESULT_OK);
}

Cockpit *cockpit_create(const char *aircraft, bool assist) {
    Cockpit *cockpit = calloc(1, sizeof *cockpit);
    assert_int_equal(setenv("XDG_CONFIG_HOME", "/nowhere", 1) || setenv("XDG_STATE_HOME", "/nowhere", 1), 0);
    cockpit->bed = fake_bed_create();
    fake_stick_plug(cockpit->bed, &FAKE_MOUSE, 30); // so that there is a bus, and nothing to read on it
    start_session(cockpit, aircraft, assist);
    present = cockpit;
    is_cockpit_thread = true;
    return cockpit;
}

void cockpit_destroy(Cockpit **cockpit) {
    present = NULL;
    pilot_destroy(&(*cockpit)->session->pilot);
    fake_bed_destroy(&(*cockpit)->bed);
    free((*cockpit)->session);
    free(*cockpit);
    *cockpit = NULL;
}

// ---- Time ----

void cockpit_sleep_ms(int ms) {
    clock_sleep_until_ns(clock_now_ns() + (int64_t)ms * 1000000);
}

void cockpit_wait(Cockpit *cockpit, DeviceEventKind kind, int count) {
    int64_t until_ns = clock_now_ns() + WAIT_S * INT64_C(1000000000);
    do {
        pilot_poll(cockpit->session->pilot);
        if (cockpit->heard[kind] >= count)
            return;
        clock_sleep_until_ns(clock_now_ns() + 50000);
    } while (clock_now_ns() < until_ns);
    fail_msg("%d events of kind %d within %d s, expected %d", cockpit->heard[kind], kind, WAIT_S, count);
}

void cockpit_send_whole(FakeStick *stick, const uint8_t *bytes, size_t count) {
    long before = atomic_load(&read_bytes);
    int64_t until_ns = clock_now_ns() + WAIT_S * INT64_C(1000000000);
    fake_stick_send(stick, bytes, count);
    while (atomic_load(&read_bytes) < before + (long)count && clock_now_ns() < until_ns)
        clock_sleep_until_ns(clock_now_ns() + 50000);
    assert_int_equal(atomic_load(&read_bytes), before + (long)count);
}

void cockpit_fly(Cockpit *cockpit, int steps) {
    cockpit->session->now_ns = cockpit->origin_ns = 0;
    for (int i = 0; i < steps; i++) {
        session_advance(cockpit->session, FLIGHT_STEP_S);
        assert_true(flight_is_finite(&cockpit->session->flight.state));
    }
}

void cockpit_start_clock(Cockpit *cockpit) {
    cockpit->session->settings.clock.owed_s = 0.0;
    cockpit->origin_ns = cockpit->last_ns = clock_now_ns();
    cockpit->origin_step = cockpit->step_count;
}

static void advance_measured(Cockpit *cockpit, double passed_s) {
    CockpitFrame frame = {.busy_ms = -device_timing_busy_ms(), .sleeps = -device_timing_sleeps()};
    int64_t begin_ns = clock_now_ns();
    session_advance(cockpit->session, passed_s);
    frame.ms = (double)(clock_now_ns() - begin_ns) * 1e-6;
    frame.busy_ms += device_timing_busy_ms();
    frame.sleeps += device_timing_sleeps();
    assert_true(cockpit->frame_count < COCKPIT_FRAMES_MAX);
    cockpit->frames[cockpit->frame_count++] = frame;
}

// As flight_loop.c flies.
void cockpit_frame(Cockpit *cockpit) {
    clock_sleep_until_ns(cockpit->last_ns + FRAME_NS);
    int64_t now_ns = clock_now_ns(), passed_ns = now_ns - cockpit->last_ns;
    int64_t most_ns = (int64_t)(FLIGHT_CLOCK_SPIKE_S * 1e9);
    int first = cockpit->step_count;
    if (passed_ns > most_ns) // the flight leaves the rest out
        cockpit->origin_ns += passed_ns - most_ns;
    cockpit->last_ns = cockpit->session->now_ns = now_ns;
    advance_measured(cockpit, (double)passed_ns * 1e-9);
    for (int i = first; i < cockpit->step_count; i++)
        cockpit->steps[i].seen_ns = clock_now_ns();
}

// ---- Hands ----

FakeStick *cockpit_plug_stick(Cockpit *cockpit, int number, double slider) {
    int arrived = cockpit->heard[DEVICE_ARRIVED];
    FakeStick *stick = fake_stick_plug(cockpit->bed, &FAKE_JOYSTICK, number);
    cockpit_wait(cockpit, DEVICE_ARRIVED, arrived + 1);
    cockpit_move_stick(cockpit, stick, 0.0, 0.0, slider, -1, 0);
    return stick;
}

FakePad *cockpit_plug_pad(Cockpit *cockpit, int address) {
    int arrived = cockpit->heard[DEVICE_ARRIVED];
    FakePad *pad = fake_pad_plug(cockpit->bed, address, FAKE_FREE);
    cockpit_wait(cockpit, DEVICE_ARRIVED, arrived + 1);
    cockpit_move_pad(cockpit, pad, (FakePadHands){.buttons = 0});
    return pad;
}

void cockpit_move_stick(Cockpit *cockpit, FakeStick *stick, double x, double y, double slider, int hat,
                        uint8_t buttons) {
    uint8_t report[FAKE_STICK_BYTES];
    int reports = cockpit->heard[DEVICE_REPORT];
    fake_joystick_report(x, y, 0.0, slider, hat, buttons, report);
    fake_stick_send(stick, report, sizeof report);
    cockpit_wait(cockpit, DEVICE_REPORT, reports + 1);
}

void cockpit_move_pad(Cockpit *cockpit, FakePad *pad, FakePadHands hands) {
    uint8_t report[FAKE_PAD_BYTES];
    int reports = cockpit->heard[DEVICE_REPORT];
    fake_pad_report(&hands, report);
    fake_pad_send(pad, report, sizeof report);
    cockpit_wait(cockpit, DEVICE_REPORT, reports + 1);
}

const CockpitStep *cockpit_last(const Cockpit *cockpit) {
    assert_true(cockpit->step_count > 0);
    return &cockpit->steps[cockpit->step_count - 1];
}
