#include "app/demo/demo.h"

#include "terrain/geodesy.h"

#include <math.h>

#define ROUND_POINTS 8
#define ROUND_SPEED 110.0

void demo_clear(Demo *demo) {
    stick_stream_destroy(&demo->stick);
    *demo = (Demo){0};
}

void demo_make_round(const Viewpoint *view, const Geoid *geoid, double distance_m, Demo *out) {
    *out = (Demo){.clearance_m = 2.0 * DEMO_CLEARANCE_M, .count = ROUND_POINTS};
    double lat = view->lat_deg * GEODESY_RAD_PER_DEG, lon = view->lon_deg * GEODESY_RAD_PER_DEG;
    double heading = view->heading_deg * GEODESY_RAD_PER_DEG;
    double centre_lat = lat + distance_m * cos(heading) / GEODESY_A_M;
    double centre_lon = lon + distance_m * sin(heading) / (GEODESY_A_M * fmax(cos(lat), 0.05));
    double h_m = view->alt_m + geoid_undulation_m(geoid, view->lat_deg, view->lon_deg);
    for (int i = 0; i < ROUND_POINTS; i++) {
        double angle = heading + GEODESY_PI - 2.0 * GEODESY_PI * (i + 1) / ROUND_POINTS;
        double radius_m = 0.6 * distance_m;
        out->waypoints[i] =
            (Waypoint){centre_lat + radius_m * cos(angle) / GEODESY_A_M,
                       centre_lon + radius_m * sin(angle) / (GEODESY_A_M * fmax(cos(lat), 0.05)), h_m, ROUND_SPEED};
    }
}

void demo_begin(Demo *demo, const Controls *controls) {
    demo->next = 0;
    demo->autopilot = (Autopilot){.engaged = false};
    if (demo->stick)
        stick_stream_begin(demo->stick, controls);
}

Controls demo_fly(Demo *demo, const Flight *flight, double dt_s) {
    if (demo->stick)
        return stick_stream_sample(demo->stick, dt_s);
    if (!demo_is_over(demo) && autopilot_has_reached(flight, &demo->waypoints[demo->next]))
        demo->next++;
    int next = demo->next < demo->count ? demo->next : demo->count - 1;
    return autopilot_fly(&demo->autopilot, flight, &demo->waypoints[next], demo->clearance_m, dt_s);
}

bool demo_is_over(const Demo *demo) {
    return demo->stick ? stick_stream_is_over(demo->stick) : demo->next >= demo->count;
}

double demo_duration_s(const Demo *demo, double lat_rad, double lon_rad) {
    double sum_s = 0.0, distance_m, bearing_rad;
    if (demo->stick)
        return stick_stream_duration_s(demo->stick);
    for (int i = 0; i < demo->count; i++) {
        const Waypoint *to = &demo->waypoints[i];
        autopilot_course(lat_rad, lon_rad, to, &distance_m, &bearing_rad);
        sum_s += distance_m / to->speed_m_s;
        lat_rad = to->lat_rad;
        lon_rad = to->lon_rad;
    }
    return sum_s;
}
