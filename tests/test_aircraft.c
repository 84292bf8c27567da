// Aircraft: the standard atmosphere, forces, trim, and how they swing, climb and glide, against theory that is written
// down here once more, by hand. Floating-point exceptions trap.
#define _GNU_SOURCE
#include <fenv.h>
#include <stdio.h>
#include <string.h>

#include "tests/flight_support.h"

#include "app/aircraft/airframe.h"
#include "app/aircraft/isa.h"
#include "app/aircraft/propulsion.h"
#include "app/aircraft/trim.h"
#include "app/performance/performance.h"
#include "app/pilot/autopilot.h"

#define GRAVITY TRIM_GRAVITY_0

static void expect_near(const char *what, double found, double expected, double share) {
    if (!(fabs(found - expected) <= share * fabs(expected)))
        fail_msg("%s: found %.9g, expected %.9g within %.2g %%", what, found, expected, 100.0 * share);
}

// U.S. Standard Atmosphere 1976, table I, geometric heights.
static void the_atmosphere_is_that_of_the_tables(void **state) {
    (void)state;
    static const struct {
        double h_m, temperature, pressure, density, sound;
    } table[] = {
        {-1000, 294.651, 113929, 1.3470, 344.11},     {0, 288.150, 101325, 1.2250, 340.294},
        {5000, 255.676, 54048, 0.73643, 320.55},      {11000, 216.774, 22700, 0.36480, 295.15},
        {20000, 216.650, 5529.3, 0.088910, 295.07},   {32000, 228.490, 889.06, 0.013555, 303.02},
        {50000, 270.650, 79.779, 1.0269e-3, 329.80},  {70000, 219.585, 5.2209, 8.2829e-5, 297.06},
        {85000, 188.893, 0.44568, 8.2196e-6, 275.52},
    };
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        Isa air = isa_at(table[i].h_m);
        expect_near("temperature", air.temperature_k, table[i].temperature, 1e-3);
        expect_near("pressure", air.pressure_pa, table[i].pressure, 1e-3);
        expect_near("density", air.density, table[i].density, 1e-3);
        expect_near("speed of sound", air.sound_m_s, table[i].sound, 1e-3);
    }
    // Table I has the geopotential height beside each: 4996, 10981 and 19937 m.
    expect_near("pressure altitude", isa_pressure_altitude(5000.0), 4996.0, 1e-4);
    expect_near("pressure altitude", isa_pressure_altitude(11000.0), 10981.0, 1e-4);
    expect_near("pressure altitude", isa_pressure_altitude(20000.0), 19937.0, 1e-4);
}

static void the_atmosphere_has_no_steps_and_no_end(void **state) {
    (void)state;
    double before = isa_at(-5000.0).density;
    for (double h_m = -4990.0; h_m < 200e3; h_m += 10.0) {
        double density = isa_at(h_m).density;
        if (!(density > 0.0 && density < before && density > 0.995 * before))
            fail_msg("at %.0f m: %.9g after %.9g", h_m, density, before);
        before = density;
    }
    static const double heights[] = {-1e9, -6.4e6, 1e6, 1e12};
    for (size_t i = 0; i < COUNT_OF(heights); i++)
        assert_true(isa_at(heights[i]).density >= 0.0 && isfinite(isa_at(heights[i]).pressure_pa));
}

static AirframeFlow flow_at(double speed, double alpha, double beta) {
    Vec3d v = {speed * cos(alpha) * cos(beta), speed * sin(beta), speed * sin(alpha) * cos(beta)};
    return (AirframeFlow){.air_body = v, .density = ISA_DENSITY_0, .gear = 1.0, .wing_above_m = INFINITY};
}

static double lift_coefficient(const Aircraft *a, double alpha) {
    AirframeFlow flow = flow_at(50.0, alpha, 0.0);
    AirframeLoad load = airframe_load(a, &flow);
    return (load.force.x * sin(alpha) - load.force.z * cos(alpha)) / (0.5 * ISA_DENSITY_0 * 2500.0 * a->area);
}

