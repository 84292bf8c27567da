#include "app/devices/calibrator.h"

#include <math.h>
#include <string.h>

void calibrator_init(Calibrator *calibrator) {
    memset(calibrator, 0, sizeof *calibrator);
}

static bool is_told(const PadState *state, int axis) {
    return !(state->axes_unknown >> axis & 1);
}

static void come(CalibratorPad *pad, const PadInfo *info) {
    *pad = (CalibratorPad){.there = true, .info = *info, .state = pad_at_rest()};
    pad->calibration = calibration_begin(&pad->state);
}

// Whether a hand did it.
static bool look(CalibratorPad *pad, const PadState *now) {
    bool moved = false;
    for (int i = 0; i < pad->info.axis_count; i++) {
        if (!is_told(now, i) || (is_told(&pad->state, i) && fabs(now->axes[i] - pad->looked[i]) <= CALIBRATOR_MOVED))
            continue;
        moved = moved || is_told(&pad->state, i);
        pad->looked[i] = now->axes[i];
    }
    pad->state = *now;
    return moved;
}

void calibrator_take(Calibrator *calibrator, const DeviceEvent *event) {
    CalibratorPad *pad = &calibrator->pads[event->slot];
    if (event->kind == DEVICE_ARRIVED)
        come(pad, &event->info);
    else if (event->kind == DEVICE_LEFT)
        pad->there = false;
    if (event->kind != DEVICE_REPORT || !pad->there)
        return;
    if (look(pad, &event->state))
        calibrator->still_s = 0.0;
    if (calibrator->phase == CALIBRATOR_MOVING)
        calibration_learn(&pad->calibration, &event->state);
}

void calibrator_advance(Calibrator *calibrator, double dt_s) {
    calibrator->still_s += dt_s;
    if (calibrator->phase == CALIBRATOR_RESTING && calibrator->still_s >= CALIBRATOR_STILL_S)
        calibrator_next(calibrator);
}

void calibrator_next(Calibrator *calibrator) {
    for (int i = 0; i < DEVICES_MAX; i++) {
        CalibratorPad *pad = &calibrator->pads[i];
        if (pad->there && calibrator->phase == CALIBRATOR_RESTING)
            pad->calibration = calibration_begin(&pad->state);
        else if (pad->there && calibrator->phase == CALIBRATOR_MOVING)
            calibration_finish(&pad->calibration);
    }
    if (calibrator->phase != CALIBRATOR_DONE)
        calibrator->phase = (CalibratorPhase)(calibrator->phase + 1);
}

int calibrator_pads(const Calibrator *calibrator) {
    int count = 0;
    for (int i = 0; i < DEVICES_MAX; i++)
        count += calibrator->pads[i].there;
    return count;
}

int calibrator_learned(const CalibratorPad *pad) {
    int count = 0;
    for (int i = 0; i < pad->info.axis_count; i++) {
        const AxisCalibration *axis = &pad->calibration.axes[i];
        count += axis->known && axis->max - axis->min >= CALIBRATION_SPAN_LEAST;
    }
    return count;
}

PadCalibration calibrator_merge(const CalibratorPad *pad, const PadCalibration *kept) {
    PadCalibration merged = *kept;
    for (int i = 0; i < pad->info.axis_count; i++)
        if (pad->calibration.axes[i].known)
            merged.axes[i] = pad->calibration.axes[i];
    return merged;
}
