#include "input/calibration.h"

#include <math.h>

static bool is_told(const PadState *state, int axis) {
    return !(state->axes_unknown >> axis & 1) && isfinite(state->axes[axis]);
}

PadCalibration calibration_begin(const PadState *at_rest) {
    PadCalibration calibration = {.axes = {{.known = false}}};
    for (int i = 0; i < PAD_AXES_MAX; i++)
        if (is_told(at_rest, i))
            calibration.axes[i] = (AxisCalibration){true, at_rest->axes[i], at_rest->axes[i], at_rest->axes[i]};
    return calibration;
}

void calibration_learn(PadCalibration *calibration, const PadState *state) {
    for (int i = 0; i < PAD_AXES_MAX; i++) {
        AxisCalibration *axis = &calibration->axes[i];
        double value = state->axes[i];
        if (!is_told(state, i))
            continue;
        if (!axis->known)
            *axis = (AxisCalibration){true, value, value, value};
        axis->min = fmin(axis->min, value);
        axis->max = fmax(axis->max, value);
    }
}

void calibration_finish(PadCalibration *calibration) {
    for (int i = 0; i < PAD_AXES_MAX; i++) {
        AxisCalibration *axis = &calibration->axes[i];
        axis->known = axis->known && axis->max - axis->min >= CALIBRATION_SPAN_LEAST;
    }
}

static double clamp_unit(double value) {
    return fmin(fmax(value, -1.0), 1.0);
}

static double share(double value, double from, double to) {
    return to > from ? fmin(fmax((value - from) / (to - from), 0.0), 1.0) : 0.0;
}

double calibration_apply(const AxisCalibration *calibration, double value, bool has_centre) {
    if (!calibration->known)
        return clamp_unit(value);
    if (!has_centre)
        return 2.0 * share(value, calibration->min, calibration->max) - 1.0;
    return share(value, calibration->centre, calibration->max) - share(-value, -calibration->centre, -calibration->min);
}
