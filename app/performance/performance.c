#include "app/performance/performance.h"

#include "app/aircraft/airframe.h"
#include "app/aircraft/isa.h"
#include "app/aircraft/trim.h"
#include "terrain/geodesy.h"

#include <math.h>

#define KNOT (1852.0 / 3600.0)
#define STALL_FROM 1.25 // times the stall speed
#define SCAN 200        // speeds between the stall and the never-exceed speed
#define CLIMB_S 20.0
#define GLIDE_S 60.0
#define LATITUDE 0.785 // of the flights: 45 degrees

static bool no_ground(void *user, double lat_rad, double lon_rad, double *h_m) {
    (void)user;
    (void)lat_rad;
    (void)lon_rad;
    *h_m = 0.0;
    return false;
}

static Flight start_trimmed(const Aircraft *aircraft, double h_m, double speed) {
    FlightStart start = {.lat_rad = LATITUDE, .h_m = h_m, .speed_m_s = speed};
    return flight_create(aircraft, &start, (FlightGround){no_ground, NULL});
}

// A flight as the trim has it, with its path; flaps and gear as the wish has them.
static Flight start_as(const Aircraft *aircraft, const TrimWish *wish, const Trim *trim) {
    FlightStart start = {.lat_rad = LATITUDE, .h_m = wish->h_m, .speed_m_s = wish->speed_m_s, .untrimmed = true};
    Flight flight = flight_create(aircraft, &start, (FlightGround){no_ground, NULL});
    FlightState *s = &flight.state;
    Quatd path = flight_attitude(LATITUDE, 0.0, 0.0, trim->path_rad, 0.0);
    s->velocity_ecef = vec3d_scale(quatd_rotate(path, vec3d(1, 0, 0)), wish->speed_m_s);
    s->ecef_from_body = flight_attitude(LATITUDE, 0.0, 0.0, trim->path_rad + trim->alpha_rad, 0.0);
    s->rate_body.y = -wish->speed_m_s * cos(trim->path_rad) / (GEODESY_A_M + wish->h_m);
    s->throttle = trim->throttle;
    s->engine = trim->engine;
    s->elevator = trim->elevator;
    s->flaps = wish->flaps;
    s->gear = wish->gear;
    flight.controls = (Controls){
        .trim = trim->elevator, .throttle = trim->throttle, .flaps = wish->flaps, .gear_up = wish->gear == 0.0};
    flight.trimmed = true;
    return flight;
}

static double clean_gear(const Aircraft *aircraft) {
    return aircraft->gear_s > 0.0 ? 0.0 : 1.0;
}

// ---- stall ------------------------------------------------------------------------------------------------------

static TrimWish slow_wish(const Aircraft *aircraft, double flaps, double factor) {
    return (TrimWish){.speed_m_s = factor * airframe_stall_speed(aircraft, ISA_DENSITY_0, flaps),
                      .throttle_given = true,
                      .flaps = flaps,
                      .gear = 1.0};
}

// The slowest steady flight: the wing's greatest lift, less what the elevator takes away.
static double slowest_steady(const Aircraft *aircraft, double flaps) {
    double low = 0.8, high = 1.4;
    for (int i = 0; i < 40; i++) {
        TrimWish wish = slow_wish(aircraft, flaps, 0.5 * (low + high));
        Trim trim;
        if (trim_solve(aircraft, &wish, &trim) == RESULT_OK)
            high = 0.5 * (low + high);
        else
            low = 0.5 * (low + high);
    }
    return slow_wish(aircraft, flaps, high).speed_m_s;
}

static bool is_past_greatest_lift(const Aircraft *aircraft, double alpha, double flaps) {
    return alpha > 0.0 &&
           airframe_wing_lift(aircraft, alpha + 1e-4, flaps) < airframe_wing_lift(aircraft, alpha, flaps);
}

