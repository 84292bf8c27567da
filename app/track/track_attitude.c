#include "app/track/track_attitude.h"

#include "base/log.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <stdlib.h>

// Of the path at a point.
typedef struct Leg {
    double passed_m;    // along the track, over ground, from the first point
    double heading_deg; // smoothed, without jumps at north
    double pitch_deg;
    bool slow;
} Leg;

// Both sides take the same number of evenly spaced points, however their times are rounded.
#define REACH_S (TRACK_WINDOW_S + 1e-4)

typedef struct Window {
    int first, last; // points
} Window;

// The points of a segment, which no gap divides: [first, last].
static int last_of_segment(const Track *track, int first) {
    int last = first;
    while (last + 1 < track->count && !(track->points[last + 1].flags & TRACK_GAP))
        last++;
    return last;
}

static Vec3d place_of(const TrackPoint *point) {
    return geodesy_to_ecef(
        (Geodetic){point->at.lat_deg * GEODESY_RAD_PER_DEG, point->at.lon_deg * GEODESY_RAD_PER_DEG, point->at.alt_m});
}

// East, north, up metres from one point to another, at the first's place.
static Vec3d way_between(const TrackPoint *from, const TrackPoint *to) {
    Mat3d enu = geodesy_enu_from_ecef(from->at.lat_deg * GEODESY_RAD_PER_DEG, from->at.lon_deg * GEODESY_RAD_PER_DEG);
    return mat3d_mul_vec(&enu, vec3d_sub(place_of(to), place_of(from)));
}

// Moves on to point `i`; both ends only ever go forward.
static void move_window(const Track *track, Window segment, int i, Window *window) {
    const TrackPoint *p = track->points;
    while (window->first < i - 1 && p[window->first].t_s < p[i].t_s - REACH_S)
        window->first++;
    window->last = window->last > i ? window->last : i;
    while (window->last < segment.last && (window->last <= i || p[window->last + 1].t_s <= p[i].t_s + REACH_S))
        window->last++;
}

static double turn_deg(double from_deg, double to_deg) {
    return remainder(to_deg - from_deg, 360.0);
}

static void measure_paths(const Track *track, Window segment, Leg *legs) {
    legs[segment.first].passed_m = 0.0;
    for (int i = segment.first + 1; i <= segment.last; i++) {
        Vec3d way = way_between(&track->points[i - 1], &track->points[i]);
        legs[i].passed_m = legs[i - 1].passed_m + hypot(way.x, way.y);
    }
}

// Heading and pitch of the chord over each window.
static void measure_directions(const Track *track, Window segment, Leg *legs) {
    Window window = {segment.first, segment.first};
    double heading = 0.0;
    for (int i = segment.first; i <= segment.last; i++) {
        move_window(track, segment, i, &window);
        const TrackPoint *from = &track->points[window.first], *to = &track->points[window.last];
        Vec3d way = way_between(from, to);
        double across = hypot(way.x, way.y), seconds = to->t_s - from->t_s;
        legs[i].slow = !(across > TRACK_SLOW_M_S * seconds);
        legs[i].pitch_deg = legs[i].slow ? 0.0 : atan2(to->at.alt_m - from->at.alt_m, across) / GEODESY_RAD_PER_DEG;
        if (!legs[i].slow)
            heading += turn_deg(heading, atan2(way.x, way.y) / GEODESY_RAD_PER_DEG);
        legs[i].heading_deg = heading;
    }
}

// Standing still at first it looks where it will go.
static void look_ahead(Window segment, Leg *legs) {
    int moving = segment.first;
    while (moving <= segment.last && legs[moving].slow)
        moving++;
    for (int i = segment.first; i < moving && moving <= segment.last; i++)
        legs[i].heading_deg = legs[moving].heading_deg;
}

static double bank_deg(const Track *track, const Leg *legs, Window window) {
    double seconds = track->points[window.last].t_s - track->points[window.first].t_s;
    if (!(seconds > 0.0))
        return 0.0;
    double speed = (legs[window.last].passed_m - legs[window.first].passed_m) / seconds;
    double turned = (legs[window.last].heading_deg - legs[window.first].heading_deg) * GEODESY_RAD_PER_DEG;
    return atan(speed * turned / seconds / TRACK_GRAVITY_M_S2) / GEODESY_RAD_PER_DEG;
}

static double compass_deg(double heading_deg) {
    double heading = fmod(heading_deg, 360.0);
    return heading < 0.0 ? heading + 360.0 : heading;
}

static void set_attitudes(Track *track, Window segment, const Leg *legs) {
    Window window = {segment.first, segment.first};
    for (int i = segment.first; i <= segment.last; i++) {
        move_window(track, segment, i, &window);
        TrackPoint *point = &track->points[i];
        if (!(point->flags & TRACK_DERIVED))
            continue;
        point->at.heading_deg = compass_deg(legs[i].heading_deg);
        point->at.pitch_deg = legs[i].pitch_deg;
        point->bank_deg = legs[i].slow ? 0.0 : bank_deg(track, legs, window);
    }
}

Result track_derive_attitude(Track *track) {
    if (!track_is_derived(track))
        return RESULT_OK;
    Leg *legs = malloc(sizeof *legs * (size_t)track->count);
    if (!legs) {
        log_error("no memory to derive the attitude of %d points", track->count);
        return RESULT_MEMORY;
    }
    for (int first = 0; first < track->count;) {
        Window segment = {first, last_of_segment(track, first)};
        measure_paths(track, segment, legs);
        measure_directions(track, segment, legs);
        look_ahead(segment, legs);
        set_attitudes(track, segment, legs);
        first = segment.last + 1;
    }
    free(legs);
    return RESULT_OK;
}
