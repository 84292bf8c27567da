#include "app/aircraft/airframe.h"

#include <math.h>

#define GRAVITY 9.80665
#define WING_LEAST_M 0.3  // nearer to the ground than this the wing does not come
#define ELEVATOR_LOST 0.3 // share of the effect lost in a stalled flow: the tail lies in the wake
#define AILERON_LOST 0.8  // the ailerons lie in it

static double clamp(double value, double least, double greatest) {
    return fmin(fmax(value, least), greatest);
}

// From 0 to 1 with three continuous derivatives, which the integration's order asks for.
static double smooth_step(double x) {
    double t = clamp(x, 0.0, 1.0), t2 = t * t;
    return t2 * t2 * (35.0 + t * (-84.0 + t * (70.0 - 20.0 * t)));
}

static double stall_above(const Aircraft *a, double flaps) {
    return a->stall_rad + flaps * (a->stall_flaps_rad - a->stall_rad);
}

double airframe_stalled(const Aircraft *a, double alpha, double flaps) {
    double width = a->stall_width_rad,
           beyond = alpha > 0.0 ? alpha - stall_above(a, flaps) : -alpha - a->stall_below_rad;
    return smooth_step(beyond / width + 0.5);
}

// Coefficients of lift and drag of the wing at an angle: attached, and what the stall changes.
typedef struct WingFlow {
    double stalled, lift, drag;      // attached
    double lift_change, drag_change; // by the stall
} WingFlow;

static WingFlow wing_flow(const Aircraft *a, double alpha, double flaps, double induced) {
    WingFlow w = {.stalled = airframe_stalled(a, alpha, flaps)};
    w.lift = a->cl_0 + a->cl_alpha * alpha + a->cl_flaps * flaps;
    w.drag = a->cd_0 + induced * w.lift * w.lift;
    if (w.stalled > 0.0) {
        double s = sin(alpha), c = cos(alpha);
        w.lift_change = w.stalled * (a->cd_plate * s * c - w.lift);
        w.drag_change = w.stalled * (a->cd_0 + a->cd_plate * s * s - w.drag);
    }
    return w;
}

double airframe_wing_lift(const Aircraft *aircraft, double alpha, double flaps) {
    WingFlow w = wing_flow(aircraft, alpha, flaps, aircraft->induced);
    return w.lift + w.lift_change;
}

void airframe_angles(Vec3d v, double *alpha, double *beta) {
    double speed = vec3d_length(v);
    *alpha = atan2(v.z, v.x);
    *beta = speed > 0.0 ? asin(clamp(v.y / speed, -1.0, 1.0)) : 0.0;
}

double airframe_ground_effect(const Aircraft *aircraft, double wing_above_m) {
    if (wing_above_m > 20.0 * aircraft->span)
        return 1.0;
    double x = 16.0 * fmax(wing_above_m, WING_LEAST_M) / aircraft->span;
    return x * x / (1.0 + x * x);
}

double airframe_stall_speed(const Aircraft *a, double density, double flaps) {
    double greatest = a->cl_max + flaps * (a->cl_max_flaps - a->cl_max);
    return sqrt(2.0 * a->mass * GRAVITY / (density * a->area * greatest));
}

// What all parts of the load need.
typedef struct Flow {
    double speed, half_rho_v; // half of density times speed: pressure is half_rho_v * speed
    double alpha, sin_alpha, cos_alpha, sin_beta;
    WingFlow wing, left, right;
    double p, q, r;                   // span or chord halves times rates: non-dimensional times speed
    double elevator, aileron, rudder; // radians, in the signs of the derivatives
} Flow;

// The halves of the wing go up and down, ahead and back, with the rates. Where neither can be stalled nothing changes.
static void look_at_halves(const Aircraft *a, const AirframeFlow *in, double induced, Flow *f) {
    Vec3d v = in->air_body, w = in->rate_body;
    double turn = a->panel_y * (fabs(w.x) + fabs(w.z)), least = fmin(stall_above(a, in->flaps), a->stall_below_rad);
    if (fabs(f->alpha) + 1.6 * turn / fmax(f->speed, 1e-3) < least - 0.5 * a->stall_width_rad)
        return;
    f->right = wing_flow(a, atan2(v.z + w.x * a->panel_y, v.x - w.z * a->panel_y), in->flaps, induced);
    f->left = wing_flow(a, atan2(v.z - w.x * a->panel_y, v.x + w.z * a->panel_y), in->flaps, induced);
}

