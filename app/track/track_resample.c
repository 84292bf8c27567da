// A track with its points at even times.
#include "app/track/track.h"
#include "base/log.h"

#include <math.h>
#include <stdlib.h>

#define SLACK 1e-6 // of an interval: times are rounded

// The last point before the next gap.
static int stretch_end(const Track *track, int first) {
    while (first + 1 < track->count && !(track->points[first + 1].flags & TRACK_GAP))
        first++;
    return first;
}

// Intervals of a stretch, the last of which may be shorter.
static double interval_count(const Track *track, int first, int last, double interval_s) {
    return ceil((track->points[last].t_s - track->points[first].t_s) / interval_s - SLACK);
}

static double count_points(const Track *track, double interval_s) {
    double count = 0.0;
    for (int first = 0, last; first < track->count; first = last + 1) {
        last = stretch_end(track, first);
        count += interval_count(track, first, last, interval_s) + 1.0;
    }
    return count;
}

static TrackPoint point_at(const Track *track, double t_s) {
    TrackState state = track_state_at(track, t_s - track->points[0].t_s);
    return (TrackPoint){.t_s = t_s,
                        .at = state.at,
                        .bank_deg = state.bank_deg,
                        .flags = (state.derived ? TRACK_DERIVED : 0U) | (state.has_pressure ? TRACK_PRESSURE : 0U),
                        .pressure_m = (float)state.pressure_m};
}

static int fill_stretch(const Track *track, int first, int last, double interval_s, TrackPoint *out) {
    int count = (int)interval_count(track, first, last, interval_s);
    out[0] = track->points[first];
    for (int i = 1; i < count; i++)
        out[i] = point_at(track, track->points[first].t_s + i * interval_s);
    if (count > 0)
        out[count] = track->points[last];
    return count + 1;
}

Result track_check_interval(const char *name, double points, double interval_s, double duration_s) {
    if (points <= TRACK_POINTS_MAX)
        return RESULT_OK;
    log_error("%s: %.0f points %g s apart, and %d are the most; take --interval %.3g or longer", name, points,
              interval_s, TRACK_POINTS_MAX, ceil(duration_s / TRACK_POINTS_MAX * 1e3) * 1e-3);
    return RESULT_RANGE;
}

Result track_resample(Track *track, double interval_s) {
    double count = count_points(track, interval_s);
    Result result = track_check_interval(track->name, count, interval_s, track_duration_s(track));
    if (result != RESULT_OK)
        return result;
    TrackPoint *points = malloc((size_t)count * sizeof *points);
    if (!points) {
        log_error("%s: no memory for %.0f points", track->name, count);
        return RESULT_MEMORY;
    }
    int filled = 0;
    for (int first = 0, last; first < track->count; first = last + 1) {
        last = stretch_end(track, first);
        filled += fill_stretch(track, first, last, interval_s, points + filled);
    }
    free(track->points);
    track->points = points;
    track->count = filled;
    return RESULT_OK;
}
