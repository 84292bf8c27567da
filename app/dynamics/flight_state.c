#include "app/dynamics/flight_model.h"

#include <string.h>

// A state's numbers in the order of its bytes.
#define STATE_DOUBLES 21
static void list_numbers(FlightState *s, double *out[STATE_DOUBLES]) {
    double *const numbers[STATE_DOUBLES] = {&s->position_ecef.x,
                                            &s->position_ecef.y,
                                            &s->position_ecef.z,
                                            &s->velocity_ecef.x,
                                            &s->velocity_ecef.y,
                                            &s->velocity_ecef.z,
                                            &s->ecef_from_body.w,
                                            &s->ecef_from_body.x,
                                            &s->ecef_from_body.y,
                                            &s->ecef_from_body.z,
                                            &s->rate_body.x,
                                            &s->rate_body.y,
                                            &s->rate_body.z,
                                            &s->throttle,
                                            &s->engine,
                                            &s->elevator,
                                            &s->aileron,
                                            &s->rudder,
                                            &s->flaps,
                                            &s->gear,
                                            &s->crashed_s};
    memcpy(out, numbers, sizeof numbers);
}

_Static_assert(STATE_DOUBLES * 8 + 8 + 2 == FLIGHT_STATE_BYTES, "doubles, step, contact, wheels");

static void put_word(uint8_t *out, uint64_t word) {
    for (int i = 0; i < 8; i++)
        out[i] = (uint8_t)(word >> (8 * i));
}

static uint64_t take_word(const uint8_t *bytes) {
    uint64_t word = 0;
    for (int i = 0; i < 8; i++)
        word |= (uint64_t)bytes[i] << (8 * i);
    return word;
}

size_t flight_state_pack(const FlightState *state, uint8_t out[FLIGHT_STATE_BYTES]) {
    FlightState copy = *state;
    double *numbers[STATE_DOUBLES];
    list_numbers(&copy, numbers);
    for (int i = 0; i < STATE_DOUBLES; i++) {
        uint64_t bits;
        memcpy(&bits, numbers[i], sizeof bits);
        put_word(out + 8 * i, bits);
    }
    put_word(out + 8 * STATE_DOUBLES, (uint64_t)state->step);
    out[8 * STATE_DOUBLES + 8] = (uint8_t)state->contact;
    out[8 * STATE_DOUBLES + 9] = state->wheels;
    return FLIGHT_STATE_BYTES;
}

Result flight_state_unpack(const uint8_t bytes[FLIGHT_STATE_BYTES], FlightState *out) {
    FlightState state = {.step = (int64_t)take_word(bytes + 8 * STATE_DOUBLES)};
    double *numbers[STATE_DOUBLES];
    list_numbers(&state, numbers);
    for (int i = 0; i < STATE_DOUBLES; i++) {
        uint64_t bits = take_word(bytes + 8 * i);
        memcpy(numbers[i], &bits, sizeof bits);
    }
    uint8_t contact = bytes[8 * STATE_DOUBLES + 8];
    if (contact > FLIGHT_CRASHED)
        return RESULT_FORMAT;
    state.contact = (FlightContact)contact;
    state.wheels = bytes[8 * STATE_DOUBLES + 9];
    *out = state;
    return RESULT_OK;
}

uint64_t flight_state_hash(const FlightState *state) {
    uint8_t bytes[FLIGHT_STATE_BYTES];
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0, count = flight_state_pack(state, bytes); i < count; i++)
        hash = (hash ^ bytes[i]) * 0x100000001b3u;
    return hash;
}
