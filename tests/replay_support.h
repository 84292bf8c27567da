// tests/replay_support.h: flights of the real flight model over real terrain, recorded, and how each step left them.
// Steps of FLIGHT_STEP_S; states as flight_state_pack has them.
// The test owns what it made, and frees it; one thread.
#pragma once
#include "app/flight/flight_recorder.h"
#include "app/flight/flight_session.h"
#include "app/replay/playback.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define REPLAY_SLOWNESS 12 // so many times shorter flights, where each step takes so much longer
#else
#define REPLAY_SLOWNESS 1
#endif

typedef struct ReplayWorld {
    Options *options; // of `overfly fly`
    World world;
} ReplayWorld;
// The default scene, loaded by so many workers.
void replay_world_load(int workers, ReplayWorld *out);
void replay_world_unload(ReplayWorld *world);

// Hands that wander, on a stick whose sensors have 12 bits and noise, while an autopilot leads the aircraft from place
// to place of the default scene, low enough to hit hills now and then.
typedef struct Hands {
    uint64_t random;
    double wanted[4], hand[4]; // elevator, aileron, rudder, throttle
    Autopilot autopilot;
    AutopilotWish wish;
    int64_t steps;
} Hands;
Hands hands_create(uint64_t seed);
Controls hands_move(Hands *hands, const Flight *flight);
double hands_share(uint64_t *random); // 0..1

typedef uint8_t PackedState[FLIGHT_STATE_BYTES];

// What happened in a recorded flight. The state p is that before step p; the last one that after the last step.
typedef struct Flown {
    char path[128];
    uint32_t steps;
    PackedState *states; // steps + 1
    ControlsCode *codes;
    uint64_t *hashes; // of the state after each step
    uint64_t hash;    // running, at the end
    uint32_t reset;   // the step before which the aircraft was set back to its begin; 0: it was not
    uint32_t crash;   // the first step that ended in a crash, `anew` the one that started anew; 0: none
    uint32_t anew;
    FlightState begin; // of the flight
} Flown;

// The aircraft's flight from the scene's start. `aircraft` is borrowed.
Flight replay_start(const ReplayWorld *world, const Aircraft *aircraft);
// A name of the test's own, in the folder for temporary files.
void replay_path(const char *name, char out[128]);
// A flight of `steps`: hands; a dive into the ground from step `dive` on until it starts anew; a reset before step
// `reset`. 0: no dive, no reset.
void replay_fly(ReplayWorld *world, const char *name, uint32_t steps, uint32_t dive, uint32_t reset, Flown *out);
void flown_remove(Flown *flown);

RecordedFlight replay_recorded(const Flight *flight);
// Opens a recording over the world.
Playback *replay_open(const ReplayWorld *world, const char *path);
RecordingVerdict replay_verdict(const ReplayWorld *world, const char *path);
// Whether a state is what was flown before the step `p`, to the bit; the counter of steps is left out where not
// `whole`.
bool flown_is(const Flown *flown, uint32_t p, const FlightState *state, bool whole);
FlightState flown_state(const Flown *flown, uint32_t p);