// The angle of attack that slows down by a knot a second: speed by path, path by load, load by angle.
static double slowing_alpha(const Flight *flight, const FlightInstruments *now, double wanted_speed) {
    const Aircraft *a = flight->aircraft;
    double pressure = 0.5 * ISA_DENSITY_0 * now->calibrated_airspeed * now->calibrated_airspeed * a->area;
    double weight = a->mass * TRIM_GRAVITY_0, lift = weight / pressure;
    double drag = pressure * (a->cd_0 + a->induced * lift * lift + a->cd_flaps * flight->state.flaps + a->cd_gear);
    double path = (KNOT - drag / a->mass) / TRIM_GRAVITY_0 + 0.03 * (now->calibrated_airspeed - wanted_speed);
    double load = 1.0 + now->true_airspeed * 0.8 * (path - now->path_rad) / TRIM_GRAVITY_0;
    return (load * lift - a->cl_0 - a->cl_flaps * flight->state.flaps) / a->cl_alpha;
}

double performance_stall(const Aircraft *aircraft, double flaps) {
    TrimWish wish = slow_wish(aircraft, flaps, STALL_FROM);
    Trim trim;
    if (trim_solve(aircraft, &wish, &trim) != RESULT_OK)
        return NAN;
    Flight flight = start_as(aircraft, &wish, &trim);
    FlightInstruments now = flight_instruments(&flight);
    double wanted = now.calibrated_airspeed, elevator = trim.elevator;
    for (int i = 0; i < 120 * 60 && !is_past_greatest_lift(aircraft, now.alpha_rad, flaps); i++) {
        wanted -= KNOT * FLIGHT_STEP_S;
        double off = slowing_alpha(&flight, &now, wanted) - now.alpha_rad;
        elevator = fmin(elevator + 3.0 * off * FLIGHT_STEP_S, 1.0);
        flight.controls.trim = elevator + 2.0 * off - flight.state.rate_body.y;
        flight_step(&flight, &flight.controls, FLIGHT_STEP_S);
        now = flight_instruments(&flight);
    }
    return is_past_greatest_lift(aircraft, now.alpha_rad, flaps) ? now.calibrated_airspeed : NAN;
}

// ---- climb and glide --------------------------------------------------------------------------------------------

// The best of steady flights at a throttle: of climb rate, or of the glide's ratio.
typedef struct Best {
    double speed, value;
    Trim trim;
    TrimWish wish;
} Best;

static Best best_flight(const Aircraft *aircraft, double throttle, bool glide) {
    double slow = airframe_stall_speed(aircraft, ISA_DENSITY_0, 0.0);
    Best best = {.value = -INFINITY};
    for (int i = 1; i < SCAN; i++) {
        TrimWish wish = {.speed_m_s = slow + (aircraft->never_exceed_speed - slow) * i / SCAN,
                         .throttle_given = true,
                         .throttle = throttle,
                         .gear = clean_gear(aircraft)};
        Trim trim;
        if (trim_solve(aircraft, &wish, &trim) != RESULT_OK)
            continue;
        double value = glide ? -1.0 / tan(trim.path_rad) : wish.speed_m_s * sin(trim.path_rad);
        if (value > best.value && (!glide || trim.path_rad < 0.0))
            best = (Best){wish.speed_m_s, value, trim, wish};
    }
    return best;
}

static double flown_climb(const Aircraft *aircraft, const Best *best) {
    TrimWish wish = best->wish;
    wish.h_m = -0.5 * CLIMB_S * best->value; // so that the middle is at sea level
    Flight flight = start_as(aircraft, &wish, &best->trim);
    for (int i = 0; i < (int)(CLIMB_S / FLIGHT_STEP_S); i++)
        flight_step(&flight, &flight.controls, FLIGHT_STEP_S);
    return (flight_instruments(&flight).h_m - wish.h_m) / CLIMB_S;
}

static double flown_glide(const Aircraft *aircraft, const Best *best) {
    Flight flight = start_as(aircraft, &best->wish, &best->trim);
    Vec3d from = flight.state.position_ecef;
    for (int i = 0; i < (int)(GLIDE_S / FLIGHT_STEP_S); i++)
        flight_step(&flight, &flight.controls, FLIGHT_STEP_S);
    double lost_m = best->wish.h_m - flight_instruments(&flight).h_m;
    double way_m = vec3d_distance(flight.state.position_ecef, from);
    return sqrt(fmax(way_m * way_m - lost_m * lost_m, 0.0)) / lost_m;
}

