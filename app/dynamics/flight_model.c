#include "app/dynamics/flight_model.h"

#include "app/aircraft/airframe.h"
#include "app/aircraft/isa.h"
#include "app/aircraft/trim.h"
#include "app/dynamics/flight_contact.h"
#include "terrain/geodesy.h"

#include <math.h>

#define START_CLEARANCE_M 60.0
#define RESET_CLEARANCE_M 300.0
#define SETTLE_S 4.0         // on the wheels before a start on the ground
#define STIFF_STEP 0.8       // of the Runge-Kutta scheme's stability, 2.78 along both axes
#define PARTS_MAX 256        // of a step
#define FLOW_LEAST 3.0       // m/s of air, below which it has no direction that means anything
#define GROUND_PART_S 0.0021 // creeping friction is stiff

static double clamp(double value, double least, double greatest) {
    return fmin(fmax(value, least), greatest);
}

Quatd flight_attitude(double lat_rad, double lon_rad, double heading_rad, double pitch_rad, double bank_rad) {
    // ECEF from east-north-up, then north-east-down to body by heading, pitch, bank.
    Quatd lon = quatd_from_axis_angle(vec3d(0, 0, 1), lon_rad);
    Quatd lat = quatd_from_axis_angle(vec3d(0, 1, 0), -lat_rad - GEODESY_PI / 2.0);
    Quatd yaw = quatd_from_axis_angle(vec3d(0, 0, 1), heading_rad);
    Quatd pitch = quatd_from_axis_angle(vec3d(0, 1, 0), pitch_rad);
    Quatd roll = quatd_from_axis_angle(vec3d(1, 0, 0), bank_rad);
    return quatd_normalize(quatd_mul(quatd_mul(quatd_mul(quatd_mul(lon, lat), yaw), pitch), roll));
}

