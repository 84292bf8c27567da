#define _POSIX_C_SOURCE 200809L
#include "app/replay/playback.h"

#include "app/aircraft/isa.h"
#include "app/flight/flight_recorder.h"
#include "app/recording/recording_player.h"
#include "app/track/track_time.h"
#include "base/log.h"
#include "terrain/geodesy.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define SLOPE_S 0.05   // to either side: how speed and turning are got from places and attitudes
#define LAND_LOOKS 200 // points of a track that are looked for over the ground

struct Playback {
    const Geoid *geoid;
    Track track; // where it is no recording
    // Where it is one:
    RecordingReader *reader;
    RecordingPlayer *player;
    Aircraft aircraft;
    const char *aircraft_name; // the options' or the reader's
    Flight flight, scouted;
    RecordingSim sim, scout_sim;
    RecordingPlayer *scout;
    uint32_t first, end; // steps
    double step_s;
};

// ---- opening ----

// The first bytes of a file; 0: there are none to be had. A pipe would be waited for.
static size_t read_begin(const char *path, uint8_t *out, size_t most) {
    struct stat about;
    if (stat(path, &about) != 0 || !S_ISREG(about.st_mode))
        return 0;
    FILE *file = fopen(path, "rb");
    size_t count = file ? fread(out, 1, most, file) : 0;
    if (file)
        fclose(file);
    return count;
}

bool playback_is_recording(const char *path) {
    uint8_t begin[RECORDING_MAGIC_BYTES];
    return read_begin(path, begin, sizeof begin) == sizeof begin && recording_is_one(begin);
}

Result playback_read_header(const char *path, RecordingHeader *out) {
    uint8_t begin[RECORDING_HEADER_BYTES_MAX];
    size_t count = read_begin(path, begin, sizeof begin), header_bytes;
    uint32_t crc;
    return recording_header_decode(path, begin, count, out, &header_bytes, &crc);
}

static void warn_of_differences(const RecordingHeader *header, const Playback *playback, uint64_t dem_hash) {
    char hash[32];
    snprintf(hash, sizeof hash, "%016" PRIx64, dem_hash);
    if (strcmp(hash, header->environment[RECORDING_DEM_HASH]) != 0)
        log_warn("recorded over another elevation model (%s): near the ground the flight differs",
                 header->environment[RECORDING_DEM]);
    snprintf(hash, sizeof hash, "%016" PRIx64, flight_recording_aircraft_hash(&playback->aircraft));
    if (strcmp(hash, header->environment[RECORDING_AIRCRAFT_HASH]) == 0)
        return;
    const char *recorded = header->environment[RECORDING_AIRCRAFT];
    if (strcmp(recorded, playback->aircraft_name) == 0)
        log_warn("recorded with other figures of the aircraft '%s': the flight differs from its first step on",
                 recorded);
    else
        log_warn("recorded with the aircraft '%s', and the figures of '%s' are others: the flight differs from its "
                 "first step on",
                 recorded, playback->aircraft_name);
}

static Result load_aircraft(const char *path, const RecordingHeader *header, const char *named, Playback *playback) {
    playback->aircraft_name = named ? named : header->environment[RECORDING_AIRCRAFT];
    char file[PATHS_BYTES_MAX];
    Result result = aircraft_find(named ? "--aircraft" : path, playback->aircraft_name, file);
    if (result == RESULT_OK)
        result = aircraft_read(file, &playback->aircraft);
    if (result != RESULT_OK && !named)
        log_info("%s was recorded with the aircraft '%s'; have it there again, or name it as it is here: "
                 "--aircraft NAME|FILE",
                 path, playback->aircraft_name);
    return result;
}

static Result open_recording(const char *path, const PlaybackOptions *options, Playback *playback) {
    Result result = recording_reader_open(path, &playback->reader);
    if (result != RESULT_OK)
        return result;
    const RecordingHeader *header = recording_reader_header(playback->reader);
    result = load_aircraft(path, header, options->aircraft, playback);
    if (result != RESULT_OK)
        return result;
    warn_of_differences(header, playback, options->dem_hash);
    playback->flight = (Flight){.aircraft = &playback->aircraft, .ground = options->ground};
    flight_recording_weather(header, &playback->flight);
    playback->scouted = playback->flight;
    playback->sim = flight_sim(&playback->flight);
    playback->scout_sim = flight_sim(&playback->scouted);
    playback->first = recording_reader_first(playback->reader);
    playback->end = recording_reader_end(playback->reader);
    playback->step_s = 1.0 / header->steps_per_s;
    result = recording_player_create(playback->reader, &playback->sim, &playback->player);
    return result == RESULT_OK ? recording_player_create(playback->reader, &playback->scout_sim, &playback->scout)
                               : result;
}