// The derivatives that the file gives are those that come out.
static void derivatives_come_back_from_forces(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(flight_types); i++) {
        Aircraft a = flight_type(flight_types[i]);
        double pressure = 0.5 * ISA_DENSITY_0 * 2500.0, d = 1e-4;
        AirframeFlow flow = flow_at(50.0, 0.0, 0.0), up = flow_at(50.0, d, 0.0), side = flow_at(50.0, 0.0, d);
        AirframeLoad at = airframe_load(&a, &flow), raised = airframe_load(&a, &up), slid = airframe_load(&a, &side);
        expect_near("CLalpha", (lift_coefficient(&a, d) - lift_coefficient(&a, -d)) / (2.0 * d), a.cl_alpha, 1e-4);
        double scale = pressure * a.area * d;
        expect_near("Cmalpha", (raised.moment.y - at.moment.y) / (scale * a.chord), a.cm_alpha, 1e-3);
        expect_near("Clbeta", slid.moment.x / (scale * a.span), a.cr_beta, 1e-6);
        expect_near("Cnbeta", slid.moment.z / (scale * a.span), a.cn_beta, 1e-6);
        flow.rate_body = vec3d(d, 0.0, 0.0);
        double half = pressure * a.area * a.span * a.span / (2.0 * 50.0) * d;
        expect_near("Clp", airframe_load(&a, &flow).moment.x / half, a.cr_p, 1e-6);
        flow.rate_body = vec3d(0.0, d, 0.0);
        half = pressure * a.area * a.chord * a.chord / (2.0 * 50.0) * d;
        expect_near("Cmq", (airframe_load(&a, &flow).moment.y - at.moment.y) / half, a.cm_q, 1e-6);
    }
}

static void lift_peaks_where_the_file_says_and_is_smooth_all_round(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(flight_types); i++) {
        Aircraft a = flight_type(flight_types[i]);
        double greatest = 0.0, flapped = 0.0, least = 0.0, before = lift_coefficient(&a, -GEODESY_PI), step = 0.0;
        for (double alpha = -GEODESY_PI; alpha <= GEODESY_PI; alpha += 1e-3) {
            greatest = fmax(greatest, airframe_wing_lift(&a, alpha, 0.0));
            flapped = fmax(flapped, airframe_wing_lift(&a, alpha, 1.0));
            least = fmin(least, airframe_wing_lift(&a, alpha, 0.0));
            step = fmax(step, fabs(lift_coefficient(&a, alpha) - before));
            before = lift_coefficient(&a, alpha);
        }
        expect_near("greatest lift", greatest, a.cl_max, 1e-3);
        expect_near("greatest lift with flaps", flapped, a.cl_max_flaps, 1e-3);
        expect_near("least lift", least, a.cl_min, 2e-3);
        assert_true(step < 0.03);
    }
}

static void air_forces_take_energy_at_every_angle(void **state) {
    (void)state;
    for (int i = 0; i < 36 * 19 * 3; i++) {
        Aircraft a = flight_type(flight_types[i % 3]);
        AirframeFlow flow = flow_at(50.0, (i / 3 % 36) * GEODESY_PI / 18.0, (i / 3 / 36 - 9) * GEODESY_PI / 18.0);
        double power = vec3d_dot(airframe_load(&a, &flow).force, flow.air_body);
        if (!(power < 0.0))
            fail_msg("%s, flow %d: the air gives %.1f W", a.id, i, power);
    }
}

static void induced_drag_falls_near_the_ground(void **state) {
    (void)state;
    Aircraft a = flight_type("c172");
    expect_near("at a span", airframe_ground_effect(&a, a.span), 256.0 / 257.0, 1e-9);
    expect_near("at a tenth of it", airframe_ground_effect(&a, 0.1 * a.span), 2.56 / 3.56, 1e-9);
    assert_true(airframe_ground_effect(&a, -5.0) > 0.0 && airframe_ground_effect(&a, INFINITY) == 1.0);
    AirframeFlow flow = flow_at(28.0, 0.15, 0.0);
    double high = airframe_load(&a, &flow).force.x;
    flow.wing_above_m = 2.2;
    assert_true(airframe_load(&a, &flow).force.x > high + 30.0);
}

