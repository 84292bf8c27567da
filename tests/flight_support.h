// tests/flight_support.h: aircraft, grounds and starts for the tests of flight.
// SI units, radians.
// Aircraft are read once per call; grounds are formulas.
#pragma once
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>

#include "app/dynamics/flight_model.h"
#include "terrain/geodesy.h"

#define FLIGHT_LAT 0.64
#define FLIGHT_LON (-1.47)

static const char *const flight_types[] = {"t37", "c172", "ask21"};

static inline Aircraft flight_type(const char *name) {
    Aircraft aircraft;
    assert_int_equal(aircraft_load(name, &aircraft), RESULT_OK);
    return aircraft;
}

static inline bool flight_flat(void *user, double lat_rad, double lon_rad, double *h_m) {
    (void)lat_rad;
    (void)lon_rad;
    *h_m = *(const double *)user;
    return true;
}

static inline bool flight_nowhere(void *user, double lat_rad, double lon_rad, double *h_m) {
    (void)user;
    (void)lat_rad;
    (void)lon_rad;
    *h_m = 0.0;
    return false;
}

static inline Flight flight_at(const Aircraft *aircraft, double h_m, double heading_rad, double pitch_rad, double speed,
                               FlightGround ground) {
    FlightStart start = {.lat_rad = FLIGHT_LAT,
                         .lon_rad = FLIGHT_LON,
                         .h_m = h_m,
                         .heading_rad = heading_rad,
                         .pitch_rad = pitch_rad,
                         .speed_m_s = speed};
    return flight_create(aircraft, &start, ground);
}

static inline Flight flight_in_air(const Aircraft *aircraft, double h_m, double speed) {
    return flight_at(aircraft, h_m, 0.3, 0.0, speed, (FlightGround){flight_nowhere, NULL});
}

static inline bool flight_is_finite(const FlightState *s) {
    const double values[] = {
        s->position_ecef.x, s->position_ecef.y,  s->position_ecef.z,  s->velocity_ecef.x,  s->velocity_ecef.y,
        s->velocity_ecef.z, s->ecef_from_body.w, s->ecef_from_body.x, s->ecef_from_body.y, s->ecef_from_body.z,
        s->rate_body.x,     s->rate_body.y,      s->rate_body.z,      s->throttle,         s->engine};
    for (size_t i = 0; i < COUNT_OF(values); i++)
        if (!isfinite(values[i]))
            return false;
    return true;
}

static inline void flight_on(Flight *flight, Controls controls, double seconds) {
    for (int i = 0; i < (int)(seconds / FLIGHT_STEP_S + 0.5); i++) {
        flight_step(flight, &controls, FLIGHT_STEP_S);
        if (!flight_is_finite(&flight->state))
            fail_msg("not finite after %lld steps", (long long)flight->state.step);
    }
}
