#define _POSIX_C_SOURCE 200809L
#include "tests/replay_support.h"

#include "terrain/geodesy.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

// The middle of the default scene, and how far places lie from it.
#define MIDDLE_LAT_DEG 36.59
#define MIDDLE_LON_DEG (-84.245)
#define SPREAD_DEG 0.09

void replay_world_load(int workers, ReplayWorld *out) {
    char text[16];
    snprintf(text, sizeof text, "%d", workers);
    *out = (ReplayWorld){0};
    assert_int_equal(options_create(COMMAND_FLY, &out->options), RESULT_OK);
    assert_int_equal(options_set(out->options, OPTION_THREADS, text, SOURCE_COMMAND_LINE, "--threads"), RESULT_OK);
    assert_int_equal(world_load(out->options, &out->world), RESULT_OK);
}

void replay_world_unload(ReplayWorld *world) {
    world_unload(&world->world);
    options_destroy(&world->options);
}

// ---- hands ----

// SplitMix64: G. Steele, D. Lea, C. Flood, OOPSLA 2014, figure 17.
static uint64_t next_random(uint64_t *random) {
    uint64_t z = (*random += UINT64_C(0x9E3779B97F4A7C15));
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

double hands_share(uint64_t *random) {
    return (double)(next_random(random) >> 11) * 0x1p-53;
}

static double normal(uint64_t *random) { // of 12 uniform ones: near enough
    double sum = -6.0;
    for (int i = 0; i < 12; i++)
        sum += hands_share(random);
    return sum;
}

Hands hands_create(uint64_t seed) {
    return (Hands){.random = seed};
}

// As app/recording's own figures were measured: 12 bits, noise of 0.8 of a sensor's steps.
static double sense(Hands *hands, int axis, double seconds, double deviation) {
    double keep = FLIGHT_STEP_S / seconds, follow = FLIGHT_STEP_S / 0.1;
    hands->wanted[axis] += -hands->wanted[axis] * keep + deviation * sqrt(2.0 * keep) * normal(&hands->random);
    hands->hand[axis] += (hands->wanted[axis] - hands->hand[axis]) * follow;
    return floor(hands->hand[axis] * 2048.0 + 0.8 * normal(&hands->random) + 0.5) / 2048.0;
}

static void choose_place(Hands *hands, const Flight *flight) {
    FlightInstruments now = flight_instruments(flight);
    const Waypoint to = {
        .lat_rad = (MIDDLE_LAT_DEG + SPREAD_DEG * (2.0 * hands_share(&hands->random) - 1.0)) * GEODESY_RAD_PER_DEG,
        .lon_rad = (MIDDLE_LON_DEG + SPREAD_DEG * (2.0 * hands_share(&hands->random) - 1.0)) * GEODESY_RAD_PER_DEG};
    double distance_m;
    autopilot_course(now.lat_rad, now.lon_rad, &to, &distance_m, &hands->wish.heading_rad);
    hands->wish.height_m = 450.0 + 900.0 * hands_share(&hands->random);
    hands->wish.speed_m_s = 90.0 + 50.0 * hands_share(&hands->random);
}

Controls hands_move(Hands *hands, const Flight *flight) {
    if (hands->steps++ % (30 * 120) == 0)
        choose_place(hands, flight);
    Controls controls = autopilot_hold(&hands->autopilot, flight, &hands->wish, FLIGHT_STEP_S);
    controls.elevator += sense(hands, 0, 1.5, 0.05);
    controls.aileron += sense(hands, 1, 1.5, 0.1);
    controls.rudder += sense(hands, 2, 2.0, 0.05);
    controls.throttle += sense(hands, 3, 30.0, 0.1);
    uint64_t dice = next_random(&hands->random) % 6000;
    controls.flaps = dice < 3 ? (double)dice / 3.0 : flight->controls.flaps;
    controls.gear_up = true;
    return controls;
}

// ---- flights ----

void replay_path(const char *name, char out[128]) {
    const char *folder = getenv("TMPDIR");
    snprintf(out, 128, "%.60s/overfly-replay-%ld-%s.ofr", folder ? folder : "/tmp", (long)getpid(), name);
}

Flight replay_start(const ReplayWorld *world, const Aircraft *aircraft) {
    const FlightStart start = {.lat_rad = MIDDLE_LAT_DEG * GEODESY_RAD_PER_DEG,
                               .lon_rad = MIDDLE_LON_DEG * GEODESY_RAD_PER_DEG,
                               .h_m = 900.0,
                               .heading_rad = 1.0,
                               .speed_m_s = aircraft->cruise_speed};
    return flight_create(aircraft, &start, session_ground(&world->world));
}

RecordedFlight replay_recorded(const Flight *flight) {
    return (RecordedFlight){flight, AIRCRAFT_DEFAULT};
}

static void note(Flown *out, uint32_t step, const FlightState *before, const Flight *flight) {
    const FlightState *after = &flight->state;
    flight_state_pack(after, out->states[step + 1]);
    out->hashes[step] = flight_state_hash(after);
    if (out->crash == 0 && after->contact == FLIGHT_CRASHED)
        out->crash = step;
    if (out->anew == 0 && before->contact == FLIGHT_CRASHED && after->contact != FLIGHT_CRASHED)
        out->anew = step;
}

static void fly(FlightRecorder *recorder, Flight *flight, uint32_t dive, Flown *out) {
    Hands hands = hands_create(11);
    for (uint32_t step = 0; step < out->steps; step++) {
        if (step > 0 && step == out->reset) {
            flight->state = out->begin;
            flight->state.step = step; // which goes on, as it does in a session
            recorder_restart(recorder, RECORDING_EVENT_RESET, flight);
            flight_state_pack(&flight->state, out->states[step]);
        }
        FlightState before = flight->state;
        Controls controls = hands_move(&hands, flight);
        if (dive > 0 && step >= dive && out->anew == 0)
            controls = (Controls){.elevator = -0.2, .throttle = 1.0, .gear_up = true};
        out->codes[step] = recording_quantise(&controls);
        recorder_fly(recorder, flight, &controls);
        note(out, step, &before, flight);
    }
}

void replay_fly(ReplayWorld *world, const char *name, uint32_t steps, uint32_t dive, uint32_t reset, Flown *out) {
    Aircraft aircraft;
    FlightRecorder *recorder;
    *out = (Flown){.steps = steps, .reset = reset};
    replay_path(name, out->path);
    out->states = malloc((steps + 1) * sizeof *out->states);
    out->codes = malloc(steps * sizeof *out->codes);
    out->hashes = malloc(steps * sizeof *out->hashes);
    assert_true(out->states && out->codes && out->hashes);
    assert_int_equal(aircraft_load(AIRCRAFT_DEFAULT, &aircraft), RESULT_OK);
    Flight flight = replay_start(world, &aircraft);
    const RecordedFlight recorded = replay_recorded(&flight);
    out->begin = flight.state;
    flight_state_pack(&flight.state, out->states[0]);
    assert_int_equal(options_set(world->options, OPTION_RECORD, out->path, SOURCE_COMMAND_LINE, "--record"), RESULT_OK);
    assert_int_equal(recorder_create(&world->world, world->options, &recorded, &recorder), RESULT_OK);
    fly(recorder, &flight, dive, out);
    out->hash = recorder_hash(recorder);
    assert_int_equal(recorder_close(&recorder), RESULT_OK);
}

void flown_remove(Flown *flown) {
    unlink(flown->path);
    free(flown->states);
    free(flown->codes);
    free(flown->hashes);
}

Playback *replay_open(const ReplayWorld *world, const char *path) {
    PlaybackOptions options = {.how = track_reading_default(),
                               .ground = session_ground(&world->world),
                               .dem_hash = dem_hash(terrain_dem(world->world.terrain))};
    Playback *playback = NULL;
    options.how.geoid = world->world.geoid;
    assert_int_equal(playback_open(path, &options, &playback), RESULT_OK);
    return playback;
}

RecordingVerdict replay_verdict(const ReplayWorld *world, const char *path) {
    RecordingVerdict verdict;
    Playback *playback = replay_open(world, path);
    assert_int_equal(playback_verify(playback, &verdict), RESULT_OK);
    playback_close(&playback);
    return verdict;
}

FlightState flown_state(const Flown *flown, uint32_t p) {
    FlightState state;
    assert_int_equal(flight_state_unpack(flown->states[p], &state), RESULT_OK);
    return state;
}

bool flown_is(const Flown *flown, uint32_t p, const FlightState *state, bool whole) {
    FlightState compared = *state;
    PackedState packed;
    if (!whole)
        compared.step = flown_state(flown, p).step;
    flight_state_pack(&compared, packed);
    return memcmp(packed, flown->states[p], sizeof packed) == 0;
}
