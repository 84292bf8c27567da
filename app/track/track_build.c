#include "app/track/track_build.h"

#include "app/track/track_attitude.h"
#include "base/log.h"
#include "base/statistics.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MEDIAN_SAMPLES 4096

TrackBuild track_build_begin(const char *path, Track *track) {
    *track = (Track){.start_unix_s = NAN};
    track_name_after(path, track->name);
    return (TrackBuild){.path = path, .track = track};
}

static Result grow(TrackBuild *b, int64_t line) {
    if (b->track->count < b->capacity)
        return RESULT_OK;
    if (b->capacity >= TRACK_POINTS_MAX) {
        log_error("%s:%lld: more than %d points; expected a shorter flight: cut the file in parts", b->path,
                  (long long)line, TRACK_POINTS_MAX);
        return RESULT_FORMAT;
    }
    int capacity = b->capacity ? 2 * b->capacity : 1024;
    capacity = capacity < TRACK_POINTS_MAX ? capacity : TRACK_POINTS_MAX;
    TrackPoint *points = realloc(b->track->points, sizeof *points * (size_t)capacity);
    if (!points) {
        log_error("%s: no memory for %d points", b->path, capacity);
        return RESULT_MEMORY;
    }
    b->track->points = points;
    b->capacity = capacity;
    return RESULT_OK;
}

static bool within(double value, double least, double greatest) {
    return isfinite(value) && value >= least && value <= greatest;
}

static bool is_place(const TrackPoint *p) {
    return within(p->t_s, -1e12, 1e12) && within(p->at.lat_deg, -90, 90) && within(p->at.lon_deg, -540, 540) &&
           within(p->at.alt_m, TRACK_DEPTH_MIN_M, TRACK_HEIGHT_MAX_M) && within(p->at.heading_deg, -720, 720) &&
           within(p->at.pitch_deg, -90, 90) && within(p->bank_deg, -720, 720);
}

Result track_build_add(TrackBuild *b, int64_t line, const TrackPoint *point) {
    Track *track = b->track;
    const TrackPoint *last = track->count > 0 ? &track->points[track->count - 1] : NULL;
    TrackSkip why = !is_place(point)                  ? TRACK_SKIP_MALFORMED
                    : last && point->t_s == last->t_s ? TRACK_SKIP_DUPLICATE
                    : last && point->t_s < last->t_s  ? TRACK_SKIP_BACKWARD
                                                      : TRACK_SKIP_COUNT;
    if (why != TRACK_SKIP_COUNT) {
        track_build_skip(b, why, line);
        return RESULT_OK;
    }
    Result result = grow(b, line);
    if (result != RESULT_OK)
        return result;
    TrackPoint *added = &track->points[track->count++];
    *added = *point;
    if (b->gap && track->count > 1)
        added->flags |= TRACK_GAP;
    b->gap = false;
    return RESULT_OK;
}

void track_build_skip(TrackBuild *b, TrackSkip why, int64_t line) {
    if (b->track->skipped[why]++ == 0)
        b->first_line[why] = line;
}

void track_build_gap(TrackBuild *b) {
    b->gap = true;
}

void track_build_other(TrackBuild *b, const char *id, const char *name) {
    int i = 0;
    while (i < b->other_count && strcmp(b->others[i].id, id) != 0)
        i++;
    b->more_others |= i == TRACK_OTHERS_MAX;
    if (!b->asked || i == TRACK_OTHERS_MAX)
        return;
    TrackOther *other = &b->others[i];
    if (i == b->other_count)
        snprintf(b->others[b->other_count++].id, sizeof other->id, "%s", id);
    if (name && !other->name[0]) // may come later than the first place
        snprintf(other->name, sizeof other->name, "%s", name);
}

void track_build_restart(TrackBuild *b) {
    int64_t other = b->track->skipped[TRACK_SKIP_OTHER] + b->track->count;
    memset(b->track->skipped, 0, sizeof b->track->skipped);
    b->track->skipped[TRACK_SKIP_OTHER] = other;
    b->track->count = 0;
    b->gap = false;
}

// ---- at the end ----

static void warn_of_skipped(const TrackBuild *b) {
    static const TrackSkip told[] = {TRACK_SKIP_MALFORMED, TRACK_SKIP_BACKWARD, TRACK_SKIP_UNTIMED,
                                     TRACK_SKIP_NO_HEIGHT};
    for (size_t i = 0; i < COUNT_OF(told); i++) {
        long long line = (long long)b->first_line[told[i]], count = (long long)b->track->skipped[told[i]];
        if (count == 1)
            log_warn("%s:%lld: a point %s, which is left out", b->path, line, track_skip_what(told[i]));
        else if (count > 1)
            log_warn("%s:%lld: a point %s, the first of %lld that are left out", b->path, line,
                     track_skip_what(told[i]), count);
    }
}

static Result refuse(const TrackBuild *b, TrackSkip why, const char *remedy) {
    log_error("%s:%lld: a point %s, the first of %lld; %d are left: %s", b->path, (long long)b->first_line[why],
              track_skip_what(why), (long long)b->track->skipped[why], b->track->count, remedy);
    return RESULT_FORMAT;
}

