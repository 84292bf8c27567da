// app/dynamics/flight_model.h: how an aircraft moves: state in, controls in, state one step later out.
// ECEF metres and seconds in double, radians; body axes: x ahead, y right wing, z down. The Earth does not turn;
// gravity follows the height above the ellipsoid, along its normal. Wind is the same everywhere.
// A Flight is a value that borrows its aircraft and its ground. Deterministic: the same steps give the same bits.
#pragma once
#include "app/aircraft/aircraft.h"
#include "base/base.h"
#include "base/vec.h"
#include "input/controls.h"

#define FLIGHT_STEP_S (1.0 / 120.0)

// Height of the ground above the ellipsoid, metres; false where there is none to hit.
typedef bool FlightGroundHeight(void *user, double lat_rad, double lon_rad, double *h_m);
typedef struct FlightGround {
    FlightGroundHeight *height;
    void *user;
} FlightGround;

typedef enum FlightContact { FLIGHT_AIRBORNE, FLIGHT_ROLLING, FLIGHT_CRASHED } FlightContact;

// Everything that the next step depends on, with its controls, aircraft, ground and wind.
typedef struct FlightState {
    Vec3d position_ecef, velocity_ecef; // of the centre of gravity
    Quatd ecef_from_body;
    Vec3d rate_body;                  // rad/s
    double throttle;                  // 0..1, the lever
    double engine;                    // as app/aircraft/propulsion.h has it
    double elevator, aileron, rudder; // shares of full deflection, as they are
    double flaps, gear;               // 0 up .. 1 down, as they are
    FlightContact contact;
    uint8_t wheels;   // bit per leg that touches
    double crashed_s; // since the crash
    int64_t step;     // steps flown
} FlightState;

typedef struct FlightStart {
    double lat_rad, lon_rad, h_m; // above the ellipsoid; raised above the ground where it lies below
    double heading_rad, pitch_rad, speed_m_s;
    double bank_rad; // in a turn without slip
    bool untrimmed;  // elevator neutral and half throttle, instead of in trim
    bool on_ground;  // standing on its wheels instead, engine idle; only where there is ground
} FlightStart;

typedef struct Flight {
    FlightState state;
    const Aircraft *aircraft;
    FlightGround ground;
    Vec3d wind_ecef;   // velocity of the air, m/s
    Controls controls; // that keep the start: hands off
    bool trimmed;      // the start is steady
} Flight;

// In trim along the heading, straight or in the turn of its bank; the path starts along `pitch_rad`, of a glider along
// its glide. Where there is no such steady flight (too slow, too fast, too steep) it starts as near as the wing can
// carry, and `trimmed` is false.
Flight flight_create(const Aircraft *aircraft, const FlightStart *start, FlightGround ground);

// One step of `dt_s` (FLIGHT_STEP_S; other steps for tests of convergence): Runge-Kutta of fourth order, in shorter
// parts where the air is stiff (very fast flight) or wheels touch. Finite for every finite state. The controls act at
// once, flaps and gear at their pace. Anything but wheels on the ground, or wheels that come down faster than
// the gear bears, is a crash: the aircraft rests, and after FLIGHT_RESET_S starts anew above the place.
#define FLIGHT_RESET_S 2.0
void flight_step(Flight *flight, const Controls *controls, double dt_s);

// The state as bytes: little-endian, in the order of the fields, doubles as their bits; and back, bit by bit.
// FORMAT: `contact` is none; says nothing.
#define FLIGHT_STATE_BYTES 178
size_t flight_state_pack(const FlightState *state, uint8_t out[FLIGHT_STATE_BYTES]);
MUST_USE Result flight_state_unpack(const uint8_t bytes[FLIGHT_STATE_BYTES], FlightState *out);
// FNV-1a of these bytes.
uint64_t flight_state_hash(const FlightState *state);

// What instruments show. Continuous through the vertical but for heading and bank, which turn over there.
typedef struct FlightInstruments {
    double lat_rad, lon_rad, h_m; // above the ellipsoid
    double heading_rad;           // 0..2 pi, clockwise from north
    double pitch_rad, bank_rad;   // bank + right wing down
    double speed_m_s, vertical_speed_m_s;
    double true_airspeed, calibrated_airspeed; // m/s; calibrated: of the same pressure at sea level, incompressible
    double alpha_rad, beta_rad;                // against the air; 0 below 3 m/s
    double load_factor;                        // 1 in level flight, and at rest on the wheels
    double path_rad, track_rad;                // of the flight path, up and clockwise from north; heading at rest
    bool over_ground;
    double above_ground_m; // valid over ground
} FlightInstruments;
FlightInstruments flight_instruments(const Flight *flight);

// Attitude of a body with heading, pitch and bank at a place.
Quatd flight_attitude(double lat_rad, double lon_rad, double heading_rad, double pitch_rad, double bank_rad);