static Quatd quatd_mad(Quatd a, Quatd b, double s) { // a + b s
    return (Quatd){a.w + b.w * s, a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}

// ---- one step ---------------------------------------------------------------------------------------------------

// `state` moved along `motion` for `dt_s`. Not normalised: the stages of an integration need the plain sum.
static FlightState moved(const FlightState *state, const FlightMotion *motion, double dt_s) {
    FlightState next = *state;
    next.position_ecef = vec3d_mad(state->position_ecef, motion->velocity, dt_s);
    next.velocity_ecef = vec3d_mad(state->velocity_ecef, motion->acceleration, dt_s);
    next.rate_body = vec3d_mad(state->rate_body, motion->rate_change_body, dt_s);
    next.ecef_from_body = quatd_mad(state->ecef_from_body, motion->attitude_change, dt_s);
    next.engine = state->engine + motion->engine_rate * dt_s;
    return next;
}

static FlightMotion summed(const FlightMotion *a, const FlightMotion *b, double s) { // a + b s
    FlightMotion sum = *a;
    sum.velocity = vec3d_mad(a->velocity, b->velocity, s);
    sum.acceleration = vec3d_mad(a->acceleration, b->acceleration, s);
    sum.attitude_change = quatd_mad(a->attitude_change, b->attitude_change, s);
    sum.rate_change_body = vec3d_mad(a->rate_change_body, b->rate_change_body, s);
    sum.engine_rate = a->engine_rate + b->engine_rate * s;
    sum.wheels |= b->wheels;
    sum.sink_m_s = fmax(a->sink_m_s, b->sink_m_s);
    return sum;
}

// The classical Runge-Kutta step of fourth order; `sum`: its mean motion.
static FlightState integrate(const Flight *flight, const FlightStepSetting *setting, double dt_s, FlightMotion *sum) {
    const FlightState *state = &flight->state;
    FlightMotion k1 = flight_motion(flight, state, setting);
    FlightState stage = moved(state, &k1, 0.5 * dt_s);
    FlightMotion k2 = flight_motion(flight, &stage, setting);
    stage = moved(state, &k2, 0.5 * dt_s);
    FlightMotion k3 = flight_motion(flight, &stage, setting);
    stage = moved(state, &k3, dt_s);
    FlightMotion k4 = flight_motion(flight, &stage, setting);
    *sum = summed(&k1, &k2, 2.0);
    *sum = summed(sum, &k3, 2.0);
    *sum = summed(sum, &k4, 1.0);
    FlightState next = moved(state, sum, dt_s / 6.0);
    next.ecef_from_body = quatd_normalize(next.ecef_from_body);
    return next;
}

// Moves towards `wanted` at a pace of the whole way in `whole_s`; at once where that is 0.
static double approach(double value, double wanted, double whole_s, double dt_s) {
    double most = whole_s > 0.0 ? dt_s / whole_s : 1.0;
    return value + clamp(wanted - value, -most, most);
}

static void move_controls(const Aircraft *a, FlightState *state, const Controls *controls, double dt_s) {
    state->throttle = a->engine == AIRCRAFT_GLIDER ? 0.0 : clamp(controls->throttle, 0.0, 1.0);
    state->elevator = clamp(controls->elevator + controls->trim, -1.0, 1.0);
    state->aileron = clamp(controls->aileron, -1.0, 1.0);
    state->rudder = clamp(controls->rudder, -1.0, 1.0);
    if (a->flaps_s > 0.0)
        state->flaps = approach(state->flaps, clamp(controls->flaps, 0.0, 1.0), a->flaps_s, dt_s);
    bool up = controls->gear_up && a->gear_s > 0.0 && state->wheels == 0;
    state->gear = approach(state->gear, up ? 0.0 : 1.0, a->gear_s, dt_s);
}

static int parts_of(const Flight *flight, const FlightStepSetting *setting, double dt_s) {
    double parts = ceil(flight_stiffness(flight, setting) * dt_s / STIFF_STEP);
    if (setting->plane_count > 0)
        parts = fmax(parts, ceil(dt_s / GROUND_PART_S));
    return (int)clamp(parts, 1.0, PARTS_MAX);
}

static void advance(Flight *flight, const Controls *controls, double dt_s) {
    FlightStepSetting setting = flight_look_at_ground(flight, controls);
    int parts = parts_of(flight, &setting, dt_s);
    FlightMotion motion = {.wheels = 0};
    uint8_t wheels = 0;
    double sink_m_s = 0.0;
    for (int i = 0; i < parts; i++) {
        flight->state = integrate(flight, &setting, dt_s / parts, &motion);
        wheels = motion.wheels;
        sink_m_s = fmax(sink_m_s, motion.sink_m_s);
    }
    flight_touch_ground(flight, &setting, wheels, sink_m_s);
}

static void begin_anew(Flight *flight);

void flight_step(Flight *flight, const Controls *controls, double dt_s) {
    FlightState *state = &flight->state;
    state->step++;
    if (state->contact == FLIGHT_CRASHED) {
        state->crashed_s += dt_s;
        if (state->crashed_s >= FLIGHT_RESET_S)
            begin_anew(flight);
        return;
    }
    move_controls(flight->aircraft, state, controls, dt_s);
    advance(flight, controls, dt_s);
}

// ---- starts -----------------------------------------------------------------------------------------------------

static double height_above_ground(const FlightGround *ground, double lat_rad, double lon_rad, double h_m) {
    double ground_m;
    return ground->height && ground->height(ground->user, lat_rad, lon_rad, &ground_m) ? h_m - ground_m : INFINITY;
}

// Retractable gear is up in flight.
static double start_gear(const Aircraft *aircraft) {
    return aircraft->gear_s > 0.0 ? 0.0 : 1.0;
}

// A turn that the engine cannot keep at its height: with all of it, the path sinks.
static bool find_sinking_turn(const Aircraft *aircraft, const FlightStart *start, TrimWish wish, Trim *out) {
    wish.throttle_given = true;
    wish.throttle = 1.0;
    return trim_solve(aircraft, &wish, out) == RESULT_OK && out->path_rad <= start->pitch_rad;
}

// Steady flight along the path, else level, else at idle: what the aircraft can.
static bool find_trim(const Aircraft *aircraft, const FlightStart *start, double h_m, Trim *out) {
    TrimWish wish = {.speed_m_s = start->speed_m_s,
                     .h_m = h_m,
                     .path_rad = start->pitch_rad,
                     .throttle_given = aircraft->engine == AIRCRAFT_GLIDER,
                     .gear = start_gear(aircraft),
                     .bank_rad = start->bank_rad};
    if (trim_solve(aircraft, &wish, out) == RESULT_OK)
        return true;
    if (start->bank_rad != 0.0)
        return find_sinking_turn(aircraft, start, wish, out);
    wish.path_rad = 0.0;
    bool level = trim_solve(aircraft, &wish, out) == RESULT_OK;
    out->path_rad = start->pitch_rad;
    return level && fabs(start->pitch_rad) < 1e-9;
}

// Without a steady flight: the wing carries what it can, half throttle.
static Trim guess_trim(const Aircraft *a, const FlightStart *start, double h_m) {
    double pressure = 0.5 * isa_at(h_m).density * fmax(start->speed_m_s * start->speed_m_s, 1.0);
    double load = 1.0 / cos(clamp(start->bank_rad, -TRIM_BANK_MOST, TRIM_BANK_MOST));
    double alpha = (load * a->mass * trim_gravity(h_m) / (pressure * a->area) - a->cl_0) / a->cl_alpha;
    double throttle = a->engine == AIRCRAFT_GLIDER ? 0.0 : 0.5;
    return (Trim){.alpha_rad = clamp(alpha, -0.5 * a->stall_below_rad, 0.8 * a->stall_rad),
                  .path_rad = start->pitch_rad,
                  .throttle = throttle,
                  .engine = throttle};
}

// A turn leads the path off the heading, by the share of the angle of attack that lies to the side.
static void take_motion(FlightState *state, const FlightStart *start, double h_m, const Trim *trim, bool trimmed) {
    const TrimWish wish = {.speed_m_s = start->speed_m_s, .h_m = h_m, .bank_rad = start->bank_rad};
    TrimTurn turn = trim_turn(&wish, trim->alpha_rad, trim->path_rad);
    double lat = start->lat_rad, lon = start->lon_rad, heading = start->heading_rad;
    Quatd path = flight_attitude(lat, lon, heading, trim->path_rad, 0.0);
    Vec3d ahead = vec3d(1, 0, 0);
    state->ecef_from_body = flight_attitude(lat, lon, heading, turn.pitch_rad, start->bank_rad);
    if (start->bank_rad != 0.0) {
        path = state->ecef_from_body;
        ahead = vec3d(cos(trim->alpha_rad), 0.0, sin(trim->alpha_rad));
    }
    state->velocity_ecef = vec3d_scale(quatd_rotate(path, ahead), start->speed_m_s);
    double curve = start->speed_m_s * cos(trim->path_rad) / (GEODESY_A_M + h_m); // of the Earth
    if (!trimmed)
        return;
    state->rate_body = turn.rate_body;
    state->rate_body.y -= curve * cos(start->bank_rad);
}

static void take_state(Flight *flight, const FlightStart *start, double h_m, const Trim *trim) {
    FlightState *state = &flight->state;
    state->position_ecef = geodesy_to_ecef((Geodetic){start->lat_rad, start->lon_rad, h_m});
    take_motion(state, start, h_m, trim, flight->trimmed);
    state->throttle = trim->throttle;
    state->engine = trim->engine;
    state->elevator = trim->elevator;
    state->gear = start_gear(flight->aircraft);
    flight->controls = (Controls){.trim = trim->elevator, .throttle = trim->throttle, .gear_up = state->gear == 0.0};
}

static void start_in_flight(Flight *flight, const FlightStart *start) {
    double above_m = height_above_ground(&flight->ground, start->lat_rad, start->lon_rad, start->h_m);
    double h_m = start->h_m + fmax(START_CLEARANCE_M - above_m, 0.0);
    Trim trim = guess_trim(flight->aircraft, start, h_m), found;
    if (!start->untrimmed) {
        flight->trimmed = find_trim(flight->aircraft, start, h_m, &found);
        if (flight->trimmed)
            trim = found;
    }
    take_state(flight, start, h_m, &trim);
}

// The smallest turn that brings one unit vector to another, not opposite, one.
static Quatd turn_between(Vec3d from, Vec3d to) {
    Vec3d axis = vec3d_cross(from, to);
    return quatd_normalize((Quatd){1.0 + vec3d_dot(from, to), axis.x, axis.y, axis.z});
}

// With its wheels on the plane below.
static void put_down(FlightState *state, const Aircraft *a, Vec3d up, Vec3d point, Vec3d normal) {
    double lowest = 0.0;
    for (int i = 0; i < a->leg_count; i++)
        lowest = fmax(lowest, a->legs[i].z);
    state->ecef_from_body = quatd_normalize(quatd_mul(turn_between(up, normal), state->ecef_from_body));
    state->position_ecef = vec3d_mad(point, normal, lowest);
    state->gear = 1.0;
}

// Put down, and left alone with its brakes until it has settled.
static bool start_on_ground(Flight *flight, const FlightStart *start) {
    FlightStart standing = *start;
    Trim still = {.alpha_rad = 0.0};
    Vec3d point, normal, up = geodesy_up(start->lat_rad, start->lon_rad);
    standing.speed_m_s = standing.pitch_rad = 0.0;
    take_state(flight, &standing, start->h_m, &still);
    if (!flight_ground_plane(&flight->ground, flight->state.position_ecef, &point, &normal))
        return false;
    put_down(&flight->state, flight->aircraft, up, point, normal);
    flight->controls = (Controls){.throttle = 0.0};
    Controls braked = {.brake_left = 1.0, .brake_right = 1.0};
    for (int i = 0; i < (int)(SETTLE_S / FLIGHT_STEP_S) && flight->state.contact != FLIGHT_CRASHED; i++)
        flight_step(flight, &braked, FLIGHT_STEP_S);
    bool stands = flight->state.contact == FLIGHT_ROLLING;
    flight->state.velocity_ecef = flight->state.rate_body = vec3d(0.0, 0.0, 0.0);
    flight->state.step = 0;
    return stands;
}

Flight flight_create(const Aircraft *aircraft, const FlightStart *start, FlightGround ground) {
    Flight flight = {.aircraft = aircraft, .ground = ground};
    if (start->on_ground && start_on_ground(&flight, start))
        return flight;
    flight = (Flight){.aircraft = aircraft, .ground = ground};
    start_in_flight(&flight, start);
    return flight;
}

static void begin_anew(Flight *flight) {
    FlightInstruments now = flight_instruments(flight);
    FlightStart start = {.lat_rad = now.lat_rad,
                         .lon_rad = now.lon_rad,
                         .h_m = fmax(now.h_m, 0.0) + RESET_CLEARANCE_M,
                         .heading_rad = now.heading_rad,
                         .speed_m_s = flight->aircraft->cruise_speed};
    int64_t step = flight->state.step;
    Vec3d wind = flight->wind_ecef;
    *flight = flight_create(flight->aircraft, &start, flight->ground);
    flight->state.step = step;
    flight->wind_ecef = wind;
}

// ---- instruments ------------------------------------------------------------------------------------------------

static double compass(double east, double north) {
    double angle = atan2(east, north);
    return angle < 0.0 ? angle + 2.0 * GEODESY_PI : angle;
}

static void add_air(const Flight *flight, FlightInstruments *out) {
    const FlightState *state = &flight->state;
    Vec3d air = vec3d_sub(state->velocity_ecef, flight->wind_ecef);
    Vec3d air_body = quatd_rotate(quatd_conjugate(state->ecef_from_body), air);
    out->true_airspeed = vec3d_length(air);
    if (out->true_airspeed > FLOW_LEAST)
        airframe_angles(air_body, &out->alpha_rad, &out->beta_rad);
    out->calibrated_airspeed = out->true_airspeed * sqrt(isa_at(out->h_m).density / ISA_DENSITY_0);
    FlightStepSetting setting =
        state->wheels ? flight_look_at_ground(flight, &flight->controls) : flight_setting(state);
    FlightMotion motion = flight_motion(flight, state, &setting);
    double carried = motion.air_force_body.z + motion.ground_force_body.z;
    out->load_factor = -carried / (flight->aircraft->mass * TRIM_GRAVITY_0);
}

FlightInstruments flight_instruments(const Flight *flight) {
    const FlightState *state = &flight->state;
    Geodetic place = geodesy_from_ecef(state->position_ecef);
    Mat3d enu = geodesy_enu_from_ecef(place.lat_rad, place.lon_rad);
    Vec3d ahead = mat3d_mul_vec(&enu, quatd_rotate(state->ecef_from_body, vec3d(1, 0, 0)));
    Vec3d wing = mat3d_mul_vec(&enu, quatd_rotate(state->ecef_from_body, vec3d(0, 1, 0)));
    Vec3d belly = mat3d_mul_vec(&enu, quatd_rotate(state->ecef_from_body, vec3d(0, 0, 1)));
    Vec3d velocity = mat3d_mul_vec(&enu, state->velocity_ecef);
    FlightInstruments out = {.lat_rad = place.lat_rad,
                             .lon_rad = place.lon_rad,
                             .h_m = place.h_m,
                             .heading_rad = compass(ahead.x, ahead.y),
                             .pitch_rad = asin(clamp(ahead.z, -1.0, 1.0)),
                             .bank_rad = atan2(-wing.z, -belly.z),
                             .speed_m_s = vec3d_length(state->velocity_ecef),
                             .vertical_speed_m_s = velocity.z};
    double level = hypot(velocity.x, velocity.y);
    out.path_rad = out.speed_m_s > 1.0 ? atan2(velocity.z, level) : 0.0;
    out.track_rad = level > 1.0 ? compass(velocity.x, velocity.y) : out.heading_rad;
    add_air(flight, &out);
    out.over_ground = flight_ground_below(&flight->ground, state->position_ecef, &out.above_ground_m);
    return out;
}
