// app/flight/flight_model.h: how an aircraft moves: state in, controls in, state one step later out. A more detailed
// model may take this one's place behind the same functions. ECEF metres and seconds in double, radians; body axes: x
// ahead, y right wing, z down. The Earth does not turn. A Flight is a value that borrows its ground. Deterministic: the
// same steps give the same bits.
#pragma once
#include "base/base.h"
#include "base/vec.h"
#include "input/controls.h"

#define FLIGHT_STEP_S (1.0 / 120.0)
#define FLIGHT_GEAR_M 1.5 // height of the aircraft's reference point above the wheels

// Height of the ground above the ellipsoid, metres; false where there is none to hit.
typedef bool FlightGroundHeight(void *user, double lat_rad, double lon_rad, double *h_m);
typedef struct FlightGround {
    FlightGroundHeight *height;
    void *user;
} FlightGround;

typedef enum FlightContact { FLIGHT_AIRBORNE, FLIGHT_ROLLING, FLIGHT_CRASHED } FlightContact;

typedef struct FlightState {
    Vec3d position_ecef, velocity_ecef;
    Quatd ecef_from_body;
    Vec3d rate_body; // rad/s
    double throttle; // 0..1, as the engine has it
    FlightContact contact;
    double crashed_s; // since the crash
    int64_t step;     // steps flown
} FlightState;

typedef struct FlightStart {
    double lat_rad, lon_rad, h_m; // above the ellipsoid; raised above the ground where it lies below
    double heading_rad, pitch_rad, speed_m_s;
} FlightStart;

typedef struct Flight {
    FlightState state;
    FlightGround ground;
} Flight;

// In trim along the heading; the flight path starts along `pitch_rad`.
Flight flight_create(const FlightStart *start, FlightGround ground);

// One step of `dt_s` (FLIGHT_STEP_S; other steps for tests of convergence). Finite for every finite state. Touching the
// ground slow, level and gently is a landing; otherwise a crash: the aircraft rests, and after
// FLIGHT_RESET_S starts anew above the place.
#define FLIGHT_RESET_S 2.0
void flight_step(Flight *flight, const Controls *controls, double dt_s);

// The throttle that holds `speed_m_s` in level flight at the height, 0..1.
double flight_trim_throttle(double speed_m_s, double h_m);
// Angle between the flight path and the body's axis in level flight, at most the stall angle.
double flight_trim_alpha(double speed_m_s, double h_m);

// What instruments show. Continuous through the vertical but for heading and bank, which turn over there.
typedef struct FlightInstruments {
    double lat_rad, lon_rad, h_m; // above the ellipsoid
    double heading_rad;           // 0..2 pi, clockwise from north
    double pitch_rad, bank_rad;   // bank + right wing down
    double speed_m_s, vertical_speed_m_s;
    double alpha_rad, load_factor;
    bool over_ground;
    double above_ground_m; // valid over ground
} FlightInstruments;
FlightInstruments flight_instruments(const Flight *flight);

// Attitude of a body with heading, pitch and bank at a place.
Quatd flight_attitude(double lat_rad, double lon_rad, double heading_rad, double pitch_rad, double bank_rad);
