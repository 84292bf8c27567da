// app/aircraft/aircraft.h: what a type of aircraft is: mass, aerodynamics, engine, gear. Constant once read.
// SI units; body axes x ahead, y right wing, z down, from the centre of gravity; coefficients a radian.
// A value without pointers; whoever keeps it lends it out. Any thread may read it.
#pragma once
#include "base/base.h"
#include "base/paths.h"
#include "base/vec.h"
#include "config/named_files.h"

#define AIRCRAFT_LEGS_MAX 6
#define AIRCRAFT_TEXT_BYTES 256
#define AIRCRAFT_ENDING ".aircraft"
#define AIRCRAFT_DEFAULT "t37"

typedef enum AircraftEngine { AIRCRAFT_GLIDER, AIRCRAFT_PISTON, AIRCRAFT_JET, AIRCRAFT_ENGINE_COUNT } AircraftEngine;
const char *aircraft_engine_name(AircraftEngine engine); // "none", "piston", "jet"

// A wheel or skid on a spring and damper that works upwards in body axes.
typedef struct AircraftLeg {
    char name[32];
    double x, y, z;                 // foot without load, m
    double stiffness, damping;      // N/m, N s/m
    double rolling, friction;       // coefficients along the wheel, and at most in any direction
    double steer_rad;               // at full rudder, right
    double brake_left, brake_right; // share of the friction that full brakes use
} AircraftLeg;

typedef struct AircraftPublished {
    double stall_clean, stall_flaps; // m/s, calibrated, power off; NAN: not published
    double climb_rate, climb_speed;  // m/s at sea level
    double glide_ratio, glide_speed;
    char source[AIRCRAFT_TEXT_BYTES];
} AircraftPublished;

// Non-dimensional derivatives: Roskam, Airplane Flight Dynamics and Automatic Flight Controls, part I, chapter 3. Rates
// are made non-dimensional with chord / 2V or span / 2V. Positive: elevator trailing edge down, aileron right wing
// down, rudder trailing edge left.
typedef struct Aircraft {
    char id[64]; // of the file, without folder and ending
    char name[AIRCRAFT_TEXT_BYTES], source[AIRCRAFT_TEXT_BYTES];
    double cruise_speed, never_exceed_speed, mach_limit; // m/s
    double mass, ixx, iyy, izz, ixz;                     // kg, kg m^2
    double area, span, chord, wing_z;                    // m^2, m
    double cl_0, cl_alpha, cl_alpha_dot, cl_q, cl_elevator, cl_flaps;
    double cl_max, cl_max_flaps, cl_min, stall_width_rad; // of the wing without elevator
    double cd_0, oswald, cd_flaps, cd_gear, cd_beta, cd_plate;
    double cy_beta, cy_p, cy_r, cy_aileron, cy_rudder;
    double cr_beta, cr_p, cr_r, cr_aileron, cr_rudder; // rolling moment
    double cm_0, cm_alpha, cm_alpha_dot, cm_q, cm_elevator, cm_flaps;
    double cn_beta, cn_p, cn_r, cn_aileron, cn_rudder;
    double elevator_rad, aileron_rad, rudder_rad; // full deflections
    double flaps_s, gear_s;                       // from up to down; 0: no flaps, fixed gear
    int engine;                                   // AircraftEngine
    // piston
    double torque, rated_speed, altitude_drop, idle_torque, rotor_inertia; // N m, rev/s, 1, share, kg m^2
    double propeller_diameter, polar_slope, polar_intercept, power_static, power_advance;
    // jet
    double thrust, density_exponent, mach_slope, mach_curve, idle_thrust, spool_s; // N; share of thrust
    double sink_limit;                                                             // m/s, of a landing
    Vec3d nose, tail, tip, belly;                                                  // tip: of the right wing
    AircraftLeg legs[AIRCRAFT_LEGS_MAX];
    int leg_count;
    AircraftPublished published;
    // What follows from the above, by aircraft_derive.
    double stall_rad, stall_flaps_rad, stall_below_rad; // where the stall's blend is half done
    double panel_y;                                     // m: arm of half a wing in roll
    double induced;                                     // CD = cd_0 + induced CL^2
} Aircraft;

// Computes the derived values. RANGE: no stall angle gives the lift that the data ask for; says nothing.
MUST_USE Result aircraft_derive(Aircraft *aircraft);

// Reads an INI file: sections and keys as listed in docs/aircraft.md; every key must be there but those with a default.
// NOT_FOUND, IO, FORMAT: file, line, what was expected; logged.
MUST_USE Result aircraft_read(const char *path, Aircraft *out);
// The file that this is, or of the aircraft that came with the program under this name ("c172"). As named_files_find.
MUST_USE Result aircraft_find(const char *where, const char *name_or_path, char path[PATHS_BYTES_MAX]);
// aircraft_find and aircraft_read.
MUST_USE Result aircraft_load(const char *name_or_path, Aircraft *out);
// The aircraft that came with the program. NOT_FOUND, IO; logged.
MUST_USE Result aircraft_list(NamedFiles *out);
