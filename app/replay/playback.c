#include "app/replay/playback.h"

#include "base/log.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <stdlib.h>

#define SLOPE_S 0.05 // to either side: how speed and turning are got from places and attitudes

struct Playback {
    Track track;
    const Geoid *geoid;
};

Result playback_open(const char *path, const TrackReading *how, Playback **out) {
    Playback *playback = calloc(1, sizeof *playback);
    if (!playback) {
        log_error("%s: no memory for a replay", path);
        return RESULT_MEMORY;
    }
    playback->geoid = how->geoid;
    Result result = track_load(path, how, &playback->track);
    if (result == RESULT_OK)
        *out = playback;
    else
        playback_close(&playback);
    return result;
}

void playback_close(Playback **playback) {
    if (!*playback)
        return;
    track_clear(&(*playback)->track);
    free(*playback);
    *playback = NULL;
}

double playback_duration_s(const Playback *playback) {
    return track_duration_s(&playback->track);
}

const char *playback_format(const Playback *playback) {
    return playback->track.format;
}

// ---- a track ----

static Vec3d place_of(const Playback *playback, const TrackState *at) {
    double undulation_m = geoid_undulation_m(playback->geoid, at->at.lat_deg, at->at.lon_deg);
    return geodesy_to_ecef((Geodetic){at->at.lat_deg * GEODESY_RAD_PER_DEG, at->at.lon_deg * GEODESY_RAD_PER_DEG,
                                      at->at.alt_m + undulation_m});
}

static Quatd attitude_of(const TrackState *at) {
    return flight_attitude(at->at.lat_deg * GEODESY_RAD_PER_DEG, at->at.lon_deg * GEODESY_RAD_PER_DEG,
                           at->at.heading_deg * GEODESY_RAD_PER_DEG, at->at.pitch_deg * GEODESY_RAD_PER_DEG,
                           at->bank_deg * GEODESY_RAD_PER_DEG);
}

// Twice the vector part, for small turns the angle about each body axis.
static Vec3d turn_between(Quatd from, Quatd to) {
    Quatd turn = quatd_mul(quatd_conjugate(from), to);
    double sign = turn.w < 0.0 ? -2.0 : 2.0;
    return vec3d(sign * turn.x, sign * turn.y, sign * turn.z);
}

static PlaybackMoment moment_of_track(const Playback *playback, double t_s) {
    double last_s = track_duration_s(&playback->track);
    double before_s = fmax(t_s - SLOPE_S, 0.0), after_s = fmin(t_s + SLOPE_S, last_s);
    const TrackState at = track_state_at(&playback->track, t_s);
    PlaybackMoment moment = {.only_path = true, .in_gap = at.in_gap, .derived = at.derived};
    moment.state.position_ecef = place_of(playback, &at);
    moment.state.ecef_from_body = attitude_of(&at);
    if (at.in_gap || !(after_s > before_s))
        return moment;
    const TrackState before = track_state_at(&playback->track, before_s),
                     after = track_state_at(&playback->track, after_s);
    if (before.in_gap || after.in_gap)
        return moment;
    double share = 1.0 / (after_s - before_s);
    Vec3d way = vec3d_sub(place_of(playback, &after), place_of(playback, &before));
    moment.state.velocity_ecef = vec3d_scale(way, share);
    moment.state.rate_body = vec3d_scale(turn_between(attitude_of(&before), attitude_of(&after)), share);
    return moment;
}

PlaybackMoment playback_at(Playback *playback, double t_s) {
    return moment_of_track(playback, t_s);
}
