// app/flight/flight_session.h: a flight as it is flown: aircraft, pilot or demo, settings; from passed time to the
// order of the next frame. Knows no window and no thread. Seconds, metres, radians. A FlightSession borrows its World
// and points into itself: it is not copied. One thread.
#pragma once
#include "app/demo/demo.h"
#include "app/dynamics/flight_model.h"
#include "app/flight/flight_map.h"
#include "app/flight/flight_recorder.h"
#include "app/flight/flight_settings.h"
#include "app/flight/governor.h"
#include "app/flight/telemetry.h"
#include "app/pilot/feel.h"
#include "app/pilot/hand_over.h"
#include "app/pilot/pilot.h"
#include "app/pilot/terrain_watch.h"
#include "app/pipeline/pipeline.h"
#include "app/replay/playback.h"
#include "app/replay/timeline.h"
#include "app/scene_load.h"
#include "input/keyboard.h"

#define SESSION_MESSAGE_S 3.0

// What a recording was told of last; it begins with all of it normal.
typedef struct SessionNoted {
    bool paused, demo;
    int rate; // FlightClock's, off its normal one
} SessionNoted;

typedef struct FlightSession {
    const World *world;
    FlightSettings settings;
    Governor governor;     // where settings.target_ms is above 0
    int64_t frames_judged; // that the governor was told of
    GovernorNotice slow_notice;
    Aircraft aircraft;
    const char *aircraft_name; // what aircraft_load finds it by; borrowed
    Flight flight;             // borrows the aircraft: the session stays where it is
    FlightState begin;
    Controls begin_controls; // hands off
    bool stood;              // it began on its wheels: a crash leads back there
    bool assist;             // of the keys
    bool parked;             // the brakes hold until the throttle is moved
    bool holds;              // the autopilot flies, as wished
    Autopilot hold;
    AutopilotWish wish;
    TerrainWatch watch;   // of the ground ahead of a hold
    Controls flown;       // in the last step
    HandOver hand_over;   // to who flies now
    double propeller_rad; // how it stands
    FlightSettings begin_settings;
    double kiosk_idle_s; // so long nobody touches anything until the demo begins again; 0: never
    double idle_s;
    Autopilot help;
    CameraRig rig;
    Keyboard keyboard;
    Pilot *pilot;             // borrowed; NULL: the keyboard alone
    Feel feel;                // of the pilot's hands
    int64_t now_ns;           // until when session_advance flies, as base/clock.h counts; 0: not by a clock
    Telemetry *telemetry;     // borrowed; NULL: none
    FlightRecorder *recorder; // borrowed; NULL: nothing is recorded
    SessionNoted noted;
    Demo demo;
    bool demo_flies;
    FlightMap map;
    Playback *playback; // borrowed: shown instead of flying; NULL: flown
    Timeline timeline;
    PlaybackMoment moment;
    bool pointer_down, scrubs; // the left button; since it went down on the replay's bar
    bool difference_said;      // between what was recorded and what is flown again
    int crashes;
    bool screenshot_wanted, leave_wanted; // by a key; the caller takes them back
    Vec3d sun_ecef;                       // unit
    char message[PIPELINE_MESSAGE_BYTES];
    double message_s;                      // left to show
    int64_t refusals_said, fallbacks_said; // of MethodChanges
} FlightSession;

// The aircraft at the scene's start, or where the terrain looks best; the demo when asked for. Errors of the demo.
MUST_USE Result session_create(const World *world, const Options *options, FlightSession *out);
// Frees what the demo holds; the session's memory is the caller's.
void session_end(FlightSession *session);

// Heights of the terrain; `world` is borrowed.
FlightGround session_ground(const World *world);

// Shows a recorded flight from now on: --at, --time-rate, --backwards. USAGE, logged: no such time.
MUST_USE Result session_begin_replay(FlightSession *session, Playback *playback, const Options *options);
// Flies on from the moment shown.
void session_end_replay(FlightSession *session);

// Keys as the window reports them.
void session_on_key(FlightSession *session, int key, bool pressed, unsigned modifiers);
// A key that is still down.
void session_on_repeat(FlightSession *session, int key, unsigned modifiers);
// The mouse moved, or its left button: where in a picture of that size, in pixels from the top left corner. Drags the
// time of a replay along its bar.
void session_on_pointer(FlightSession *session, double x, double y, bool down, int width, int height);
// Carries out key presses, then flies `passed_s` seconds on in fixed steps.
void session_advance(FlightSession *session, double passed_s);
void session_say(FlightSession *session, const char *message);
// Who flies now goes on from these controls: levers where they were, the stick in the middle and the elevator where its
// trim holds it; the rest fades.
void session_hand_over(FlightSession *session, const Controls *before);
// What a replay does with a key and with time; for session_on_key and session_advance.
bool session_replay_key(FlightSession *session, int key, unsigned modifiers); // false: not one of its own
bool session_replay_act(FlightSession *session, Action action);               // false: as in any flight
void session_replay_advance(FlightSession *session, double passed_s);
// Says when a method could not come, and which one is shown instead; and when the GPU could not work for it.
void session_hear_changes(FlightSession *session, const MethodChanges *changes, LodMethod shown);

// Tells the governor, if there is one, what the frames cost that were drawn since, and sets the tolerance. A target
// that is out of reach is warned of.
void session_govern(FlightSession *session, const PipelineStats *stats);

// What to draw now, in a framebuffer of that size. `frame_ms` and `frame_p99_ms` are for the HUD.
void session_order(const FlightSession *session, int width, int height, double frame_ms, double frame_p99_ms,
                   FrameOrder *order);
// Turns a second of a propeller; 0 where there is none.
double session_propeller_rps(const FlightSession *session);
// Height above the geoid of the aircraft, for people.
double session_altitude_m(const FlightSession *session, const FlightInstruments *now);
