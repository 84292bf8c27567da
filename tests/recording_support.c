#define _POSIX_C_SOURCE 200809L
#include "tests/recording_support.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define DT_S (1.0 / RECORDING_STEPS_PER_S)
#define WIND_WORD 60
#define RANDOM_WORD 62
#define STEP_WORD 63

uint64_t support_random(uint64_t *state) {
    *state += UINT64_C(0x9E3779B97F4A7C15);
    return recording_hash_next(*state, 0);
}

static double share(uint64_t *random) { // 0..1
    return (double)(support_random(random) >> 11) * 0x1p-53;
}

static double normal(uint64_t *random) { // of 12 uniform ones: near enough
    double sum = -6.0;
    for (int i = 0; i < 12; i++)
        sum += share(random);
    return sum;
}

// ---- the simulation ----

Toy toy_create(uint64_t seed) {
    Toy toy = {.number = {0}};
    for (int i = 0; i < WIND_WORD; i++)
        toy.number[i] = 6.4e6 * share(&seed);
    toy.word[RANDOM_WORD] = seed;
    return toy;
}

void toy_step(Toy *toy, const Controls *controls) {
    double push = controls->elevator + 2.0 * controls->aileron + 3.0 * controls->rudder + 5.0 * controls->throttle +
                  controls->trim + 0.5 * controls->flaps + controls->brake_left - controls->brake_right +
                  (controls->gear_up ? 0.25 : 0.0);
    double gust = share(&toy->word[RANDOM_WORD]) + toy->number[WIND_WORD];
    for (int i = 0; i + 1 < WIND_WORD; i++)
        toy->number[i] += DT_S * (push + gust + 1e-6 * toy->number[i + 1] - 1e-3 * toy->number[i]);
    toy->word[STEP_WORD]++;
}

uint64_t toy_hash(const Toy *toy) {
    uint64_t hash = 0;
    for (int i = 0; i < TOY_WORDS; i++)
        hash = hash * UINT64_C(0x100000001B3) ^ toy->word[i];
    return hash;
}

static bool load_toy(void *user, const void *state) {
    memcpy(user, state, sizeof(Toy));
    return isfinite(((Toy *)user)->number[0]);
}

static void save_toy(void *user, void *state) {
    memcpy(state, user, sizeof(Toy));
}

static void step_toy(void *user, const Controls *controls) {
    toy_step(user, controls);
}

static uint64_t hash_toy(void *user) {
    return toy_hash(user);
}

static void hear_event(void *user, const RecordingEvent *event) {
    Toy *toy = user;
    if (event->kind == TOY_EVENT_WIND && event->bytes == sizeof(double))
        memcpy(&toy->number[WIND_WORD], event->data, sizeof(double));
}

RecordingSim toy_sim(Toy *toy) {
    return (RecordingSim){.user = toy,
                          .state_bytes = sizeof(Toy),
                          .state_layout = 7,
                          .load = load_toy,
                          .save = save_toy,
                          .step = step_toy,
                          .hash = hash_toy,
                          .event = hear_event};
}

RecordingHeader toy_header(void) {
    RecordingHeader header = recording_header_create(sizeof(Toy), 7);
    recording_header_set(&header, RECORDING_PROGRAM, "toy %d", 1);
    recording_header_set(&header, RECORDING_SCENE, "meadow");
    return header;
}

// ---- the pilot ----

Pilot pilot_create(uint64_t seed, int bits, double noise) {
    return (Pilot){.random = seed, .noise = noise, .bits = bits};
}

// What a sensor tells of -1..1, as a driver scales it, with a dead zone that goes over into a curve.
static double sense(Pilot *pilot, double hand, double dead, double power) {
    double top = (double)((1 << pilot->bits) - 1);
    double raw = floor((hand + 1.0) * 0.5 * top + pilot->noise * normal(&pilot->random) + 0.5);
    double value = fmin(fmax(raw, 0.0), top) / top * 2.0 - 1.0;
    double size = fmax(fabs(value) - dead, 0.0) / (1.0 - dead);
    return copysign(pow(size, power), value);
}

