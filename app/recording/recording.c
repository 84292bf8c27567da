#include "app/recording/recording.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

static int code_of(double value, double least, double greatest, double per_unit) {
    if (isnan(value))
        return 0;
    return (int)floor(fmin(fmax(value, least), greatest) * per_unit + 0.5);
}

ControlsCode recording_quantise(const Controls *controls) {
    ControlsCode code = {.bits = controls->gear_up ? RECORDING_BIT_GEAR_UP : 0};
#define QUANTISE_WIDE(field, name, least, greatest, per_unit)                                                          \
    code.field = (int16_t)code_of(controls->field, least, greatest, per_unit);
#define QUANTISE_NARROW(field, name, least, greatest, per_unit)                                                        \
    code.field = (uint8_t)code_of(controls->field, least, greatest, per_unit);
    RECORDING_WIDE_TABLE(QUANTISE_WIDE)
    RECORDING_NARROW_TABLE(QUANTISE_NARROW)
    return code;
}

Controls recording_controls(ControlsCode code) {
    Controls controls = {.gear_up = code.bits & RECORDING_BIT_GEAR_UP};
#define DEQUANTISE(field, name, least, greatest, per_unit)                                                             \
    controls.field = fmin(fmax(code.field / (double)(per_unit), least), greatest);
    RECORDING_WIDE_TABLE(DEQUANTISE)
    RECORDING_NARROW_TABLE(DEQUANTISE)
    return controls;
}

const char *recording_event_name(int kind) {
    switch (kind) {
#define EVENT_NAME(id, code, name)                                                                                     \
    case code:                                                                                                         \
        return name;
        RECORDING_EVENT_TABLE(EVENT_NAME)
    default:
        return "unknown";
    }
}

uint64_t recording_hash_next(uint64_t running, uint64_t state_hash) {
    uint64_t z = (running + UINT64_C(0x9E3779B97F4A7C15)) ^ state_hash;
    z = (z ^ z >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ z >> 27) * UINT64_C(0x94D049BB133111EB);
    return z ^ z >> 31;
}

uint16_t recording_hash_short(uint64_t running) {
    return (uint16_t)running;
}

const char *recording_time_text(uint64_t steps, int steps_per_s, char out[RECORDING_TIME_BYTES]) {
    uint64_t s = steps / (uint64_t)steps_per_s;
    snprintf(out, RECORDING_TIME_BYTES, "%" PRIu64 ":%02d:%02d", s / 3600, (int)(s / 60 % 60), (int)(s % 60));
    return out;
}
