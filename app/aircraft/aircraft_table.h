// app/aircraft/aircraft_table.h: every key of an aircraft file, one row each. Nothing else knows names and ranges.
// Kinds of config/quantity.h; ranges hold in SI units.
// Included by aircraft_file.c only.
#pragma once

#define REQUIRED NAN

// clang-format off
// X(section, key, field, kind of quantity, least, greatest, default or REQUIRED)
#define AIRCRAFT_TABLE(X)                                                                                              \
    X("aircraft", "cruise-speed", cruise_speed, SPEED, 5, 1000, REQUIRED)                                              \
    X("aircraft", "never-exceed-speed", never_exceed_speed, SPEED, 10, 2000, REQUIRED)                                 \
    X("aircraft", "mach-limit", mach_limit, PLAIN, 0.05, 1, REQUIRED)                                                  \
    X("mass", "mass", mass, MASS, 1, 1e6, REQUIRED)                                                                    \
    X("mass", "ixx", ixx, INERTIA, 1e-2, 1e9, REQUIRED)                                                                \
    X("mass", "iyy", iyy, INERTIA, 1e-2, 1e9, REQUIRED)                                                                \
    X("mass", "izz", izz, INERTIA, 1e-2, 1e9, REQUIRED)                                                                \
    X("mass", "ixz", ixz, INERTIA, -1e8, 1e8, 0)                                                                       \
    X("wing", "area", area, AREA, 0.1, 2000, REQUIRED)                                                                 \
    X("wing", "span", span, LENGTH, 0.5, 150, REQUIRED)                                                                \
    X("wing", "chord", chord, LENGTH, 0.05, 30, REQUIRED)                                                              \
    X("wing", "z", wing_z, LENGTH, -10, 10, 0)                                                                         \
    X("lift", "zero", cl_0, PLAIN, -1, 1.5, REQUIRED)                                                                  \
    X("lift", "alpha", cl_alpha, PLAIN, 1, 12, REQUIRED)                                                               \
    X("lift", "alpha-dot", cl_alpha_dot, PLAIN, 0, 20, 0)                                                              \
    X("lift", "pitch-rate", cl_q, PLAIN, -5, 30, 0)                                                                    \
    X("lift", "elevator", cl_elevator, PLAIN, -1, 3, REQUIRED)                                                         \
    X("lift", "flaps", cl_flaps, PLAIN, 0, 2, 0)                                                                       \
    X("lift", "maximum", cl_max, PLAIN, 0.5, 3, REQUIRED)                                                              \
    X("lift", "maximum-flaps", cl_max_flaps, PLAIN, 0.5, 4, REQUIRED)                                                  \
    X("lift", "minimum", cl_min, PLAIN, -2, -0.2, REQUIRED)                                                            \
    X("lift", "stall-width", stall_width_rad, ANGLE, 2, 30, 10)                                                        \
    X("drag", "zero", cd_0, PLAIN, 0.002, 0.3, REQUIRED)                                                               \
    X("drag", "efficiency", oswald, PLAIN, 0.3, 1.2, REQUIRED)                                                         \
    X("drag", "flaps", cd_flaps, PLAIN, 0, 0.5, 0)                                                                     \
    X("drag", "gear", cd_gear, PLAIN, 0, 0.2, 0)                                                                       \
    X("drag", "sideslip", cd_beta, PLAIN, 0, 2, REQUIRED)                                                              \
    X("drag", "plate", cd_plate, PLAIN, 0.8, 2.5, 1.2)                                                                 \
    X("side", "beta", cy_beta, PLAIN, -3, 0, REQUIRED)                                                                 \
    X("side", "roll-rate", cy_p, PLAIN, -3, 3, 0)                                                                      \
    X("side", "yaw-rate", cy_r, PLAIN, -3, 3, 0)                                                                       \
    X("side", "aileron", cy_aileron, PLAIN, -2, 2, 0)                                                                  \
    X("side", "rudder", cy_rudder, PLAIN, -2, 2, REQUIRED)                                                             \
    X("roll", "beta", cr_beta, PLAIN, -1, 0.5, REQUIRED)                                                               \
    X("roll", "roll-rate", cr_p, PLAIN, -2, -0.05, REQUIRED)                                                           \
    X("roll", "yaw-rate", cr_r, PLAIN, -1, 1, REQUIRED)                                                                \
    X("roll", "aileron", cr_aileron, PLAIN, 0.01, 1, REQUIRED)                                                         \
    X("roll", "rudder", cr_rudder, PLAIN, -0.5, 0.5, 0)                                                                \
    X("pitch", "zero", cm_0, PLAIN, -1, 1, REQUIRED)                                                                   \
    X("pitch", "alpha", cm_alpha, PLAIN, -10, 1, REQUIRED)                                                             \
    X("pitch", "alpha-dot", cm_alpha_dot, PLAIN, -60, 0, 0)                                                            \
    X("pitch", "pitch-rate", cm_q, PLAIN, -100, -0.5, REQUIRED)                                                        \
    X("pitch", "elevator", cm_elevator, PLAIN, -5, -0.05, REQUIRED)                                                    \
    X("pitch", "flaps", cm_flaps, PLAIN, -1, 1, 0)                                                                     \
    X("yaw", "beta", cn_beta, PLAIN, -0.5, 2, REQUIRED)                                                                \
    X("yaw", "roll-rate", cn_p, PLAIN, -2, 2, 0)                                                                       \
    X("yaw", "yaw-rate", cn_r, PLAIN, -3, 0, REQUIRED)                                                                 \
    X("yaw", "aileron", cn_aileron, PLAIN, -0.5, 0.5, 0)                                                               \
    X("yaw", "rudder", cn_rudder, PLAIN, -1, -0.005, REQUIRED)                                                         \
    X("controls", "elevator", elevator_rad, ANGLE, 2, 60, REQUIRED)                                                    \
    X("controls", "aileron", aileron_rad, ANGLE, 2, 60, REQUIRED)                                                      \
    X("controls", "rudder", rudder_rad, ANGLE, 2, 60, REQUIRED)                                                        \
    X("controls", "flaps-time", flaps_s, TIME, 0, 120, 0)                                                              \
    X("controls", "gear-time", gear_s, TIME, 0, 120, 0)                                                                \
    X("hull", "sink-limit", sink_limit, SPEED, 0.5, 20, REQUIRED)

