#include "app/flight/autopilot.h"

#include "app/flight/flight_forces.h"
#include "terrain/geodesy.h"

#include <math.h>

#define BANK_MAX 0.7   // rad
#define CLIMB_MAX 0.28 // rad of path
#define DESCENT_MAX 0.16
#define LOOK_AHEAD_S 14.0 // the ground is watched so far ahead
#define LOOKS 8
#define REACH_S 3.0 // a waypoint counts as reached within this time of flight
#define REACH_MIN_M 250.0
#define MISSED 1.4 // rad off the nose: so near, it would be circled for ever

static double clamp(double value, double least, double greatest) {
    return fmin(fmax(value, least), greatest);
}

void autopilot_course(double lat_rad, double lon_rad, const Waypoint *to, double *distance_m, double *bearing_rad) {
    Geodetic from = {lat_rad, lon_rad, 0.0}, there = {to->lat_rad, to->lon_rad, 0.0};
    Mat3d enu = geodesy_enu_from_ecef(lat_rad, lon_rad);
    Vec3d way = mat3d_mul_vec(&enu, vec3d_sub(geodesy_to_ecef(there), geodesy_to_ecef(from)));
    double bearing = atan2(way.x, way.y);
    *distance_m = vec3d_length(way);
    *bearing_rad = bearing < 0.0 ? bearing + 2.0 * GEODESY_PI : bearing;
}

static double angle_between(double wanted, double is) {
    return remainder(wanted - is, 2.0 * GEODESY_PI);
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

static double steer_path(const FlightInstruments *now, double wanted_h_m) {
    double speed = fmax(now->speed_m_s, 1.0);
    double path = asin(clamp(now->vertical_speed_m_s / speed, -1.0, 1.0));
    double wanted = clamp((wanted_h_m - now->h_m) / (3.5 * speed), -DESCENT_MAX, CLIMB_MAX);
    return clamp(2.2 * (wanted - path), -0.8, 0.9);
}

static double steer_bank(const FlightInstruments *now, double bearing_rad) {
    double bank = clamp(1.1 * angle_between(bearing_rad, now->heading_rad), -BANK_MAX, BANK_MAX);
    return clamp(1.6 * angle_between(bank, now->bank_rad), -0.7, 0.7);
}

static double steer_throttle(const FlightInstruments *now, double wanted_speed) {
    double climb = FLIGHT_GRAVITY * now->vertical_speed_m_s / fmax(now->speed_m_s, 1.0) / FLIGHT_THRUST;
    double trim = flight_trim_throttle(wanted_speed, now->h_m);
    return clamp(trim + climb + 0.06 * (wanted_speed - now->speed_m_s), 0.0, 1.0);
}

Controls autopilot_fly(const Flight *flight, const Waypoint *to, double clearance_m) {
    FlightInstruments now = flight_instruments(flight);
    double distance_m, bearing_rad;
    autopilot_course(now.lat_rad, now.lon_rad, to, &distance_m, &bearing_rad);
    return (Controls){.elevator = steer_path(&now, wanted_height(flight, to, clearance_m)),
                      .aileron = steer_bank(&now, bearing_rad),
                      .throttle = steer_throttle(&now, to->speed_m_s)};
}

bool autopilot_has_reached(const Flight *flight, const Waypoint *to) {
    FlightInstruments now = flight_instruments(flight);
    double distance_m, bearing_rad;
    autopilot_course(now.lat_rad, now.lon_rad, to, &distance_m, &bearing_rad);
    double turn_radius_m = now.speed_m_s * now.speed_m_s / (FLIGHT_GRAVITY * tan(BANK_MAX));
    bool missed = distance_m < 2.5 * turn_radius_m && fabs(angle_between(bearing_rad, now.heading_rad)) > MISSED;
    return missed || distance_m < fmax(REACH_S * now.speed_m_s, REACH_MIN_M);
}
