// input/controls.h: what a pilot's hands and feet do.
// Shares of full deflection, -1..1 where nothing else is said.
// A value.
#pragma once
#include "base/base.h"

typedef struct Controls {
    double elevator;                // + nose up (stick back)
    double aileron;                 // + right wing down (stick right)
    double rudder;                  // + nose right
    double throttle;                // 0 idle .. 1 full
    double trim;                    // of the elevator, added to it; + nose up
    double flaps;                   // 0 up .. 1 full
    double brake_left, brake_right; // 0..1
    bool gear_up;                   // where the gear retracts: it is wanted up
} Controls;