#define PISTON_TABLE(X)                                                                                                \
    X("engine", "torque", torque, TORQUE, 1, 1e6, REQUIRED)                                                            \
    X("engine", "rated-speed", rated_speed, RATE, 1, 1000, REQUIRED)                                                   \
    X("engine", "altitude-drop", altitude_drop, PLAIN, 0, 0.9, 0.12)                                                   \
    X("engine", "idle-torque", idle_torque, PLAIN, 0.005, 0.5, REQUIRED)                                               \
    X("engine", "rotor-inertia", rotor_inertia, INERTIA, 1e-3, 1e5, REQUIRED)                                          \
    X("engine", "propeller-diameter", propeller_diameter, LENGTH, 0.1, 10, REQUIRED)                                   \
    X("engine", "polar-slope", polar_slope, PLAIN, 0.1, 5, REQUIRED)                                                   \
    X("engine", "polar-intercept", polar_intercept, PLAIN, -1, 0, REQUIRED)                                            \
    X("engine", "power-static", power_static, PLAIN, 1e-3, 1, REQUIRED)                                                \
    X("engine", "power-advance", power_advance, PLAIN, 0, 1, REQUIRED)

#define JET_TABLE(X)                                                                                                   \
    X("engine", "thrust", thrust, FORCE, 10, 1e7, REQUIRED)                                                            \
    X("engine", "density-exponent", density_exponent, PLAIN, 0.3, 1.5, REQUIRED)                                       \
    X("engine", "mach-slope", mach_slope, PLAIN, -2, 2, 0)                                                             \
    X("engine", "mach-curve", mach_curve, PLAIN, -2, 2, 0)                                                             \
    X("engine", "idle-thrust", idle_thrust, PLAIN, 0, 0.5, REQUIRED)                                                   \
    X("engine", "spool-time", spool_s, TIME, 0.05, 60, REQUIRED)

// Fields of AircraftLeg, in each section [leg NAME].
#define LEG_TABLE(X)                                                                                                   \
    X("leg", "stiffness", stiffness, STIFFNESS, 100, 1e8, REQUIRED)                                                    \
    X("leg", "damping", damping, DAMPING, 0, 1e7, REQUIRED)                                                            \
    X("leg", "rolling", rolling, PLAIN, 0, 1, 0.02)                                                                    \
    X("leg", "friction", friction, PLAIN, 0.05, 1.5, 0.7)                                                              \
    X("leg", "steering", steer_rad, ANGLE, 0, 80, 0)                                                                   \
    X("leg", "brake-left", brake_left, PLAIN, 0, 1, 0)                                                                 \
    X("leg", "brake-right", brake_right, PLAIN, 0, 1, 0)

#define PUBLISHED_TABLE(X)                                                                                             \
    X("published", "stall-clean", stall_clean, SPEED, 1, 500, NAN)                                                     \
    X("published", "stall-flaps", stall_flaps, SPEED, 1, 500, NAN)                                                     \
    X("published", "climb-rate", climb_rate, SPEED, 0, 500, NAN)                                                       \
    X("published", "climb-speed", climb_speed, SPEED, 1, 500, NAN)                                                     \
    X("published", "glide-ratio", glide_ratio, PLAIN, 1, 100, NAN)                                                     \
    X("published", "glide-speed", glide_speed, SPEED, 1, 500, NAN)
// clang-format on
