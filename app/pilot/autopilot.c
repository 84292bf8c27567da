#include "app/pilot/autopilot.h"

#include "app/aircraft/airframe.h"
#include "app/aircraft/isa.h"
#include "app/aircraft/propulsion.h"
#include "terrain/geodesy.h"

#include <math.h>

#define GRAVITY AUTOPILOT_GRAVITY
#define BANK_MAX 0.6          // rad
#define WAYPOINT_BANK 0.75    // towards waypoints
#define TURN_SPEED_LEAST 1.15 // times the stall speed of a turn away from the ground
#define STALL_SHARE 0.8       // of the stall angle is as far as the laws go
#define ZOOM 0.02             // rad of path for each m/s to spare: 1 / (ZOOM GRAVITY) = AUTOPILOT_ZOOM_S
#define SPEED_LEAST 1.25      // times the stall speed, below which height is given for speed
#define LOAD_LEAST 0.2        // g
#define LOAD_MOST 2.5
#define LOOK_AHEAD_S 14.0 // the ground is watched so far ahead
#define LOOKS 8
#define REACH_S 3.0 // a waypoint counts as reached within this time of flight
#define REACH_MIN_M 250.0
#define MISSED 1.4 // rad off the nose: so near, it would be circled for ever

// Frequencies of the loops, 1/s; the inner ones below what short period and roll mode allow.
#define HEIGHT_RATE 0.2
#define PATH_RATE 0.8
#define PITCH_RATE 2.5
#define ALPHA_RATE 2.0
#define PITCH_INTEGRAL 2.0
#define HEADING_RATE 0.25
#define BANK_RATE 1.0
#define ROLL_RATE 4.0
#define SPEED_RATE 0.25
#define SPEED_INTEGRAL 0.05

static double clamp(double value, double least, double greatest) {
    return fmin(fmax(value, least), greatest);
}

static double angle_between(double wanted, double is) {
    return remainder(wanted - is, 2.0 * GEODESY_PI);
}

// What the aircraft does now, and how much its controls do.
typedef struct Now {
    FlightInstruments at;
    double speed;                           // true airspeed, at least 10 m/s
    double p, q, r;                         // rad/s
    double roll_each, pitch_each, yaw_each; // rad/s^2 of full controls
    double roll_damping;                    // 1/s, < 0
    double pitch_steady;                    // share of the elevator that a steady rad/s of pitch takes
    double yaw_stiffness;                   // rad/s^2 for each radian of sideslip
    double stall_speed, drag;               // of the flight as it is
    double full_thrust, thrust;             // N, with all of the throttle and with its present place
} Now;

// Of the flight as it is, in N, at a pressure of its flow, with a load of so many g.
static double drag_at(const Flight *flight, double pressure_n, double load) {
    const Aircraft *a = flight->aircraft;
    double lift = a->mass * GRAVITY * fmax(load, 0.0) / pressure_n;
    return pressure_n *
           (a->cd_0 + a->induced * lift * lift + a->cd_flaps * flight->state.flaps + a->cd_gear * flight->state.gear);
}

static Now look(const Flight *flight) {
    const Aircraft *a = flight->aircraft;
    Now now = {.at = flight_instruments(flight)};
    Isa air = isa_at(now.at.h_m);
    now.speed = fmax(now.at.true_airspeed, 10.0);
    double flow = 0.5 * air.density * now.speed * a->area, pressure = flow * now.speed;
    now.p = flight->state.rate_body.x;
    now.q = flight->state.rate_body.y;
    now.r = flight->state.rate_body.z;
    now.roll_each = pressure * a->span * a->cr_aileron * a->aileron_rad / a->ixx;
    now.pitch_each = pressure * a->chord * -a->cm_elevator * a->elevator_rad / a->iyy;
    now.yaw_each = pressure * a->span * -a->cn_rudder * a->rudder_rad / a->izz;
    now.roll_damping = 0.5 * flow * a->span * a->span * a->cr_p / a->ixx;
    // Against damping, and against the stability that the load's angle of attack calls forth.
    double angle = now.speed * a->mass / (pressure * a->cl_alpha);
    double moment = 0.5 * flow * a->chord * a->chord * a->cm_q + pressure * a->chord * a->cm_alpha * angle;
    now.pitch_steady = -moment / (a->iyy * fmax(now.pitch_each, 1.0));
    now.yaw_stiffness = pressure * a->span * a->cn_beta / a->izz;
    now.stall_speed = airframe_stall_speed(a, air.density, flight->state.flaps);
    double engine = propulsion_steady(a, &air, now.speed, 1.0);
    now.full_thrust = propulsion_at(a, &air, now.speed, engine, 1.0).thrust_n;
    now.thrust = propulsion_at(a, &air, now.speed, flight->state.engine, flight->state.throttle).thrust_n;
    now.drag = drag_at(flight, pressure, now.at.load_factor);
    return now;
}