// What is wanted wanders about the centre; the hand follows with two lags, a pilot's own and that of nerves and muscles
// (a tenth of a second each: D. McRuer, H. Jex, "A Review of Quasi-Linear Pilot Models", 1967).
static void move_hand(Pilot *pilot, int axis, double seconds, double deviation) {
    double keep = DT_S / seconds, follow = DT_S / 0.1;
    double *wanted = &pilot->wanted[axis], *begun = &pilot->begun[axis], *hand = &pilot->hand[axis];
    *wanted += -*wanted * keep + deviation * sqrt(2.0 * keep) * normal(&pilot->random);
    *begun += (*wanted - *begun) * follow;
    *hand += (*begun - *hand) * follow;
}

Controls pilot_move(Pilot *pilot) {
    move_hand(pilot, 0, 1.5, 0.15);
    move_hand(pilot, 1, 1.5, 0.2);
    move_hand(pilot, 2, 2.0, 0.1);
    move_hand(pilot, 3, 30.0, 0.4);
    uint64_t dice = support_random(&pilot->random) % 12000; // one of them comes in 100 s
    pilot->flaps = dice == 0 ? (double)(support_random(&pilot->random) % 4) / 3.0 : pilot->flaps;
    pilot->brake = dice == 1 ? share(&pilot->random) : dice == 2 ? 0.0 : pilot->brake;
    pilot->trimming = dice >= 10 && dice < 20 ? 1 : dice >= 20 && dice < 30 ? -1 : dice < 200 ? 0 : pilot->trimming;
    pilot->trim = fmin(fmax(pilot->trim + 0.2 * DT_S * pilot->trimming, -1.0), 1.0);
    return (Controls){.elevator = sense(pilot, pilot->hand[0], 0.02, 1.5),
                      .aileron = sense(pilot, pilot->hand[1], 0.02, 1.5),
                      .rudder = sense(pilot, pilot->hand[2], 0.03, 1.2),
                      .throttle = 0.5 + 0.5 * sense(pilot, pilot->hand[3], 0.0, 1.0),
                      .trim = pilot->trim,
                      .flaps = pilot->flaps,
                      .brake_left = pilot->brake,
                      .brake_right = pilot->brake,
                      .gear_up = pilot->hand[3] > 0.0};
}

// ---- flights and files ----

void support_fly(RecordingWriter *writer, Toy *toy, Pilot *pilot, uint32_t steps) {
    for (uint32_t i = 0; i < steps; i++) {
        Controls moved = pilot_move(pilot);
        ControlsCode code = recording_quantise(&moved);
        Controls controls = recording_controls(code);
        toy_step(toy, &controls);
        recording_writer_step(writer, code, toy_hash(toy), toy);
    }
}

void support_fly_and_wait(RecordingWriter *writer, Toy *toy, Pilot *pilot, uint32_t steps) {
    while (steps > 0) {
        uint32_t some = steps < RECORDING_KEPT_STEPS ? steps : RECORDING_KEPT_STEPS;
        support_fly(writer, toy, pilot, some);
        recording_writer_wait(writer);
        steps -= some;
    }
}

void support_record(const char *path, uint64_t seed, uint32_t steps) {
    RecordingHeader header = toy_header();
    Toy toy = toy_create(seed);
    Pilot pilot = pilot_create(seed, 12, 0.8);
    RecordingWriter *writer;
    assert_int_equal(recording_writer_create(&header, path, &toy, &writer), RESULT_OK);
    support_fly_and_wait(writer, &toy, &pilot, steps);
    assert_int_equal(recording_writer_close(&writer), RESULT_OK);
}

void support_path(const char *name, char out[128]) {
    snprintf(out, 128, "test_recording_%s_%ld.ofr", name, (long)getpid());
}

uint8_t *support_load(const char *path, size_t *count) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *count = (size_t)ftell(file);
    rewind(file);
    uint8_t *bytes = malloc(*count + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *count, file), *count);
    fclose(file);
    return bytes;
}

void support_store(const char *path, const uint8_t *bytes, size_t count) {
    unlink(path); // a file that is written over would go to the disk at once
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, count, file), count);
    fclose(file);
}
