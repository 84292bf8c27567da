#include "app/track/track.h"

#include "base/log.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PLACE_PER_DEG 1e9
#define DIRECTION_PER_DEG 1e6
#define PER_M 1e3

#define TRACK_NAME(id, name, what) name,
#define TRACK_WHAT(id, name, what) what,
static const char *const NAMES[TRACK_KIND_COUNT] = {TRACK_KIND_TABLE(TRACK_NAME)};
static const char *const WHATS[TRACK_KIND_COUNT] = {TRACK_KIND_TABLE(TRACK_WHAT)};

static const char *const HEIGHTS_NAMES[TRACK_HEIGHTS_COUNT] = {TRACK_HEIGHTS_TABLE(TRACK_NAME)};
static const char *const HEIGHTS_WHATS[TRACK_HEIGHTS_COUNT] = {TRACK_HEIGHTS_TABLE(TRACK_WHAT)};
static const char *const SKIP_NAMES[TRACK_SKIP_COUNT] = {TRACK_SKIP_TABLE(TRACK_NAME)};
static const char *const SKIP_WHATS[TRACK_SKIP_COUNT] = {TRACK_SKIP_TABLE(TRACK_WHAT)};

const char *track_heights_name(TrackHeights heights) {
    return HEIGHTS_NAMES[heights];
}

const char *track_heights_what(TrackHeights heights) {
    return HEIGHTS_WHATS[heights];
}

const char *track_skip_name(TrackSkip skip) {
    return SKIP_NAMES[skip];
}

const char *track_skip_what(TrackSkip skip) {
    return SKIP_WHATS[skip];
}

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

Result track_copy(const Track *track, Track *out) {
    TrackPoint *points = malloc((size_t)track->count * sizeof *points);
    if (!points) {
        log_error("%s: no memory for %d points", track->name, track->count);
        return RESULT_MEMORY;
    }
    memcpy(points, track->points, (size_t)track->count * sizeof *points);
    *out = *track;
    out->points = points;
    return RESULT_OK;
}

void track_clear(Track *track) {
    free(track->points);
    *track = (Track){0};
}

double track_duration_s(const Track *track) {
    return track->count > 0 ? track->points[track->count - 1].t_s - track->points[0].t_s : 0.0;
}

int track_gap_count(const Track *track) {
    int gaps = 0;
    for (int i = 0; i < track->count; i++)
        gaps += (track->points[i].flags & TRACK_GAP) != 0;
    return gaps;
}

bool track_is_derived(const Track *track) {
    for (int i = 0; i < track->count; i++)
        if (track->points[i].flags & TRACK_DERIVED)
            return true;
    return false;
}