static void engage(Autopilot *autopilot, const Flight *flight) {
    if (autopilot->engaged)
        return;
    *autopilot = (Autopilot){.engaged = true, .elevator = flight->state.elevator, .throttle = 0.0};
}

// ---- inner loops ------------------------------------------------------------------------------------------------

// Of a turn with this bank that holds its path.
static double turn_load(const Now *now) {
    double bank_cos = cos(now->at.bank_rad);
    return cos(now->at.path_rad) / fmax(fabs(bank_cos), 0.4) * (bank_cos < 0.0 ? -1.0 : 1.0);
}

// What gravity leaves of the load: where it is carried by no more, the path is straight.
static double level_load(const Now *now) {
    return cos(now->at.bank_rad) * cos(now->at.pitch_rad);
}

// Elevator for a rate of pitch, kept from the stall: the nose rises no faster than the path, once near it.
static double hold_pitch_rate(Autopilot *autopilot, const Flight *flight, const Now *now, double wanted, double dt_s) {
    const Aircraft *a = flight->aircraft;
    double stall = a->stall_rad + flight->state.flaps * (a->stall_flaps_rad - a->stall_rad);
    double path_rate = GRAVITY / now->speed * (now->at.load_factor - level_load(now));
    double most = ALPHA_RATE * (STALL_SHARE * stall - now->at.alpha_rad) + path_rate;
    double rate = fmin(wanted, fmax(most, -1.0)), off = rate - now->q;
    double each = fmax(now->pitch_each, 1.0);
    autopilot->elevator = clamp(autopilot->elevator + PITCH_RATE * PITCH_INTEGRAL * off / each * dt_s, -1.0, 1.0);
    return clamp(autopilot->elevator + now->pitch_steady * rate + PITCH_RATE * off / each, -1.0, 1.0);
}

// Elevator for a path: its rate asks for load, load for a rate of pitch.
static double hold_path(Autopilot *autopilot, const Flight *flight, const Now *now, double path_rad, double dt_s) {
    double bank_cos = fmax(fabs(cos(now->at.bank_rad)), 0.4);
    double load = turn_load(now) + now->speed * PATH_RATE * (path_rad - now->at.path_rad) / (GRAVITY * bank_cos);
    load = clamp(load, LOAD_LEAST, LOAD_MOST);
    double rate = GRAVITY / now->speed * (load - level_load(now));
    return hold_pitch_rate(autopilot, flight, now, rate, dt_s);
}

static double hold_roll_rate(const Now *now, double wanted) {
    double moment = -now->roll_damping * wanted + ROLL_RATE * (wanted - now->p);
    return clamp(moment / fmax(now->roll_each, 0.1), -1.0, 1.0);
}

static double hold_bank(const Now *now, double bank_rad) {
    return hold_roll_rate(now, clamp(BANK_RATE * angle_between(bank_rad, now->at.bank_rad), -0.7, 0.7));
}

// Against sideslip and against what the ailerons do, and a damper about the rate of the turn.
static double hold_sideslip(const Flight *flight, const Now *now, double aileron, double wanted_rad) {
    const Aircraft *a = flight->aircraft;
    double turn = GRAVITY / now->speed * sin(now->at.bank_rad) * cos(now->at.pitch_rad);
    double adverse = a->cn_aileron * a->aileron_rad / (a->cn_rudder * a->rudder_rad) * aileron;
    double moment =
        0.6 * now->yaw_stiffness * now->at.beta_rad - now->yaw_stiffness * wanted_rad + 0.7 * (turn - now->r);
    return clamp(moment / fmax(now->yaw_each, 0.05) + adverse, -1.0, 1.0);
}