static void warn_of_other_land(const char *path, const Track *track, const FlightGround *ground) {
    const Viewpoint *begin = &track->points[0].at;
    double height_m;
    for (int i = 0; ground->height && i < LAND_LOOKS; i++) {
        const Viewpoint *at = &track->points[(int64_t)i * (track->count - 1) / (LAND_LOOKS - 1)].at;
        if (ground->height(ground->user, at->lat_deg * GEODESY_RAD_PER_DEG, at->lon_deg * GEODESY_RAD_PER_DEG,
                           &height_m))
            return;
    }
    if (ground->height)
        log_warn("%s: the flight is nowhere over this land, it begins at %.4f, %.4f: name an elevation model of there "
                 "after it",
                 path, begin->lat_deg, begin->lon_deg);
}

static Result open_track(const char *path, const PlaybackOptions *options, Playback *playback) {
    Result result = track_load(path, &options->how, &playback->track);
    if (result == RESULT_OK)
        warn_of_other_land(path, &playback->track, &options->ground);
    return result;
}

Result playback_open(const char *path, const PlaybackOptions *options, Playback **out) {
    Playback *playback = calloc(1, sizeof *playback);
    if (!playback) {
        log_error("%s: no memory for a replay", path);
        return RESULT_MEMORY;
    }
    playback->geoid = options->how.geoid;
    Result result =
        playback_is_recording(path) ? open_recording(path, options, playback) : open_track(path, options, playback);
    if (result == RESULT_OK)
        *out = playback;
    else
        playback_close(&playback);
    return result;
}

void playback_close(Playback **playback) {
    if (!*playback)
        return;
    recording_player_destroy(&(*playback)->player);
    recording_player_destroy(&(*playback)->scout);
    recording_reader_close(&(*playback)->reader);
    track_clear(&(*playback)->track);
    free(*playback);
    *playback = NULL;
}

const RecordingHeader *playback_header(const Playback *playback) {
    return playback->reader ? recording_reader_header(playback->reader) : NULL;
}

double playback_duration_s(const Playback *playback) {
    return playback->reader ? (playback->end - playback->first) * playback->step_s : track_duration_s(&playback->track);
}

const char *playback_format(const Playback *playback) {
    return playback->reader ? "ofr" : playback->track.format;
}

const Aircraft *playback_aircraft(const Playback *playback) {
    return playback->reader ? &playback->aircraft : NULL;
}

const char *playback_aircraft_name(const Playback *playback) {
    return playback->aircraft_name;
}

