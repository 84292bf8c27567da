// app/pilot/pilot.h: the pilot's hands on keyboard, sticks and gamepads, whichever are plugged in, step by step.
// Shares of full deflection; seconds; nanoseconds as base/clock.h counts.
// A Pilot owns its devices' threads; the keyboard is the caller's. One thread.
#pragma once
#include "base/base.h"
#include "input/devices/devices.h"
#include "input/mapper.h"

#define PILOT_MESSAGE_BYTES 192
#define PILOT_EVERYTHING INT64_MAX // for pilot_hear: whatever has come

typedef struct Pilot Pilot;

// Begins to look for devices. Where that fails it is said (a warning), and the keyboard flies alone. MEMORY.
MUST_USE Result pilot_create(Pilot **out);
void pilot_destroy(Pilot **pilot);

// Takes what has come from the devices since; never waits for one. Once a frame.
void pilot_poll(Pilot *pilot);
// Lets what was reported before `until_ns` act from the next sample on. `message`: what a person should know, as a pad
// that came or went; "" else.
void pilot_hear(Pilot *pilot, Keyboard *keyboard, int64_t until_ns, char message[PILOT_MESSAGE_BYTES]);
// As mapper_sample: the keyboard's controls moved on, and what pads drive.
Controls pilot_sample(Pilot *pilot, Keyboard *keyboard, double dt_s);
// As mapper_keep.
void pilot_keep(Pilot *pilot, Keyboard *keyboard);
// Whether an axis of a pad is the stick now: aileron or elevator.
bool pilot_drives_stick(const Pilot *pilot);
// Whether an axis or a button was moved since the last call.
bool pilot_was_touched(Pilot *pilot);
// The view that pads ask for: right and up, -1..1.
void pilot_look(const Pilot *pilot, double *right, double *up);
// All pads that can: strengths 0..1 of the slow and the fast motor.
void pilot_rumble(Pilot *pilot, double low, double high, double seconds);