// What the propeller gives of the engine's power, by Lowry's data: full throttle standing, climbing, cruising.
static void the_propeller_turns_and_pulls_as_published(void **state) {
    (void)state;
    Aircraft a = flight_type("c172");
    Isa air = isa_at(0.0);
    double standing = propulsion_steady(&a, &air, 0.0, 1.0) * a.rated_speed * 60.0;
    double fast = propulsion_steady(&a, &air, 64.3, 1.0) * a.rated_speed * 60.0;
    double idle = propulsion_steady(&a, &air, 0.0, 0.0) * a.rated_speed * 60.0;
    print_message("full throttle %.0f rpm standing, %.0f at 125 kt; idle %.0f\n", standing, fast, idle);
    assert_true(standing > 2300.0 && standing < 2420.0); // handbook, static
    assert_true(fast > 2650.0 && fast < 2750.0 && idle > 500.0 && idle < 800.0);
    double engine = propulsion_steady(&a, &air, 39.0, 1.0);
    double thrust = propulsion_at(&a, &air, 39.0, engine, 1.0).thrust_n;
    // T = 2 pi m M / d + b rho d^2 V^2, whatever the speed of the engine.
    double expected = 2.0 * GEODESY_PI * 1.70 * 421.9 / 1.905 - 0.0564 * 1.225 * 1.905 * 1.905 * 39.0 * 39.0;
    expect_near("thrust at 39 m/s", thrust, expected, 2e-3);
}

// Lowry, Performance of Light Aircraft, table 7.5: full throttle at sea level, 75 kt, 2400 lb: 448.0 lbf of thrust,
// 226.7 lbf of drag, 700.2 ft/min. Ours has a wing of 36 ft for his 35.83, and thrust that acts along the fuselage.
static void the_c172_climbs_as_lowrys(void **state) {
    (void)state;
    Aircraft a = flight_type("c172");
    Isa air = isa_at(0.0);
    TrimWish wish = {.speed_m_s = 75.0 * 1852.0 / 3600.0, .gear = 1.0, .throttle_given = true, .throttle = 1.0};
    Trim trim;
    assert_int_equal(trim_solve(&a, &wish, &trim), RESULT_OK);
    double axial = wish.speed_m_s * cos(trim.alpha_rad), lbf = 4.4482216;
    double thrust = propulsion_at(&a, &air, axial, trim.engine, 1.0).thrust_n;
    double drag = thrust * cos(trim.alpha_rad) - a.mass * GRAVITY * sin(trim.path_rad);
    double climb = wish.speed_m_s * sin(trim.path_rad) * 60.0 / 0.3048;
    print_message("thrust %.1f lbf, drag %.1f lbf, climb %.1f ft/min\n", thrust / lbf, drag / lbf, climb);
    expect_near("thrust", thrust / lbf, 448.0, 0.01);
    expect_near("drag", drag / lbf, 226.7, 0.02);
    expect_near("climb", climb, 700.2, 0.02);
}

static void trim_leaves_nothing_over(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(flight_types); i++) {
        Aircraft a = flight_type(flight_types[i]);
        for (int k = 0; k < 6; k++) {
            Flight flight = flight_in_air(&a, 500.0 * k, a.cruise_speed * (0.8 + 0.05 * k));
            assert_true(flight.trimmed);
            FlightState first = flight.state;
            flight_step(&flight, &flight.controls, FLIGHT_STEP_S);
            Vec3d change = vec3d_sub(flight.state.velocity_ecef, first.velocity_ecef);
            // The path curves with the Earth: V^2 / R.
            double curve = a.cruise_speed * a.cruise_speed / GEODESY_A_M;
            assert_true(vec3d_length(change) / FLIGHT_STEP_S < 1.2 * curve + 1e-5);
            assert_true(vec3d_distance(flight.state.rate_body, first.rate_body) / FLIGHT_STEP_S < 1e-6);
        }
    }
}