static Flow look(const Aircraft *a, const AirframeFlow *in) {
    Vec3d v = in->air_body, w = in->rate_body;
    double plane = sqrt(v.x * v.x + v.z * v.z), induced = a->induced * airframe_ground_effect(a, in->wing_above_m);
    Flow f = {.speed = vec3d_length(v), .alpha = atan2(v.z, v.x)};
    f.half_rho_v = 0.5 * in->density * f.speed;
    f.sin_alpha = plane > 0.0 ? v.z / plane : 0.0;
    f.cos_alpha = plane > 0.0 ? v.x / plane : 1.0;
    f.sin_beta = f.speed > 0.0 ? v.y / f.speed : 0.0;
    f.wing = wing_flow(a, f.alpha, in->flaps, induced);
    look_at_halves(a, in, induced, &f);
    f.p = 0.5 * a->span * w.x;
    f.q = 0.5 * a->chord * w.y;
    f.r = 0.5 * a->span * w.z;
    f.elevator = -in->elevator * a->elevator_rad * (1.0 - ELEVATOR_LOST * f.wing.stalled);
    f.aileron = in->aileron * a->aileron_rad * (1.0 - AILERON_LOST * f.wing.stalled);
    f.rudder = -in->rudder * a->rudder_rad;
    return f;
}

// Below, coefficients are multiplied with the speed, and those of rates are not divided by it: nothing is singular.
static Vec3d force_of(const Aircraft *a, const AirframeFlow *in, const Flow *f) {
    double v = f->speed;
    double lift = v * (f->wing.lift + f->wing.lift_change + a->cl_elevator * f->elevator) + a->cl_q * f->q;
    double drag = v * (f->wing.drag + f->wing.drag_change + a->cd_flaps * in->flaps + a->cd_gear * in->gear +
                       a->cd_beta * f->sin_beta * f->sin_beta);
    double side = v * (a->cy_beta * f->sin_beta + a->cy_aileron * f->aileron + a->cy_rudder * f->rudder) +
                  a->cy_p * f->p + a->cy_r * f->r;
    double scale = f->half_rho_v * a->area;
    Vec3d path = v > 0.0 ? vec3d_scale(in->air_body, 1.0 / v) : vec3d(0.0, 0.0, 0.0);
    Vec3d sum = vec3d(lift * f->sin_alpha, side, -lift * f->cos_alpha);
    return vec3d_scale(vec3d_mad(sum, path, -drag), scale);
}

static Vec3d moment_of(const Aircraft *a, const AirframeFlow *in, const Flow *f) {
    double v = f->speed, arm = a->panel_y / (2.0 * a->span);
    double roll = v * (a->cr_beta * f->sin_beta + a->cr_aileron * f->aileron + a->cr_rudder * f->rudder +
                       arm * (f->left.lift_change - f->right.lift_change)) +
                  a->cr_p * f->p + a->cr_r * f->r;
    double attached = a->cm_0 + a->cm_alpha * f->alpha + a->cm_flaps * in->flaps;
    double pitch = v * (attached + f->wing.stalled * (-fabs(a->cm_alpha) * f->sin_alpha - attached) +
                        a->cm_elevator * f->elevator) +
                   a->cm_q * f->q;
    double yaw = v * (a->cn_beta * f->sin_beta + a->cn_aileron * f->aileron + a->cn_rudder * f->rudder +
                      arm * (f->right.drag_change - f->left.drag_change)) +
                 a->cn_p * f->p + a->cn_r * f->r;
    double scale = f->half_rho_v * a->area;
    return vec3d(scale * a->span * roll, scale * a->chord * pitch, scale * a->span * yaw);
}

AirframeLoad airframe_load(const Aircraft *aircraft, const AirframeFlow *in) {
    Flow f = look(aircraft, in);
    AirframeLoad load = {.force = force_of(aircraft, in, &f), .moment = moment_of(aircraft, in, &f)};
    double lag = f.half_rho_v * aircraft->area * 0.5 * aircraft->chord * (1.0 - f.wing.stalled);
    double lift = lag * aircraft->cl_alpha_dot;
    load.force_alpha_dot = vec3d(lift * f.sin_alpha, 0.0, -lift * f.cos_alpha);
    load.moment_alpha_dot = vec3d(0.0, lag * aircraft->chord * aircraft->cm_alpha_dot, 0.0);
    return load;
}

double airframe_stiffness(const Aircraft *a, double density, double speed) {
    double flow = 0.5 * density * speed * a->area;
    double roll = 0.5 * flow * a->span * a->span * -a->cr_p / a->ixx;
    double pitch = 0.5 * flow * a->chord * a->chord * -(a->cm_q + a->cm_alpha_dot) / a->iyy;
    double yaw = 0.5 * flow * a->span * a->span * -a->cn_r / a->izz;
    double nod = flow * speed * a->chord * fabs(a->cm_alpha) / a->iyy;
    double swing = sqrt(fmax(nod, flow * speed * a->span * fabs(a->cn_beta) / a->izz));
    double drag = flow * (2.0 * a->cd_plate + a->cl_alpha) / a->mass;
    return fmax(fmax(fmax(roll, pitch), fmax(yaw, swing)), drag);
}