// ---- the table --------------------------------------------------------------------------------------------------

static void add(Performance *out, PerformanceRow row) {
    if (out->count < PERFORMANCE_ROWS)
        out->rows[out->count++] = row;
}

static void add_mode(Performance *out, const char *period, const char *damping, const Mode *theory, const Mode *flown) {
    double there = theory->there ? 1.0 : NAN, flies = flown->there ? 1.0 : NAN;
    add(out, (PerformanceRow){period, "s", there * theory->period_s, flies * flown->period_s, NAN, "eigenvalues"});
    add(out, (PerformanceRow){damping, "", there * theory->damping, flies * flown->damping, NAN, "eigenvalues"});
}

static Result add_modes(const Aircraft *aircraft, Performance *out) {
    Flight flight = start_trimmed(aircraft, PERFORMANCE_HEIGHT_M, aircraft->cruise_speed);
    if (!flight.trimmed)
        return RESULT_RANGE;
    Modes theory = modes_of_theory(&flight), flown = modes_of_flight(&flight, &theory);
    out->modes_speed = aircraft->cruise_speed;
    add_mode(out, "phugoid, period", "phugoid, damping", &theory.phugoid, &flown.phugoid);
    add_mode(out, "short period, period", "short period, damping", &theory.short_period, &flown.short_period);
    add_mode(out, "Dutch roll, period", "Dutch roll, damping", &theory.dutch_roll, &flown.dutch_roll);
    double spiral = theory.spiral.there ? theory.spiral.rate : NAN, roll = theory.roll.there ? theory.roll.rate : NAN;
    add(out, (PerformanceRow){"roll, time constant", "s", -1.0 / roll, NAN, NAN, "eigenvalues"});
    add(out, (PerformanceRow){spiral > 0.0 ? "spiral, doubles in" : "spiral, halves in", "s", log(2.0) / fabs(spiral),
                              NAN, NAN, "eigenvalues"});
    return RESULT_OK;
}

static void add_stalls(const Aircraft *a, Performance *out) {
    add(out, (PerformanceRow){"stall, clean", "m/s", slowest_steady(a, 0.0), performance_stall(a, 0.0),
                              a->published.stall_clean, "steady flight"});
    if (a->flaps_s > 0.0 && a->cl_max_flaps > a->cl_max)
        add(out, (PerformanceRow){"stall, flaps", "m/s", slowest_steady(a, 1.0), performance_stall(a, 1.0),
                                  a->published.stall_flaps, "steady flight"});
}

static void add_climb(const Aircraft *a, Performance *out) {
    Best climb = best_flight(a, 1.0, false);
    if (a->engine == AIRCRAFT_GLIDER || !(climb.value > 0.0))
        return;
    add(out, (PerformanceRow){"best climb", "m/s", climb.value, flown_climb(a, &climb), a->published.climb_rate,
                              "steady flight"});
    add(out, (PerformanceRow){"  at a speed of", "m/s", climb.speed, climb.speed, a->published.climb_speed,
                              "steady flight"});
}

static void add_glide(const Aircraft *a, Performance *out) {
    Best glide = best_flight(a, 0.0, true);
    if (!(glide.value > 0.0))
        return;
    add(out, (PerformanceRow){"best glide, ratio", "", glide.value, flown_glide(a, &glide), a->published.glide_ratio,
                              "steady flight"});
    add(out, (PerformanceRow){"  at a speed of", "m/s", glide.speed, glide.speed, a->published.glide_speed,
                              "steady flight"});
}

Result performance_measure(const Aircraft *aircraft, Performance *out) {
    *out = (Performance){.count = 0};
    Result result = add_modes(aircraft, out);
    if (result != RESULT_OK)
        return result;
    add_stalls(aircraft, out);
    add_climb(aircraft, out);
    add_glide(aircraft, out);
    return RESULT_OK;
}