static void impossible_flights_are_refused(void **state) {
    (void)state;
    Aircraft a = flight_type("c172"), glider = flight_type("ask21");
    const TrimWish wishes[] = {
        {.speed_m_s = 15.0, .h_m = 1000.0, .gear = 1.0},                  // below the stall
        {.speed_m_s = 90.0, .h_m = 1000.0, .gear = 1.0},                  // beyond the engine
        {.speed_m_s = 40.0, .h_m = 1000.0, .path_rad = 0.5, .gear = 1.0}, // too steep
        {.speed_m_s = 40.0, .h_m = 12000.0, .gear = 1.0},                 // too high
        {.speed_m_s = 0.0, .h_m = 0.0, .gear = 1.0},
        {.speed_m_s = 1e6, .h_m = 0.0, .gear = 1.0},
    };
    Trim trim;
    for (size_t i = 0; i < COUNT_OF(wishes); i++)
        if (trim_solve(&a, &wishes[i], &trim) != RESULT_RANGE)
            fail_msg("wish %zu: flies with throttle %.3f, alpha %.3f", i, trim.throttle, trim.alpha_rad);
    TrimWish level = {.speed_m_s = 30.0, .gear = 1.0};
    assert_int_equal(trim_solve(&glider, &level, &trim), RESULT_RANGE);
}

// Eigenvalues of matrices whose roots are known.
static void eigenvalues_are_found(void **state) {
    (void)state;
    const double companion[16] = {0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -100, -52, -32, -6}; // see below
    ModesRoot roots[4];
    modes_eigenvalues(companion, 4, roots);
    // Whatever the roots are, they solve x^4 + 6 x^3 + 32 x^2 + 52 x + 100.
    double product_re = 1.0, product_im = 0.0, sum = 0.0;
    for (int i = 0; i < 4; i++) {
        double re = product_re * roots[i].re - product_im * roots[i].im;
        product_im = product_re * roots[i].im + product_im * roots[i].re;
        product_re = re;
        sum += roots[i].re;
    }
    expect_near("product", product_re, 100.0, 1e-9);
    expect_near("sum", sum, -6.0, 1e-9);
    const double rotation[4] = {-0.1, -2.0, 2.0, -0.1};
    modes_eigenvalues(rotation, 2, roots);
    expect_near("real part", roots[0].re, -0.1, 1e-9);
    expect_near("imaginary part", fabs(roots[0].im), 2.0, 1e-9);
}

// The matrix of the textbook (Etkin and Reid, chapter 4; Roskam, chapter 5), from dimensional derivatives written out
// here: short period by its approximation from Z_w, M_w, M_q, M_wdot; phugoid by Lanchester and Ray's.
static void the_linearised_model_is_the_textbooks(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        Aircraft a = flight_type(flight_types[i]);
        Flight flight = flight_in_air(&a, 1500.0, a.cruise_speed);
        Modes modes = modes_of_theory(&flight);
        double v = a.cruise_speed, pressure = 0.5 * isa_at(1500.0).density * v * v, force = pressure * a.area / a.mass;
        double z_alpha = -force * (a.cl_alpha + a.cd_0), arm = pressure * a.area * a.chord / a.iyy;
        double m_q = arm * a.cm_q * a.chord / (2.0 * v), m_dot = arm * a.cm_alpha_dot * a.chord / (2.0 * v);
        double omega = sqrt(z_alpha * m_q / v - arm * a.cm_alpha);
        double damping = -(m_q + m_dot + z_alpha / v) / (2.0 * omega);
        double found = hypot(modes.short_period.rate, 2.0 * GEODESY_PI / modes.short_period.period_s);
        print_message("%s: short period %.3f rad/s, by approximation %.3f; damping %.3f and %.3f\n", a.id, found, omega,
                      modes.short_period.damping, damping);
        expect_near("short period, frequency", found, omega, 0.06);
        expect_near("short period, damping", modes.short_period.damping, damping, 0.06);
        // pi sqrt(2) V / g at one density and a fixed angle of attack; the thinner air above makes it faster, and
        // that the nose follows the path slower, by the static margin over the manoeuvre margin.
        double slower = omega * omega / -(arm * a.cm_alpha), scale_m = 9500.0;
        double lanchester = GEODESY_PI * sqrt(2.0) * v / GRAVITY * sqrt(slower);
        lanchester /= sqrt(1.0 + v * v / (2.0 * GRAVITY * scale_m));
        print_message("%s: phugoid %.2f s, by approximation %.2f s\n", a.id, modes.phugoid.period_s, lanchester);
        expect_near("phugoid, period", modes.phugoid.period_s, lanchester, 0.1);
        double roll = -1.0 / (pressure * a.area * a.span * a.span * a.cr_p / (2.0 * v * a.ixx));
        expect_near("roll, time constant", -1.0 / modes.roll.rate, roll, 0.12);
    }
}

