// input/calibration.h: where an axis of one pad really rests and ends.
// Axis values -1..1 over their logical range.
// Values; pure functions.
#pragma once
#include "input/pad.h"

#define CALIBRATION_SPAN_LEAST 0.2 // less travel than this was no full movement

typedef struct AxisCalibration {
    bool known;
    double centre, min, max; // min <= centre <= max
} AxisCalibration;

typedef struct PadCalibration {
    AxisCalibration axes[PAD_AXES_MAX];
} PadCalibration;

// Learning: begin with the pad left alone, which gives the centres; then show it every state while all axes are moved
// to their ends; then finish, which forgets axes that moved less than CALIBRATION_SPAN_LEAST. Many devices say nothing
// while they rest: an axis that is told for the first time while learning has its centre there.
PadCalibration calibration_begin(const PadState *at_rest);
void calibration_learn(PadCalibration *calibration, const PadState *state);
void calibration_finish(PadCalibration *calibration);

// -1..1: min gives -1, max 1, and the centre 0 where `has_centre`; linear between. A side that has no travel stays at
// 0. Unknown: `value` itself, clamped.
double calibration_apply(const AxisCalibration *calibration, double value, bool has_centre);