// ---- holds ------------------------------------------------------------------------------------------------------

// As steep as the thrust can, and less when slow: height is given for speed before the stall comes.
static double steepest_path(const Flight *flight, const Now *now, double thrust_n) {
    double weight = flight->aircraft->mass * GRAVITY, least = SPEED_LEAST * now->stall_speed;
    double spare = (thrust_n - now->drag) / weight;
    return spare + ZOOM * (now->at.true_airspeed - least);
}

static double path_to_height(const Flight *flight, const Now *now, double height_m) {
    double wanted = HEIGHT_RATE * (height_m - now->at.h_m) / now->speed;
    return clamp(wanted, -0.2, fmin(fmax(steepest_path(flight, now, now->full_thrust), -0.1), AUTOPILOT_PATH_MOST));
}

// A glider's path: that of its drag, steeper when slow.
static double path_to_speed(Autopilot *autopilot, const Flight *flight, const Now *now, double speed, double dt_s) {
    double off = now->at.true_airspeed - fmax(speed, 1.15 * now->stall_speed);
    double glide = -now->drag / (flight->aircraft->mass * GRAVITY);
    autopilot->path_rad = clamp(autopilot->path_rad + 0.002 * off * dt_s, -0.1, 0.1);
    return clamp(glide + autopilot->path_rad + 0.012 * off, -0.35, 0.2);
}

static double hold_speed(Autopilot *autopilot, const Flight *flight, const Now *now, double speed, double dt_s) {
    if (flight->aircraft->engine == AIRCRAFT_GLIDER)
        return 0.0;
    double mass = flight->aircraft->mass, off = clamp(speed - now->at.true_airspeed, -20.0, 20.0);
    double thrust = now->drag + mass * (GRAVITY * sin(now->at.path_rad) + SPEED_RATE * off);
    double each = fmax(now->full_thrust, 0.02 * mass * GRAVITY);
    double wanted = thrust / each + autopilot->throttle;
    bool saturated = (wanted > 1.0 && off > 0.0) || (wanted < 0.0 && off < 0.0);
    if (!saturated)
        autopilot->throttle =
            clamp(autopilot->throttle + SPEED_INTEGRAL * mass * SPEED_RATE * off / each * dt_s, -0.5, 0.5);
    return clamp(wanted, 0.0, 1.0);
}

static double bank_to_heading(const Now *now, double heading_rad, double most) {
    double rate = HEADING_RATE * angle_between(heading_rad, now->at.track_rad);
    return clamp(atan(now->speed * rate / GRAVITY), -most, most);
}

Controls autopilot_hold(Autopilot *autopilot, const Flight *flight, const AutopilotWish *wish, double dt_s) {
    engage(autopilot, flight);
    Now now = look(flight);
    Controls out = {.gear_up = flight->state.gear < 0.5, .flaps = flight->state.flaps};
    double path = flight->aircraft->engine == AIRCRAFT_GLIDER
                      ? path_to_speed(autopilot, flight, &now, wish->speed_m_s, dt_s)
                      : path_to_height(flight, &now, wish->height_m);
    double most = wish->bank_max_rad > 0.0 ? wish->bank_max_rad : BANK_MAX;
    out.elevator = hold_path(autopilot, flight, &now, path, dt_s);
    out.aileron = hold_bank(&now, bank_to_heading(&now, wish->heading_rad, most));
    out.rudder = hold_sideslip(flight, &now, out.aileron, 0.0);
    out.throttle = hold_speed(autopilot, flight, &now, wish->speed_m_s, dt_s);
    return out;
}

// So steep that the speed stays this much above the stall of the turn.
static double steepest_bank(const Now *now) {
    double slowest = TURN_SPEED_LEAST * now->stall_speed / now->speed;
    return clamp(acos(fmin(slowest * slowest, 1.0)), 0.3, WAYPOINT_BANK);
}