static const PerformanceRow *row_named(const Performance *performance, const char *name) {
    for (int i = 0; i < performance->count; i++)
        if (strcmp(performance->rows[i].name, name) == 0)
            return &performance->rows[i];
    fail_msg("no row '%s'", name);
    return NULL;
}

// The table of docs/aircraft.md, and the 10 % that are promised.
static void simulated_modes_are_those_of_theory(void **state) {
    (void)state;
    static const char *const names[] = {"phugoid, period",       "phugoid, damping",   "short period, period",
                                        "short period, damping", "Dutch roll, period", "Dutch roll, damping"};
    for (size_t i = 0; i < COUNT_OF(flight_types); i++) {
        Aircraft a = flight_type(flight_types[i]);
        Performance performance;
        assert_int_equal(performance_measure(&a, &performance), RESULT_OK);
        for (size_t k = 0; k < COUNT_OF(names); k++) {
            const PerformanceRow *row = row_named(&performance, names[k]);
            print_message("%s: %s: theory %.4f, simulation %.4f\n", a.id, row->name, row->theory, row->simulation);
            expect_near(row->name, row->simulation, row->theory, 0.1);
        }
    }
}

static void performance_is_as_published(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(flight_types); i++) {
        Aircraft a = flight_type(flight_types[i]);
        Performance performance;
        assert_int_equal(performance_measure(&a, &performance), RESULT_OK);
        int compared = 0;
        for (int k = 0; k < performance.count; k++) {
            const PerformanceRow *row = &performance.rows[k];
            if (isnan(row->published))
                continue;
            print_message("%s: %s: theory %.3f, simulation %.3f, published %.3f\n", a.id, row->name, row->theory,
                          row->simulation, row->published);
            bool speed_of_best = strstr(row->name, "speed of") != NULL; // flat optima
            expect_near(row->name, row->simulation, row->published, speed_of_best ? 0.15 : 0.05);
            expect_near(row->name, row->theory, row->published, speed_of_best ? 0.15 : 0.07);
            compared++;
        }
        assert_true(compared >= 2);
    }
}

