// app/pilot/hand_over.h: from the controls of who flew before to those of who flies now, without a jump.
// Shares of full deflection; seconds.
// A value; deterministic.
#pragma once
#include "input/controls.h"

#define HAND_OVER_S 0.5         // from where the surfaces were to where who flies now has them
#define HAND_OVER_THROTTLE 0.02 // so much more than before releases the brakes

typedef struct HandOver {
    Controls before; // flown last by the other
    bool begins;     // the next controls tell what is to fade
    double left_s;   // of the fading
    double elevator, aileron, rudder;
    bool brakes; // are still those of before
} HandOver;

HandOver hand_over_begin(const Controls *before);
// Before each step of who flies now. Elevator (with its trim), aileron and rudder: what they differed by at first fades
// evenly within HAND_OVER_S. Brakes: as before, until who flies now brakes, or moves the throttle up. The other
// controls stay where they are left, and are the caller's to hand over.
void hand_over_ease(HandOver *hand_over, Controls *controls, double dt_s);
