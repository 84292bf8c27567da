// input/controls.h: what a pilot's hands and feet do.
// Shares of full deflection, -1..1; the throttle 0..1.
// A value.
#pragma once

typedef struct Controls {
    double elevator; // + nose up (stick back)
    double aileron;  // + right wing down (stick right)
    double rudder;   // + nose right
    double throttle; // 0 idle .. 1 full
} Controls;
