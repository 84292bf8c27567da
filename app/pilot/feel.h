// app/pilot/feel.h: what hands feel of a flight: a stall shakes the stick, wheels that touch knock. For pads' motors.
// Shares 0..1 of the motors' strength; metres a second; seconds.
// Values only; knows no device. Deterministic.
#pragma once
#include "app/dynamics/flight_model.h"

#define FEEL_STALLED 0.25     // share of the flow that has separated, from which a stall is felt
#define FEEL_SHAKE_LEAST 0.3  // of the slow motor, there; 1 where all of it has
#define FEEL_KNOCK_LEAST 0.25 // of both motors, of the softest touch; 1 at the fastest sink that the gear bears
#define FEEL_KNOCK_S 0.25

typedef struct FeelRumble {
    double low, high; // of the slow and the fast motor
    double seconds;   // 0: nothing new
} FeelRumble;

// What was felt last.
typedef struct Feel {
    double shake, shake_s; // of the slow motor, which goes on by itself for so long
    double knock, knock_s; // a knock hides the shaking and softer knocks, for so long
} Feel;

// After a step, which took the pilot `dt_s`, from `before` to the flight's state: what pads are to be told now, if
// anything. Shaking is told when it changes and, while it lasts, anew before it ends by itself.
FeelRumble feel_step(Feel *feel, const FlightState *before, const Flight *flight, double dt_s);
