#include "app/track/track.h"

#include "terrain/geodesy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PLACE_PER_DEG 1e9
#define DIRECTION_PER_DEG 1e6
#define PER_M 1e3

static const char *const NAMES[TRACK_KIND_COUNT] = {
#define TRACK_NAME(id, name, what) name,
    TRACK_KIND_TABLE(TRACK_NAME)
#undef TRACK_NAME
};

static const char *const WHATS[TRACK_KIND_COUNT] = {
#define TRACK_WHAT(id, name, what) what,
    TRACK_KIND_TABLE(TRACK_WHAT)
#undef TRACK_WHAT
};

const char *track_kind_name(TrackKind kind) {
    return NAMES[kind];
}

const char *track_kind_what(TrackKind kind) {
    return WHATS[kind];
}

bool track_kind_find(const char *name, TrackKind *out) {
    for (int i = 0; i < TRACK_KIND_COUNT; i++) {
        if (strcmp(NAMES[i], name) != 0)
            continue;
        *out = (TrackKind)i;
        return true;
    }
    return false;
}

void track_clear(Track *track) {
    free(track->points);
    *track = (Track){0};
}

double track_duration_s(const Track *track) {
    return track->count > 0 ? track->points[track->count - 1].t_s - track->points[0].t_s : 0.0;
}

// ---- between points ----

// Heights are above the geoid here as everywhere in a track: as good a third coordinate as any to interpolate.
static Vec3d place_of(const Viewpoint *at) {
    return geodesy_to_ecef((Geodetic){at->lat_deg * GEODESY_RAD_PER_DEG, at->lon_deg * GEODESY_RAD_PER_DEG, at->alt_m});
}

static void direction_at(Vec3d forward, double lat_rad, double lon_rad, double *heading_deg, double *pitch_deg) {
    Mat3d enu = geodesy_enu_from_ecef(lat_rad, lon_rad);
    Vec3d local = mat3d_mul_vec(&enu, forward);
    double heading = atan2(local.x, local.y) / GEODESY_RAD_PER_DEG;
    *heading_deg = heading < 0.0 ? heading + 360.0 : heading;
    *pitch_deg = atan2(local.z, hypot(local.x, local.y)) / GEODESY_RAD_PER_DEG;
}

void track_look(const Viewpoint *from, const Viewpoint *to, double *heading_deg, double *pitch_deg) {
    Vec3d way = vec3d_sub(place_of(to), place_of(from));
    *heading_deg = *pitch_deg = 0.0;
    if (vec3d_length(way) > 0.0)
        direction_at(way, from->lat_deg * GEODESY_RAD_PER_DEG, from->lon_deg * GEODESY_RAD_PER_DEG, heading_deg,
                     pitch_deg);
}

// Metres a second at point `i`: of the line through its neighbours.
static Vec3d slope_at(const Track *track, int i) {
    int before = i > 0 ? i - 1 : i, after = i + 1 < track->count ? i + 1 : i;
    double seconds = track->points[after].t_s - track->points[before].t_s;
    Vec3d way = vec3d_sub(place_of(&track->points[after].at), place_of(&track->points[before].at));
    return seconds > 0.0 ? vec3d_scale(way, 1.0 / seconds) : vec3d(0, 0, 0);
}

static Vec3d hermite(const Track *track, int i, double share) {
    double dt = track->points[i + 1].t_s - track->points[i].t_s, s = share, s2 = s * s, s3 = s2 * s;
    Vec3d sum = vec3d_scale(place_of(&track->points[i].at), 2.0 * s3 - 3.0 * s2 + 1.0);
    sum = vec3d_mad(sum, slope_at(track, i), dt * (s3 - 2.0 * s2 + s));
    sum = vec3d_mad(sum, place_of(&track->points[i + 1].at), 3.0 * s2 - 2.0 * s3);
    return vec3d_mad(sum, slope_at(track, i + 1), dt * (s3 - s2));
}

// Along the great circle; through opposite directions straight.
static Vec3d slerp(Vec3d a, Vec3d b, double share) {
    double angle = atan2(vec3d_length(vec3d_cross(a, b)), vec3d_dot(a, b)), s = sin(angle);
    if (s < 1e-9)
        return vec3d_normalize(vec3d_mad(vec3d_scale(a, 1.0 - share), b, share));
    return vec3d_mad(vec3d_scale(a, sin((1.0 - share) * angle) / s), b, sin(share * angle) / s);
}

static double rounded(double value, double per_unit) {
    return round(value * per_unit) / per_unit;
}

static Viewpoint as_told(Viewpoint at) {
    return (Viewpoint){.lat_deg = rounded(at.lat_deg, PLACE_PER_DEG),
                       .lon_deg = rounded(at.lon_deg, PLACE_PER_DEG),
                       .alt_m = rounded(at.alt_m, PER_M),
                       .heading_deg = rounded(at.heading_deg, DIRECTION_PER_DEG),
                       .pitch_deg = rounded(at.pitch_deg, DIRECTION_PER_DEG)};
}

// The last point that is not after `t_s`; the first one where all are.
static int point_before(const Track *track, double t_s) {
    int low = 0, high = track->count;
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        *(track->points[middle].t_s <= t_s ? &low : &high) = middle;
    }
    return low;
}

Viewpoint track_at(const Track *track, double t_s) {
    double t = t_s + track->points[0].t_s;
    int i = point_before(track, t);
    const TrackPoint *from = &track->points[i];
    if (t <= from->t_s || i + 1 == track->count)
        return as_told(from->at);
    const TrackPoint *to = from + 1;
    double share = (t - from->t_s) / (to->t_s - from->t_s);
    Geodetic place = geodesy_from_ecef(hermite(track, i, share));
    Viewpoint at = {.lat_deg = place.lat_rad / GEODESY_RAD_PER_DEG,
                    .lon_deg = place.lon_rad / GEODESY_RAD_PER_DEG,
                    .alt_m = place.h_m};
    Vec3d forward = slerp(viewpoint_forward(&from->at), viewpoint_forward(&to->at), share);
    direction_at(forward, place.lat_rad, place.lon_rad, &at.heading_deg, &at.pitch_deg);
    return as_told(at);
}

// FNV-1a over the bits of the numbers.
static uint64_t hash_number(uint64_t hash, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    for (int i = 0; i < 64; i += 8)
        hash = (hash ^ (bits >> i & 0xff)) * UINT64_C(1099511628211);
    return hash;
}

uint64_t track_hash(const Track *track) {
    uint64_t hash = UINT64_C(14695981039346656037);
    for (int i = 0; i < track->count; i++) {
        const TrackPoint *p = &track->points[i];
        const double numbers[] = {p->t_s,      p->at.lat_deg,     p->at.lon_deg,
                                  p->at.alt_m, p->at.heading_deg, p->at.pitch_deg};
        for (size_t k = 0; k < COUNT_OF(numbers); k++)
            hash = hash_number(hash, numbers[k]);
    }
    return hash;
}
