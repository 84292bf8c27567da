// app/flight/flight_session.h: a flight as it is flown: aircraft, pilot or demo, settings; from passed time to the
// order of the next frame. Knows no window and no thread. Seconds, metres, radians. A FlightSession borrows its World
// and points into itself: it is not copied. One thread.
#pragma once
#include "app/flight/demo.h"
#include "app/flight/flight_model.h"
#include "app/flight/flight_settings.h"
#include "app/flight/governor.h"
#include "app/pipeline/pipeline.h"
#include "app/scene_load.h"
#include "input/keyboard.h"

#define SESSION_MESSAGE_S 3.0

typedef struct FlightSession {
    const World *world;
    FlightSettings settings;
    Governor governor;     // where settings.target_ms is above 0
    int64_t frames_judged; // that the governor was told of
    Aircraft aircraft;
    Flight flight; // borrows the aircraft: the session stays where it is
    bool assist;   // of the keys
    Autopilot help;
    Keyboard keyboard;
    Demo demo;
    bool demo_flies;
    int crashes;
    bool screenshot_wanted, leave_wanted; // by a key; the caller takes them back
    Vec3d sun_ecef;                       // unit
    char message[PIPELINE_MESSAGE_BYTES];
    double message_s;                      // left to show
    int64_t refusals_said, fallbacks_said; // of MethodChanges
} FlightSession;

// The aircraft at the scene's start, or where the terrain looks best; the demo when asked for. Errors of the demo.
MUST_USE Result session_create(const World *world, const Options *options, FlightSession *out);

// Keys as the window reports them.
void session_on_key(FlightSession *session, int key, bool pressed, bool shift);
// Carries out key presses, then flies `passed_s` seconds on in fixed steps.
void session_advance(FlightSession *session, double passed_s);
void session_say(FlightSession *session, const char *message);
// Says when a method could not come, and which one is shown instead; and when the GPU could not work for it.
void session_hear_changes(FlightSession *session, const MethodChanges *changes, LodMethod shown);

// Tells the governor, if there is one, what the frames cost that were drawn since, and sets the tolerance.
void session_govern(FlightSession *session, const PipelineStats *stats);

// What to draw now, in a framebuffer of that size. `frame_ms` and `frame_p99_ms` are for the HUD.
void session_order(const FlightSession *session, int width, int height, double frame_ms, double frame_p99_ms,
                   FrameOrder *order);
// Height above the geoid of the aircraft, for people.
double session_altitude_m(const FlightSession *session, const FlightInstruments *now);
