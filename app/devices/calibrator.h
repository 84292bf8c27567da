// app/devices/calibrator.h: how sticks are calibrated: first all is left alone, then all is moved to its ends.
// Axes -1..1; seconds.
// A Calibrator is a value without pointers; it knows no clock, no device and no file. One thread.
#pragma once
#include "input/calibration.h"
#include "input/devices/device_event.h"

#define CALIBRATOR_STILL_S 2.0 // without a movement, and what is told is where things rest
#define CALIBRATOR_MOVED 0.04  // of an axis: less is noise

typedef enum CalibratorPhase { CALIBRATOR_RESTING, CALIBRATOR_MOVING, CALIBRATOR_DONE } CalibratorPhase;

typedef struct CalibratorPad {
    bool there;
    PadInfo info;
    PadState state;              // as told last
    double looked[PAD_AXES_MAX]; // where it lay before it moved
    PadCalibration calibration;  // of MOVING and DONE
} CalibratorPad;

typedef struct Calibrator {
    CalibratorPhase phase;
    double still_s; // since the last movement
    CalibratorPad pads[DEVICES_MAX];
} Calibrator;

void calibrator_init(Calibrator *calibrator);
// A pad that comes later takes part from then on, and rests where it is told first; one that leaves takes what was
// learned of it along.
void calibrator_take(Calibrator *calibrator, const DeviceEvent *event);
// From RESTING to MOVING, once nothing has moved for CALIBRATOR_STILL_S.
void calibrator_advance(Calibrator *calibrator, double dt_s);
// From RESTING to MOVING: what is told now is where things rest. From MOVING to DONE: axes that did not move are
// forgotten.
void calibrator_next(Calibrator *calibrator);
int calibrator_pads(const Calibrator *calibrator); // that are there
// Axes that have moved as far as a calibration needs.
int calibrator_learned(const CalibratorPad *pad);
// `kept`, with what was learned in place of it.
PadCalibration calibrator_merge(const CalibratorPad *pad, const PadCalibration *kept);
