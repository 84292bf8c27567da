// tests/recording_support.h: a simulation and a pilot for tests of recordings, made up but like the real ones.
// Steps of 1/120 s.
// Values; files are the test's.
#pragma once
#include "app/recording/recording_player.h"
#include "app/recording/recording_writer.h"

#define TOY_WORDS 64 // 512 bytes, more than a flight model's state

// Numbers that move as an aircraft's do, and a random generator; the last word counts steps.
typedef struct Toy {
    union {
        double number[TOY_WORDS];
        uint64_t word[TOY_WORDS];
    };
} Toy;
Toy toy_create(uint64_t seed);
void toy_step(Toy *toy, const Controls *controls);
uint64_t toy_hash(const Toy *toy);
#define TOY_EVENT_WIND ((RecordingEventKind)200) // sets a number
RecordingSim toy_sim(Toy *toy);
RecordingHeader toy_header(void);

// Hands on a joystick whose four axes are sensors of 12 bits with noise, read at every step, with dead zones and
// curves; trim, flaps and brakes now and then.
typedef struct Pilot {
    uint64_t random;
    double wanted[4], begun[4], hand[4]; // elevator, aileron, rudder, throttle
    double noise;                        // of the sensor, in its steps, RMS
    int bits;                            // of the sensor
    double flaps, trim, brake;
    int trimming; // -1, 0, 1
} Pilot;
Pilot pilot_create(uint64_t seed, int bits, double noise);
Controls pilot_move(Pilot *pilot);

uint64_t support_random(uint64_t *state);

// So many steps, much faster than time; _and_wait: that the disk keeps up with.
void support_fly(RecordingWriter *writer, Toy *toy, Pilot *pilot, uint32_t steps);
void support_fly_and_wait(RecordingWriter *writer, Toy *toy, Pilot *pilot, uint32_t steps);
// Recorded into a file that must come out whole.
void support_record(const char *path, uint64_t seed, uint32_t steps);
// Names a file of the test's own.
void support_path(const char *name, char out[128]);
// The file's bytes; the caller's.
uint8_t *support_load(const char *path, size_t *count);
void support_store(const char *path, const uint8_t *bytes, size_t count);
