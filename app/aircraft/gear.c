#include "app/aircraft/gear.h"

#include <math.h>

#define SLIP_FULL 0.12 // rad of slip angle at which a tyre's side force is nearly all there

static double depth_of(const AircraftLeg *leg, const GearPlane *plane) {
    Vec3d foot = {leg->x, leg->y, leg->z};
    return vec3d_dot(vec3d_sub(plane->point, foot), plane->normal);
}

double gear_spring_energy(const AircraftLeg *leg, const GearPlane *plane) {
    double depth = plane->there ? fmax(depth_of(leg, plane), 0.0) : 0.0;
    return 0.5 * leg->stiffness * depth * depth;
}

// In the plane; `load` is the force into it.
static Vec3d friction(const AircraftLeg *leg, const GearPlane *plane, const GearMotion *motion, Vec3d velocity,
                      double load) {
    double steer = leg->steer_rad * motion->rudder;
    Vec3d heading = {cos(steer), sin(steer), 0.0};
    Vec3d along = vec3d_normalize(vec3d_mad(heading, plane->normal, -vec3d_dot(heading, plane->normal)));
    Vec3d across = vec3d_cross(plane->normal, along);
    double v = vec3d_dot(velocity, along), slip = vec3d_dot(velocity, across);
    double creep2 = GEAR_CREEP_M_S * GEAR_CREEP_M_S, full = SLIP_FULL * v;
    double brake = fmin(leg->brake_left * motion->brake_left + leg->brake_right * motion->brake_right, 1.0);
    double rolling = fmin(leg->rolling + brake * leg->friction, leg->friction) * v / sqrt(v * v + creep2);
    double side = leg->friction * slip / sqrt(slip * slip + full * full + creep2);
    double both = sqrt(rolling * rolling + side * side), scale = both > leg->friction ? leg->friction / both : 1.0;
    return vec3d_scale(vec3d_mad(vec3d_scale(along, rolling), across, side), -load * scale);
}

GearLoad gear_load(const AircraftLeg *leg, const GearPlane *plane, const GearMotion *motion) {
    double depth = plane->there ? depth_of(leg, plane) : -1.0;
    if (depth <= 0.0)
        return (GearLoad){.touches = false};
    Vec3d foot = vec3d_mad((Vec3d){leg->x, leg->y, leg->z}, plane->normal, depth);
    Vec3d velocity = vec3d_add(motion->velocity_body, vec3d_cross(motion->rate_body, foot));
    double out = vec3d_dot(velocity, plane->normal);
    double load = fmax(leg->stiffness * depth - leg->damping * out, 0.0);
    Vec3d sliding = vec3d_mad(velocity, plane->normal, -out);
    Vec3d force = vec3d_mad(friction(leg, plane, motion, sliding, load), plane->normal, load);
    return (GearLoad){.force = force, .moment = vec3d_cross(foot, force), .touches = true, .sink_m_s = -out};
}