static const char *remedy_of(TrackSkip why) {
    static const char *const remedies[TRACK_SKIP_COUNT] = {
        [TRACK_SKIP_INVALID] = "the recorder had no position",
        [TRACK_SKIP_MALFORMED] = "the file is damaged or of another kind",
        [TRACK_SKIP_BACKWARD] = "sort the file by time, or take away what stands before that line",
        [TRACK_SKIP_DUPLICATE] = "the recorder's clock stood still",
        [TRACK_SKIP_UNTIMED] = "a route, not a flight: give its points times",
        [TRACK_SKIP_NO_HEIGHT] = "give its points heights",
        [TRACK_SKIP_OTHER] = "name one that is there with --object",
    };
    return remedies[why];
}

static Result refuse_asked(const TrackBuild *b) {
    char list[TRACK_OTHERS_MAX * (sizeof(TrackOther) + 8)];
    int used = 0;
    for (int i = 0; i < b->other_count; i++) {
        const TrackOther *other = &b->others[i];
        used += snprintf(list + used, sizeof list - (size_t)used, other->name[0] ? "%s%s '%s'" : "%s%s", i ? ", " : "",
                         other->id, other->name);
    }
    log_error("%s: no flight of '%s'; there are: %s%s; name one of them with --object", b->path, b->asked, list,
              b->more_others ? ", and more" : "");
    return RESULT_FORMAT;
}

static Result refuse_empty(const TrackBuild *b) {
    bool others_alone = b->track->skipped[TRACK_SKIP_OTHER] > 0;
    for (int why = 0; why < TRACK_SKIP_COUNT; why++)
        others_alone &= why == TRACK_SKIP_OTHER || b->track->skipped[why] == 0;
    if (others_alone && b->other_count > 0)
        return refuse_asked(b);
    for (int why = 0; why < TRACK_SKIP_COUNT; why++)
        if (b->track->skipped[why] > 0)
            return refuse(b, (TrackSkip)why, remedy_of((TrackSkip)why));
    log_error("%s: no points of a flight; expected at least one with time and place", b->path);
    return RESULT_FORMAT;
}

Result track_build_check(const TrackBuild *b) {
    if (b->track->count == 0)
        return refuse_empty(b);
    if (b->track->skipped[TRACK_SKIP_BACKWARD] > b->track->count)
        return refuse(b, TRACK_SKIP_BACKWARD, remedy_of(TRACK_SKIP_BACKWARD));
    if (b->track->skipped[TRACK_SKIP_MALFORMED] > b->track->count)
        return refuse(b, TRACK_SKIP_MALFORMED, remedy_of(TRACK_SKIP_MALFORMED));
    warn_of_skipped(b);
    return RESULT_OK;
}

Result track_build_end(TrackBuild *b, bool is_utc) {
    Result result = track_build_check(b);
    if (result != RESULT_OK)
        return result;
    Track *track = b->track;
    double start = track->points[0].t_s;
    track->start_unix_s = is_utc ? start : NAN;
    for (int i = 0; i < track->count; i++)
        track->points[i].t_s -= start;
    track_mark_gaps(track);
    return track_derive_attitude(track);
}

static Vec3d place_of(const TrackPoint *point) {
    return geodesy_to_ecef(
        (Geodetic){point->at.lat_deg * GEODESY_RAD_PER_DEG, point->at.lon_deg * GEODESY_RAD_PER_DEG, point->at.alt_m});
}

static double interval_s(const Track *track, int i) {
    return track->points[i].t_s - track->points[i - 1].t_s;
}

static double speed_m_s(const Track *track, int i) {
    return vec3d_distance(place_of(&track->points[i]), place_of(&track->points[i - 1])) / interval_s(track, i);
}

// Of at most MEDIAN_SAMPLES legs, evenly taken.
static double median(const Track *track, double (*of)(const Track *track, int i)) {
    double values[MEDIAN_SAMPLES];
    int legs = track->count - 1, count = legs < MEDIAN_SAMPLES ? legs : MEDIAN_SAMPLES;
    for (int k = 0; k < count; k++)
        values[k] = of(track, 1 + (int)((int64_t)legs * k / count));
    statistics_sort(values, count);
    return statistics_percentile(values, count, 0.5);
}

void track_mark_gaps(Track *track) {
    double gap_s = fmax(TRACK_GAP_S, TRACK_GAP_INTERVALS * median(track, interval_s));
    double jump_m_s = fmax(TRACK_JUMP_M_S, TRACK_JUMP_SPEEDS * median(track, speed_m_s));
    for (int i = 1; i < track->count; i++)
        if (interval_s(track, i) > gap_s || speed_m_s(track, i) > jump_m_s)
            track->points[i].flags |= TRACK_GAP;
}

void track_name_after(const char *path, char out[TRACK_NAME_BYTES]) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    int length = dot && dot > name ? (int)(dot - name) : (int)strlen(name);
    snprintf(out, TRACK_NAME_BYTES, "%.*s", length, name);
}