AutopilotReach autopilot_reach(const Flight *flight) {
    Now now = look(flight);
    double weight = flight->aircraft->mass * GRAVITY, bank = steepest_bank(&now);
    double pressure_n = 0.5 * isa_at(now.at.h_m).density * now.speed * now.speed * flight->aircraft->area;
    double to_spare = now.at.true_airspeed - SPEED_LEAST * now.stall_speed;
    return (AutopilotReach){.steady = (now.full_thrust - drag_at(flight, pressure_n, 1.0)) / weight,
                            .turning = (now.full_thrust - drag_at(flight, pressure_n, 1.0 / cos(bank))) / weight,
                            .bank_rad = bank,
                            .zoom_m = ZOOM * to_spare * now.speed * AUTOPILOT_ZOOM_S};
}

// ---- waypoints --------------------------------------------------------------------------------------------------

void autopilot_course(double lat_rad, double lon_rad, const Waypoint *to, double *distance_m, double *bearing_rad) {
    Geodetic from = {lat_rad, lon_rad, 0.0}, there = {to->lat_rad, to->lon_rad, 0.0};
    Mat3d enu = geodesy_enu_from_ecef(lat_rad, lon_rad);
    Vec3d way = mat3d_mul_vec(&enu, vec3d_sub(geodesy_to_ecef(there), geodesy_to_ecef(from)));
    double bearing = atan2(way.x, way.y);
    *distance_m = vec3d_length(way);
    *bearing_rad = bearing < 0.0 ? bearing + 2.0 * GEODESY_PI : bearing;
}

// The height to be at: the waypoint's, or what the ground ahead asks for.
static double wanted_height(const Flight *flight, const Waypoint *to, double clearance_m) {
    double wanted = to->h_m;
    for (int i = 0; i <= LOOKS; i++) {
        double ahead_s = LOOK_AHEAD_S * i / LOOKS, ground_m;
        Vec3d there = vec3d_mad(flight->state.position_ecef, flight->state.velocity_ecef, ahead_s);
        Geodetic place = geodesy_from_ecef(there);
        if (flight->ground.height &&
            flight->ground.height(flight->ground.user, place.lat_rad, place.lon_rad, &ground_m))
            wanted = fmax(wanted, ground_m + clearance_m);
    }
    return wanted;
}

Controls autopilot_fly(Autopilot *autopilot, const Flight *flight, const Waypoint *to, double clearance_m,
                       double dt_s) {
    Geodetic place = geodesy_from_ecef(flight->state.position_ecef);
    const Aircraft *a = flight->aircraft;
    double fastest = a->engine == AIRCRAFT_GLIDER ? a->cruise_speed : 0.9 * a->never_exceed_speed;
    AutopilotWish wish = {.height_m = wanted_height(flight, to, clearance_m),
                          .speed_m_s = fmin(to->speed_m_s, fastest),
                          .bank_max_rad = WAYPOINT_BANK};
    double distance_m;
    autopilot_course(place.lat_rad, place.lon_rad, to, &distance_m, &wish.heading_rad);
    return autopilot_hold(autopilot, flight, &wish, dt_s);
}

bool autopilot_has_reached(const Flight *flight, const Waypoint *to) {
    FlightInstruments now = flight_instruments(flight);
    double distance_m, bearing_rad;
    autopilot_course(now.lat_rad, now.lon_rad, to, &distance_m, &bearing_rad);
    double turn_radius_m = now.speed_m_s * now.speed_m_s / (GRAVITY * tan(WAYPOINT_BANK));
    bool missed = distance_m < 2.5 * turn_radius_m && fabs(angle_between(bearing_rad, now.track_rad)) > MISSED;
    return missed || distance_m < fmax(REACH_S * now.speed_m_s, REACH_MIN_M);
}

// ---- help for keys ----------------------------------------------------------------------------------------------

