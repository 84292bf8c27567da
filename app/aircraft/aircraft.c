#include "app/aircraft/aircraft.h"

#include "app/aircraft/airframe.h"

#include <math.h>

#define PI 3.14159265358979323846
#define STALL_LEAST 0.02 // rad
#define STALL_MOST 1.0
#define SCAN_STEPS 400
#define BISECTIONS 60

const char *aircraft_engine_name(AircraftEngine engine) {
    static const char *const names[AIRCRAFT_ENGINE_COUNT] = {"none", "piston", "jet"};
    return names[engine];
}

// The greatest lift coefficient, of the wing without elevator; `side` -1: the least, with its sign turned.
static double greatest_lift(const Aircraft *aircraft, double flaps, double side) {
    double best = -INFINITY;
    for (int i = 0; i <= SCAN_STEPS; i++) {
        double alpha = side * (STALL_MOST * i / SCAN_STEPS);
        best = fmax(best, side * airframe_wing_lift(aircraft, alpha, flaps));
    }
    return best;
}

// The stall angle with which the lift reaches `wanted` and no more; it rises with the angle.
static bool find_stall(Aircraft *aircraft, double *angle, double flaps, double side, double wanted) {
    double low = STALL_LEAST, high = STALL_MOST;
    for (int i = 0; i < BISECTIONS; i++) {
        *angle = 0.5 * (low + high);
        if (greatest_lift(aircraft, flaps, side) < wanted)
            low = *angle;
        else
            high = *angle;
    }
    return fabs(greatest_lift(aircraft, flaps, side) - wanted) < 1e-3;
}

Result aircraft_derive(Aircraft *aircraft) {
    double aspect = aircraft->span * aircraft->span / aircraft->area;
    aircraft->induced = 1.0 / (PI * aspect * aircraft->oswald);
    // Two halves of a wing that move up and down with roll damp it as much as the derivative says.
    aircraft->panel_y = aircraft->span * sqrt(-aircraft->cr_p / (2.0 * aircraft->cl_alpha));
    aircraft->stall_rad = aircraft->stall_flaps_rad = aircraft->stall_below_rad = STALL_MOST;
    bool found = find_stall(aircraft, &aircraft->stall_rad, 0.0, 1.0, aircraft->cl_max);
    aircraft->stall_flaps_rad = aircraft->stall_rad;
    found = found && find_stall(aircraft, &aircraft->stall_flaps_rad, 1.0, 1.0, aircraft->cl_max_flaps);
    found = found && find_stall(aircraft, &aircraft->stall_below_rad, 0.0, -1.0, -aircraft->cl_min);
    return found ? RESULT_OK : RESULT_RANGE;
}