Vec3d playback_wind(const Playback *playback) {
    return playback->flight.wind_ecef;
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

// Speed and turning at a time, from this side of any gap; none where a point stands alone.
static void take_motion(const Playback *playback, double t_s, FlightState *state) {
    const Track *track = &playback->track;
    double before_s = fmax(t_s - SLOPE_S, 0.0), after_s = fmin(t_s + SLOPE_S, track_duration_s(track));
    TrackState at = track_state_at(track, t_s), before = track_state_at(track, before_s),
               after = track_state_at(track, after_s);
    if (before.in_gap) {
        before = at;
        before_s = t_s;
    }
    if (after.in_gap) {
        after = at;
        after_s = t_s;
    }
    if (!(after_s > before_s))
        return;
    double share = 1.0 / (after_s - before_s);
    Vec3d way = vec3d_sub(place_of(playback, &after), place_of(playback, &before));
    state->velocity_ecef = vec3d_scale(way, share);
    state->rate_body = vec3d_scale(turn_between(attitude_of(&before), attitude_of(&after)), share);
}

static PlaybackMoment moment_of_track(const Playback *playback, double t_s) {
    const TrackState at = track_state_at(&playback->track, t_s);
    PlaybackMoment moment = {.only_path = true, .in_gap = at.in_gap, .derived = at.derived};
    moment.state.position_ecef = place_of(playback, &at);
    moment.state.ecef_from_body = attitude_of(&at);
    if (!at.in_gap)
        take_motion(playback, t_s, &moment.state);
    return moment;
}

// In a gap as the aircraft went into it, not standing still.
static PlaybackMoment moving_moment_of_track(const Playback *playback, double t_s) {
    PlaybackMoment moment = moment_of_track(playback, t_s);
    if (moment.in_gap)
        take_motion(playback, t_s - track_state_at(&playback->track, t_s).held_s, &moment.state);
    return moment;
}

// ---- a recording ----

static Vec3d between(Vec3d a, Vec3d b, double share) {
    return vec3d_mad(a, vec3d_sub(b, a), share);
}

static Quatd turned_between(Quatd a, Quatd b, double share) {
    double sign = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z < 0.0 ? -share : share, rest = 1.0 - share;
    return quatd_normalize(
        (Quatd){a.w * rest + b.w * sign, a.x * rest + b.x * sign, a.y * rest + b.y * sign, a.z * rest + b.z * sign});
}

// The state before a step, or the last one that can be had.
static FlightState state_at(Playback *playback, int64_t step) {
    if (recording_player_seek(playback->player, step) != RESULT_OK)
        log_debug("replay: the state before step %" PRId64 " cannot be had", step);
    return playback->flight.state;
}

// Whether the aircraft came to the state at `step` by flying: not by a new start, of a person or after a crash.
static bool was_flown(const Playback *playback, const FlightState *before, int64_t step, const FlightState *at) {
    int index = recording_reader_segment_at(playback->reader, (uint32_t)step);
    const RecordingSegment *segment = recording_reader_segment(playback->reader, index);
    bool set = segment->first == step && !segment->follows;
    return !set && !(before->contact == FLIGHT_CRASHED && at->contact != FLIGHT_CRASHED);
}

// The step that a time is in, and the share of it that has passed.
static int64_t step_of(const Playback *playback, double t_s, double *share) {
    double at = playback->first + fmax(t_s, 0.0) / playback->step_s + 1e-6; // times of steps are rounded
    int64_t step = (int64_t)fmin(at, (double)playback->end);
    *share = at - (double)step;
    return step;
}

static PlaybackMoment moment_of_step(Playback *playback, int64_t step) {
    PlaybackMoment moment = {.state = state_at(playback, step)};
    moment.in_gap = recording_player_is_in_gap(playback->player);
    return moment;
}

// Between two steps what is seen goes on evenly; states that are no steps are for looking at only.
static PlaybackMoment moment_of_recording(Playback *playback, double t_s) {
    double share;
    int64_t step = step_of(playback, t_s, &share);
    PlaybackMoment moment = moment_of_step(playback, step);
    if (share < 1e-4 || step >= playback->end || moment.in_gap)
        return moment;
    FlightState next = state_at(playback, step + 1);
    if (!was_flown(playback, &moment.state, step + 1, &next))
        return moment;
    moment.state.position_ecef = between(moment.state.position_ecef, next.position_ecef, share);
    moment.state.velocity_ecef = between(moment.state.velocity_ecef, next.velocity_ecef, share);
    moment.state.ecef_from_body = turned_between(moment.state.ecef_from_body, next.ecef_from_body, share);
    return moment;
}

int64_t playback_first_difference(const Playback *playback) {
    return playback->reader ? recording_player_first_difference(playback->player) : -1;
}

uint32_t playback_first_step(const Playback *playback) {
    return playback->first;
}

Result playback_events(Playback *playback, RecordingEvent **out, int *count) {
    return playback->reader ? recording_reader_events(playback->reader, out, count) : RESULT_UNSUPPORTED;
}

Result playback_verify(Playback *playback, RecordingVerdict *out) {
    return playback->reader ? recording_verify(playback->reader, &playback->sim, out) : RESULT_UNSUPPORTED;
}

PlaybackMoment playback_at(Playback *playback, double t_s) {
    return playback->reader ? moment_of_recording(playback, t_s) : moment_of_track(playback, t_s);
}

PlaybackMoment playback_at_step(Playback *playback, double t_s) {
    double share;
    return playback->reader ? moment_of_step(playback, step_of(playback, t_s, &share))
                            : moving_moment_of_track(playback, t_s);
}

PlaybackMoment playback_scout(Playback *playback, double t_s) {
    double share;
    if (!playback->reader)
        return moment_of_track(playback, t_s);
    Result result = recording_player_seek(playback->scout, step_of(playback, t_s, &share));
    return (PlaybackMoment){.state = playback->scouted.state,
                            .in_gap = result != RESULT_OK || recording_player_is_in_gap(playback->scout)};
}

bool playback_controls(Playback *playback, double t_s, Controls *out) {
    double share;
    RecordingStep step = {.known = false};
    if (!playback->reader || playback->end == playback->first)
        return false;
    int64_t at = step_of(playback, t_s, &share), last = (int64_t)playback->end - 1;
    Result result = recording_reader_steps(playback->reader, (uint32_t)(at < last ? at : last), 1, &step);
    *out = recording_controls(step.code);
    return result == RESULT_OK && step.known;
}

// ---- as a track ----

static TrackPoint point_of(const Playback *playback, const PlaybackMoment *moment, double t_s, bool after_gap) {
    Flight flight = playback->flight;
    flight.state = moment->state;
    FlightInstruments now = flight_instruments(&flight);
    double lat_deg = now.lat_rad / GEODESY_RAD_PER_DEG, lon_deg = now.lon_rad / GEODESY_RAD_PER_DEG;
    return (TrackPoint){.t_s = t_s,
                        .at = {lat_deg, lon_deg, now.h_m - geoid_undulation_m(playback->geoid, lat_deg, lon_deg),
                               now.heading_rad / GEODESY_RAD_PER_DEG, now.pitch_rad / GEODESY_RAD_PER_DEG},
                        .bank_deg = now.bank_rad / GEODESY_RAD_PER_DEG,
                        .flags = TRACK_PRESSURE | (after_gap ? TRACK_GAP : 0U),
                        .pressure_m = (float)isa_pressure_altitude(now.h_m)};
}

// Whether something is lost, or set anew, after the segment `from` up to the segment `to`.
static bool is_torn(const Playback *playback, int from, int to) {
    for (int i = from + 1; i <= to; i++)
        if (!recording_reader_segment(playback->reader, i)->follows)
            return true;
    return false;
}

static void fill_track(Playback *playback, double interval_s, int most, Track *out) {
    FlightContact contact = FLIGHT_AIRBORNE;
    int segment = 0;
    for (int i = 0; i < most; i++) {
        double t_s = fmin(i * interval_s, playback_duration_s(playback)), share;
        PlaybackMoment moment = playback_at(playback, t_s);
        if (moment.in_gap)
            continue;
        int now = recording_reader_segment_at(playback->reader, (uint32_t)step_of(playback, t_s, &share));
        bool anew = contact == FLIGHT_CRASHED && moment.state.contact != FLIGHT_CRASHED;
        out->points[out->count++] =
            point_of(playback, &moment, t_s, i > 0 && (anew || is_torn(playback, segment, now)));
        segment = now;
        contact = moment.state.contact;
    }
}

static void warn_of_difference(const Playback *playback) {
    char when[RECORDING_TIME_BYTES];
    int64_t step = playback_first_difference(playback);
    if (step >= 0)
        log_warn("%s: flown again it is another flight from step %" PRId64 " on (%s): what is taken is what was flown "
                 "now",
                 recording_reader_path(playback->reader), step,
                 recording_time_text((uint64_t)step, RECORDING_STEPS_PER_S, when));
}

Result playback_track(Playback *playback, double interval_s, Track *out) {
    if (!playback->reader)
        return RESULT_UNSUPPORTED;
    const RecordingHeader *header = recording_reader_header(playback->reader);
    double count = floor(playback_duration_s(playback) / interval_s + 1e-6) + 1.0;
    Result result =
        track_check_interval(recording_reader_path(playback->reader), count, interval_s, playback_duration_s(playback));
    if (result != RESULT_OK)
        return result;
    int most = (int)count;
    *out = (Track){.format = "ofr", .heights = TRACK_HEIGHTS_ELLIPSOID, .start_unix_s = NAN};
    snprintf(out->name, sizeof out->name, "%.40s", playback->aircraft.id);
    if (track_time_read(header->environment[RECORDING_START_UTC], &out->start_unix_s))
        out->start_unix_s += playback->first * playback->step_s;
    out->points = calloc((size_t)most, sizeof *out->points);
    if (!out->points) {
        log_error("no memory for a track of %d points", most);
        return RESULT_MEMORY;
    }
    fill_track(playback, interval_s, most, out);
    warn_of_difference(playback);
    return RESULT_OK;
}

Result playback_load_track(const char *path, const PlaybackOptions *options, double interval_s, Track *out) {
    Playback *playback = NULL;
    Result result = playback_open(path, options, &playback);
    if (result == RESULT_OK)
        result = playback_track(playback, interval_s, out);
    playback_close(&playback);
    return result;
}