// From off height, heading and speed to all three, and it stays there.
static void the_autopilot_holds_height_heading_and_speed(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(flight_types); i++) {
        Aircraft a = flight_type(flight_types[i]);
        bool glider = a.engine == AIRCRAFT_GLIDER;
        Flight flight = flight_in_air(&a, 2000.0, a.cruise_speed);
        Autopilot autopilot = {.engaged = false};
        AutopilotWish wish = {.height_m = 2100.0, .heading_rad = 2.0, .speed_m_s = a.cruise_speed * 1.05};
        double off_h = 0.0, off_heading = 0.0, off_speed = 0.0, load = 0.0;
        for (int k = 0; k < 120 * 400; k++) {
            Controls controls = autopilot_hold(&autopilot, &flight, &wish, FLIGHT_STEP_S);
            flight_step(&flight, &controls, FLIGHT_STEP_S);
            FlightInstruments now = flight_instruments(&flight);
            load = fmax(load, fabs(now.load_factor - 1.0));
            if (k < 120 * 300)
                continue;
            off_h = fmax(off_h, fabs(now.h_m - wish.height_m));
            off_heading = fmax(off_heading, fabs(remainder(now.track_rad - wish.heading_rad, 2.0 * GEODESY_PI)));
            off_speed = fmax(off_speed, fabs(now.true_airspeed - wish.speed_m_s));
        }
        print_message("%s: %.2f m, %.5f rad and %.3f m/s off at most from 300 s on; load within %.2f of 1\n", a.id,
                      glider ? NAN : off_h, off_heading, off_speed, load);
        assert_true((glider || off_h < 3.0) && off_heading < 0.005 && off_speed < 0.3 && load < 1.5);
    }
}

// Keys to the stops, let go: the path and the bank stay.
static void the_help_for_keys_holds_what_is_let_go(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(flight_types); i++) {
        Aircraft a = flight_type(flight_types[i]);
        Flight flight = flight_in_air(&a, 2000.0, 1.1 * a.cruise_speed);
        Autopilot help = {.engaged = false};
        Controls pilot = flight.controls;
        pilot.throttle = 1.0;
        FlightInstruments let_go = {.h_m = 0.0}, now = let_go;
        for (int k = 0; k < 120 * 12; k++) {
            pilot.aileron = k < 60 ? 1.0 : 0.0;
            pilot.elevator = k < 60 ? -0.2 : 0.0;
            Controls controls = autopilot_assist(&help, &flight, &pilot, FLIGHT_STEP_S);
            flight_step(&flight, &controls, FLIGHT_STEP_S);
            now = flight_instruments(&flight);
            let_go = k == 120 * 2 ? now : let_go;
        }
        print_message("%s: let go with bank %.3f path %.3f; 10 s later %.3f and %.3f\n", a.id, let_go.bank_rad,
                      let_go.path_rad, now.bank_rad, now.path_rad);
        assert_true(let_go.bank_rad > 0.1 && fabs(now.bank_rad - let_go.bank_rad) < 0.05);
        assert_true(fabs(now.path_rad - let_go.path_rad) < 0.05);
    }
}

// Engine idle, stick full back whenever the aircraft sinks: it mushes down, and does not stall.
static void the_help_for_keys_keeps_from_the_stall(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(flight_types); i++) {
        Aircraft a = flight_type(flight_types[i]);
        Flight flight = flight_in_air(&a, 2500.0, a.cruise_speed);
        Autopilot help = {.engaged = false};
        double most = 0.0;
        for (int k = 0; k < 120 * 60; k++) {
            Controls pilot = {.elevator = flight_instruments(&flight).vertical_speed_m_s < 0.0 ? 1.0 : 0.0};
            Controls controls = autopilot_assist(&help, &flight, &pilot, FLIGHT_STEP_S);
            flight_step(&flight, &controls, FLIGHT_STEP_S);
            most = fmax(most, airframe_stalled(&a, flight_instruments(&flight).alpha_rad, 0.0));
        }
        print_message("%s: stick back when sinking, 60 s: at most %.3f of the flow separated\n", a.id, most);
        assert_true(most < 0.5);
    }
}