#define ASSIST_PITCH_MOST 0.6 // rad/s at full stick, and no more load than
#define ASSIST_LOAD 3.0       // g above that of the turn
#define ASSIST_PUSH 1.3       // g below that of the turn, at most: -0.3 g from level flight
#define ASSIST_BANK 1.05      // rad that are held at most
#define ASSIST_DIVE 0.35      // rad of path that speed is sought with, at most
#define ASSIST_FLARE_M 15.0   // above ground
#define ASSIST_ROLL_SHARE 0.8 // of what full ailerons reach
#define ASSIST_ROLL_MOST 1.5  // rad/s
#define ASSIST_SIDESLIP 0.17  // rad at full rudder
#define ASSIST_LEVEL 0.09     // rad of bank that go back to level
#define ASSIST_STEEP 1.2      // rad of path beyond which nothing is held
#define ASSIST_STRAIGHT 0.12  // g off the load of a straight path
#define STICK_FREE 1e-3

// The rate of pitch of a turn that holds its path; none where that means nothing.
static double turning_rate(const Now *now) {
    bool steep = fabs(now->at.path_rad) > 0.8 || fabs(now->at.bank_rad) > 1.3;
    return steep ? 0.0 : GRAVITY / now->speed * (turn_load(now) - level_load(now));
}

// The throttle is the pilot's, so the path is what its thrust and the speed to spare carry. Not in the flare, where
// speed is given up on purpose.
static double assist_steepest(const Flight *flight, const Now *now) {
    bool flares = now->at.over_ground && now->at.above_ground_m < ASSIST_FLARE_M;
    return flares ? INFINITY : fmax(steepest_path(flight, now, now->thrust), -ASSIST_DIVE);
}

static double assist_pitch(Autopilot *autopilot, const Flight *flight, const Now *now, double stick, double dt_s) {
    bool bends = !autopilot->holds_path && fabs(now->at.load_factor - turn_load(now)) > ASSIST_STRAIGHT;
    if (fabs(stick) > STICK_FREE || fabs(now->at.path_rad) > ASSIST_STEEP || bends) {
        double most = fmin(ASSIST_PITCH_MOST, ASSIST_LOAD * GRAVITY / now->speed);
        autopilot->holds_path = fabs(stick) > STICK_FREE ? false : autopilot->holds_path;
        double wanted = fmax(stick * most, -ASSIST_PUSH * GRAVITY / now->speed);
        return hold_pitch_rate(autopilot, flight, now, wanted + turning_rate(now), dt_s);
    }
    if (!autopilot->holds_path) {
        autopilot->holds_path = true;
        autopilot->held_path_rad = now->at.path_rad;
    }
    return hold_path(autopilot, flight, now, fmin(autopilot->held_path_rad, assist_steepest(flight, now)), dt_s);
}

static double assist_roll(Autopilot *autopilot, const Now *now, double stick) {
    double reach = fmin(ASSIST_ROLL_SHARE * now->roll_each / fmax(-now->roll_damping, 0.1), ASSIST_ROLL_MOST);
    if (fabs(stick) > STICK_FREE) {
        autopilot->holds_bank = false;
        return hold_roll_rate(now, stick * reach);
    }
    if (!autopilot->holds_bank && fabs(now->p) > 0.15)
        return hold_roll_rate(now, 0.0);
    if (!autopilot->holds_bank) {
        autopilot->holds_bank = true;
        autopilot->held_bank_rad =
            fabs(now->at.bank_rad) < ASSIST_LEVEL ? 0.0 : clamp(now->at.bank_rad, -ASSIST_BANK, ASSIST_BANK);
    }
    return hold_bank(now, autopilot->held_bank_rad);
}

Controls autopilot_assist(Autopilot *autopilot, const Flight *flight, const Controls *pilot, double dt_s) {
    Controls out = *pilot;
    Now now = look(flight);
    bool stalled = airframe_stalled(flight->aircraft, now.at.alpha_rad, flight->state.flaps) > 0.5;
    if (flight->state.contact != FLIGHT_AIRBORNE || now.at.true_airspeed < 0.5 * now.stall_speed || stalled) {
        *autopilot = (Autopilot){.engaged = false};
        return out;
    }
    engage(autopilot, flight);
    out.trim = 0.0;
    out.elevator = assist_pitch(autopilot, flight, &now, pilot->elevator, dt_s);
    out.aileron = assist_roll(autopilot, &now, pilot->aileron);
    out.rudder = hold_sideslip(flight, &now, out.aileron, -ASSIST_SIDESLIP * pilot->rudder);
    return out;
}