bool track_has_pressure(const Track *track) {
    bool all = true;
    for (int i = 0; i < track->count && all; i++)
        all = (track->points[i].flags & TRACK_PRESSURE) != 0;
    return all || track->heights == TRACK_HEIGHTS_PRESSURE;
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

static bool begins_anew(const Track *track, int i) {
    return (track->points[i].flags & TRACK_GAP) != 0;
}

// Metres a second at point `i`: of the line through its neighbours on this side of any gap.
static Vec3d slope_at(const Track *track, int i) {
    int before = i > 0 && !begins_anew(track, i) ? i - 1 : i;
    int after = i + 1 < track->count && !begins_anew(track, i + 1) ? i + 1 : i;
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

// From the axes of the body (x right, y ahead, z up) to ECEF.
static Quatd attitude_of(const TrackPoint *point) {
    const Vec3d x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1};
    const Viewpoint *at = &point->at;
    Quatd q = quatd_from_axis_angle(z, (at->lon_deg + 90.0) * GEODESY_RAD_PER_DEG);
    q = quatd_mul(q, quatd_from_axis_angle(x, (90.0 - at->lat_deg) * GEODESY_RAD_PER_DEG));
    q = quatd_mul(q, quatd_from_axis_angle(z, -at->heading_deg * GEODESY_RAD_PER_DEG));
    q = quatd_mul(q, quatd_from_axis_angle(x, at->pitch_deg * GEODESY_RAD_PER_DEG));
    return quatd_mul(q, quatd_from_axis_angle(y, point->bank_deg * GEODESY_RAD_PER_DEG));
}

static Quatd blend(Quatd a, Quatd b, double to_a, double to_b) {
    return quatd_normalize(
        (Quatd){to_a * a.w + to_b * b.w, to_a * a.x + to_b * b.x, to_a * a.y + to_b * b.y, to_a * a.z + to_b * b.z});
}

// The short way round.
static Quatd slerp_attitude(Quatd a, Quatd b, double share) {
    double cosine = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z, side = cosine < 0.0 ? -1.0 : 1.0;
    double angle = acos(fmin(fabs(cosine), 1.0)), s = sin(angle);
    if (s < 1e-9)
        return blend(a, b, 1.0 - share, side * share);
    return blend(a, b, sin((1.0 - share) * angle) / s, side * sin(share * angle) / s);
}

static double bank_of(Quatd attitude, double lat_rad, double lon_rad) {
    Vec3d up = geodesy_up(lat_rad, lon_rad), right = quatd_rotate(attitude, vec3d(1, 0, 0));
    return atan2(-vec3d_dot(right, up), vec3d_dot(quatd_rotate(attitude, vec3d(0, 0, 1)), up)) / GEODESY_RAD_PER_DEG;
}

static double rounded(double value, double per_unit) {
    return round(value * per_unit) / per_unit;
}

static TrackState as_told(TrackState state) {
    Viewpoint at = state.at;
    state.at = (Viewpoint){.lat_deg = rounded(at.lat_deg, PLACE_PER_DEG),
                           .lon_deg = rounded(at.lon_deg, PLACE_PER_DEG),
                           .alt_m = rounded(at.alt_m, PER_M),
                           .heading_deg = rounded(at.heading_deg, DIRECTION_PER_DEG),
                           .pitch_deg = rounded(at.pitch_deg, DIRECTION_PER_DEG)};
    state.bank_deg = rounded(state.bank_deg, DIRECTION_PER_DEG);
    return state;
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

static TrackState state_of(const TrackPoint *point) {
    return as_told((TrackState){.at = point->at,
                                .bank_deg = point->bank_deg,
                                .derived = (point->flags & TRACK_DERIVED) != 0,
                                .has_pressure = (point->flags & TRACK_PRESSURE) != 0,
                                .pressure_m = (double)point->pressure_m});
}

static Geodetic place_between(const Track *track, int i, double share, Viewpoint *at) {
    Geodetic place = geodesy_from_ecef(hermite(track, i, share));
    at->lat_deg = place.lat_rad / GEODESY_RAD_PER_DEG;
    at->lon_deg = place.lon_rad / GEODESY_RAD_PER_DEG;
    at->alt_m = place.h_m;
    return place;
}

static TrackState state_between(const Track *track, int i, double share) {
    const TrackPoint *from = &track->points[i], *to = from + 1;
    double from_m = (double)from->pressure_m, to_m = (double)to->pressure_m;
    TrackState state = {.derived = ((from->flags | to->flags) & TRACK_DERIVED) != 0,
                        .has_pressure = (from->flags & to->flags & TRACK_PRESSURE) != 0,
                        .pressure_m = from_m + share * (to_m - from_m)};
    Geodetic place = place_between(track, i, share, &state.at);
    Vec3d forward;
    if (from->bank_deg == 0.0 && to->bank_deg == 0.0) {
        forward = slerp(viewpoint_forward(&from->at), viewpoint_forward(&to->at), share);
    } else {
        Quatd attitude = slerp_attitude(attitude_of(from), attitude_of(to), share);
        forward = quatd_rotate(attitude, vec3d(0, 1, 0));
        state.bank_deg = bank_of(attitude, place.lat_rad, place.lon_rad);
    }
    direction_at(forward, place.lat_rad, place.lon_rad, &state.at.heading_deg, &state.at.pitch_deg);
    return as_told(state);
}

TrackState track_state_at(const Track *track, double t_s) {
    double t = t_s + track->points[0].t_s;
    int i = point_before(track, t);
    const TrackPoint *from = &track->points[i];
    if (t <= from->t_s || i + 1 == track->count)
        return state_of(from);
    if (begins_anew(track, i + 1)) {
        TrackState held = state_of(from);
        held.in_gap = true;
        held.held_s = t - from->t_s;
        return held;
    }
    return state_between(track, i, (t - from->t_s) / (from[1].t_s - from->t_s));
}

Viewpoint track_at(const Track *track, double t_s) {
    return track_state_at(track, t_s).at;
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
        if (p->bank_deg != 0.0 || p->flags & TRACK_GAP) // none: as when tracks were of the eye alone
            hash = hash_number(hash_number(hash, p->bank_deg), p->flags & TRACK_GAP);
    }
    return hash;
}
