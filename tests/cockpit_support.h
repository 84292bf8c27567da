// tests/cockpit_support.h: a flight by sticks and pads that are not there: umockdev, hidapi, libusb, Pilot,
// FlightSession. Times as clock_now_ns; shares of full deflection. A Cockpit is the process's only one; it owns its
// session, pilot and bed. Its program is linked with --wrap for flight_step, devices_poll, hid_read_timeout and
// joystick_find_profile: it writes down what the flight got in each step, what the devices said when, how much of it
// was read, and who read files.
#pragma once
#include "app/flight/flight_session.h"
#include "tests/device_support.h"

#define COCKPIT_STEPS_MAX 20000
#define COCKPIT_REPORTS_MAX 4096
#define COCKPIT_FRAMES_MAX 4096
#define COCKPIT_STEP_NS (1e9 / 120.0)

typedef struct CockpitStep {
    Controls controls;
    int64_t begin_ns; // by the clock that cockpit_frame flies by; 0: flown by cockpit_fly
    int64_t seen_ns;  // when session_advance had come back
} CockpitStep;

typedef struct CockpitReport {
    int64_t time_ns;
    PadState state;
} CockpitReport;

typedef struct CockpitFrame {
    double ms, busy_ms; // that session_advance took; of the processor's time
    long sleeps;        // how often the thread gave the processor away
} CockpitFrame;

typedef struct Cockpit {
    FakeBed *bed;
    FlightSession *session;
    double ground_m;
    CockpitStep steps[COCKPIT_STEPS_MAX];
    CockpitReport reports[COCKPIT_REPORTS_MAX];
    CockpitFrame frames[COCKPIT_FRAMES_MAX];
    int step_count, report_count, frame_count;
    int heard[DEVICE_LEFT + 1]; // events of each kind
    int64_t origin_ns, last_ns; // of the clock: when step 0 began; the last frame
    int origin_step;
} Cockpit;

// In level flight, 1500 m above flat ground; its configuration and state folders are nowhere.
Cockpit *cockpit_create(const char *aircraft, bool assist);
void cockpit_destroy(Cockpit **cockpit);

// Polls, without flying, until there were `count` events of the kind in all; fails after 20 s.
void cockpit_wait(Cockpit *cockpit, DeviceEventKind kind, int count);
// Sends what makes no event and waits until it was read: bytes that wait together are read as one report. What was sent
// before has to be read already.
void cockpit_send_whole(FakeStick *stick, const uint8_t *bytes, size_t count);
// So many steps, one a frame, as fast as it goes; what was polled is heard at once.
void cockpit_fly(Cockpit *cockpit, int steps);

// Begins to fly by the clock.
void cockpit_start_clock(Cockpit *cockpit);
// Waits until 1/60 s after the last frame, and flies until now.
void cockpit_frame(Cockpit *cockpit);

// Plugs it in and tells that it rests, with its slider at `slider`.
FakeStick *cockpit_plug_stick(Cockpit *cockpit, int number, double slider);
FakePad *cockpit_plug_pad(Cockpit *cockpit, int address);
// Sends a report and waits until it was polled.
void cockpit_move_stick(Cockpit *cockpit, FakeStick *stick, double x, double y, double slider, int hat,
                        uint8_t buttons);
void cockpit_move_pad(Cockpit *cockpit, FakePad *pad, FakePadHands hands);
const CockpitStep *cockpit_last(const Cockpit *cockpit);
void cockpit_sleep_ms(int ms);
// How often profiles were looked for: by this thread, or by the devices' threads.
int cockpit_files_read(bool here);