// Nobody touches anything, engine idle: a glide at a speed with some to spare.
static void hands_off_at_idle_the_help_glides(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(flight_types); i++) {
        Aircraft a = flight_type(flight_types[i]);
        Flight flight = flight_in_air(&a, 3500.0, a.cruise_speed);
        Autopilot help = {.engaged = false};
        double most = 0.0, slowest = INFINITY;
        for (int k = 0; k < 120 * 60; k++) {
            Controls controls = autopilot_assist(&help, &flight, &(Controls){.throttle = 0.0}, FLIGHT_STEP_S);
            flight_step(&flight, &controls, FLIGHT_STEP_S);
            FlightInstruments now = flight_instruments(&flight);
            double stall_speed = airframe_stall_speed(&a, isa_at(now.h_m).density, 0.0);
            most = fmax(most, now.alpha_rad / a.stall_rad);
            slowest = fmin(slowest, now.true_airspeed / stall_speed);
        }
        print_message("%s: hands off, 60 s: at most %.3f of the stall's angle, at least %.3f of its speed\n", a.id,
                      most, slowest);
        assert_true(most < 0.85 && slowest > 1.15);
    }
}

static FlightInstruments keyed(Autopilot *help, Flight *flight, Controls pilot, double seconds, double *least_load) {
    for (int k = 0; k < (int)(seconds * 120.0); k++) {
        Controls controls = autopilot_assist(help, flight, &pilot, FLIGHT_STEP_S);
        flight_step(flight, &controls, FLIGHT_STEP_S);
        *least_load = fmin(*least_load, flight_instruments(flight).load_factor);
    }
    return flight_instruments(flight);
}

static void the_help_for_keys_pushes_little_and_holds_no_steep_bank(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT_OF(flight_types); i++) {
        Aircraft a = flight_type(flight_types[i]);
        Flight flight = flight_in_air(&a, 3500.0, a.cruise_speed);
        Autopilot help = {.engaged = false};
        double pushed = INFINITY, other = 0.0, throttle = flight.controls.throttle;
        keyed(&help, &flight, (Controls){.throttle = throttle, .elevator = -1.0}, 1.0, &pushed);
        flight = flight_in_air(&a, 3500.0, a.cruise_speed);
        help = (Autopilot){.engaged = false};
        FlightInstruments steep = {.bank_rad = 0.0};
        for (int k = 0; k < 60 && steep.bank_rad < 1.35; k++)
            steep = keyed(&help, &flight, (Controls){.throttle = throttle, .aileron = 1.0}, 0.1, &other);
        FlightInstruments held = keyed(&help, &flight, (Controls){.throttle = throttle}, 6.0, &other);
        print_message("%s: pushed to %.2f g; bank %.2f rad let go, %.2f held\n", a.id, pushed, steep.bank_rad,
                      held.bank_rad);
        assert_true(pushed > -0.5 && pushed < 0.2);
        assert_true(steep.bank_rad > 1.3 && held.bank_rad > 0.9 && held.bank_rad < 1.1);
    }
}

int main(void) {
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_atmosphere_is_that_of_the_tables),
        cmocka_unit_test(the_atmosphere_has_no_steps_and_no_end),
        cmocka_unit_test(derivatives_come_back_from_forces),
        cmocka_unit_test(lift_peaks_where_the_file_says_and_is_smooth_all_round),
        cmocka_unit_test(air_forces_take_energy_at_every_angle),
        cmocka_unit_test(induced_drag_falls_near_the_ground),
        cmocka_unit_test(the_propeller_turns_and_pulls_as_published),
        cmocka_unit_test(the_c172_climbs_as_lowrys),
        cmocka_unit_test(trim_leaves_nothing_over),
        cmocka_unit_test(impossible_flights_are_refused),
        cmocka_unit_test(eigenvalues_are_found),
        cmocka_unit_test(the_linearised_model_is_the_textbooks),
        cmocka_unit_test(simulated_modes_are_those_of_theory),
        cmocka_unit_test(performance_is_as_published),
        cmocka_unit_test(the_autopilot_holds_height_heading_and_speed),
        cmocka_unit_test(the_help_for_keys_holds_what_is_let_go),
        cmocka_unit_test(the_help_for_keys_keeps_from_the_stall),
        cmocka_unit_test(hands_off_at_idle_the_help_glides),
        cmocka_unit_test(the_help_for_keys_pushes_little_and_holds_no_steep_bank),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
