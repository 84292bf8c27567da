// app/track/track.h: a recorded flight: where the eye or an aircraft is, and how it is turned, at each moment.
// Seconds from the first point, degrees, metres above the geoid; heading clockwise from north, pitch up.
// A Track owns its points and is constant once made; any thread may read it.
#pragma once
#include "app/scene_load.h"
#include "app/viewpoint.h"
#include "base/base.h"

#include <stdio.h>

#define TRACK_NAME_BYTES 64
#define TRACK_POINTS_MAX 4000000 // more are refused before they take memory

// X(identifier, name, what it is): the flights that any terrain has, found in its own shape.
#define TRACK_KIND_TABLE(X)                                                                                            \
    X(VALLEY, "valley", "along low ground, from edge to edge")                                                         \
    X(RIDGE, "ridge", "along high ground, from edge to edge")                                                          \
    X(PASS, "pass", "from low ground over a high saddle between two summits, and down again")                          \
    X(DIVE, "dive", "from high above down to the highest relief, and level before it")                                 \
    X(TURN, "turn", "once round on the spot, above the highest ground of the ridge")

typedef enum TrackKind {
#define TRACK_ENUM(id, name, what) TRACK_##id,
    TRACK_KIND_TABLE(TRACK_ENUM) TRACK_KIND_COUNT
#undef TRACK_ENUM
} TrackKind;
const char *track_kind_name(TrackKind kind); // "valley"
const char *track_kind_what(TrackKind kind);
bool track_kind_find(const char *name, TrackKind *out);

enum TrackPointFlag {
    TRACK_GAP = 1,     // nothing is known of the time since the point before: nothing may be interpolated across
    TRACK_DERIVED = 2, // heading, pitch and bank were worked out from the path
    TRACK_PRESSURE = 4 // its pressure altitude is known
};

typedef struct TrackPoint {
    double t_s; // grows from point to point
    Viewpoint at;
    double bank_deg;  // right wing down, -180..180
    unsigned flags;   // of TrackPointFlag
    float pressure_m; // in the standard atmosphere; with TRACK_PRESSURE
} TrackPoint;

// X(identifier, name in JSON, what altitudes are measured from)
#define TRACK_HEIGHTS_TABLE(X)                                                                                         \
    X(GEOID, "geoid", "above the geoid, as the file says")                                                             \
    X(GEOID_ASSUMED, "geoid assumed", "taken as above the geoid: the file does not say")                               \
    X(GEOID_ASKED, "geoid as asked", "taken as above the geoid, as asked for")                                         \
    X(GEOID_HEIGHT, "geoidheight", "above the file's geoid, carried over to EGM96 by its geoidheight")                 \
    X(ELLIPSOID, "ellipsoid", "above the ellipsoid, as the file says; converted to the geoid EGM96")                   \
    X(ELLIPSOID_ASSUMED, "ellipsoid assumed",                                                                          \
      "taken as above the ellipsoid, by the format's specification; converted to the geoid EGM96")                     \
    X(ELLIPSOID_ASKED, "ellipsoid as asked",                                                                           \
      "taken as above the ellipsoid, as asked for; converted to the geoid EGM96")                                      \
    X(PRESSURE, "pressure", "pressure altitudes of the standard atmosphere, as they are: not metres above the geoid")

typedef enum TrackHeights {
#define TRACK_HEIGHTS_ENUM(id, name, what) TRACK_HEIGHTS_##id,
    TRACK_HEIGHTS_TABLE(TRACK_HEIGHTS_ENUM) TRACK_HEIGHTS_COUNT
#undef TRACK_HEIGHTS_ENUM
} TrackHeights;
const char *track_heights_name(TrackHeights heights);
const char *track_heights_what(TrackHeights heights);

// X(identifier, name in JSON, why points of a file were left out)
#define TRACK_SKIP_TABLE(X)                                                                                            \
    X(INVALID, "invalid", "without a valid position")                                                                  \
    X(MALFORMED, "malformed", "damaged")                                                                               \
    X(BACKWARD, "backward", "going back in time")                                                                      \
    X(DUPLICATE, "duplicate", "of the same time as the one before")                                                    \
    X(UNTIMED, "untimed", "without a time")                                                                            \
    X(NO_HEIGHT, "no_height", "without a height")                                                                      \
    X(OTHER, "other", "of other tracks or objects")

typedef enum TrackSkip {
#define TRACK_SKIP_ENUM(id, name, what) TRACK_SKIP_##id,
    TRACK_SKIP_TABLE(TRACK_SKIP_ENUM) TRACK_SKIP_COUNT
#undef TRACK_SKIP_ENUM
} TrackSkip;
const char *track_skip_name(TrackSkip skip);
const char *track_skip_what(TrackSkip skip);

typedef struct Track {
    char name[TRACK_NAME_BYTES]; // "valley", or the file's name without folder and ending
    TrackPoint *points;
    int count;            // >= 1
    double start_unix_s;  // UTC of the first point, seconds since 1970 without leap seconds; NaN: unknown
    const char *format;   // what it was read from ("igc"), static; NULL: made here
    TrackHeights heights; // what is known of its altitudes
    int64_t skipped[TRACK_SKIP_COUNT];
} Track;

// A flight over the world's terrain; the same terrain gives the same bits. RANGE: not one sample has data; MEMORY.
MUST_USE Result track_builtin(const World *world, TrackKind kind, Track *out);
// CSV, with directions; bank, gaps, what is derived and the time where any point has them. True when all of it was
// taken.
bool track_write(const Track *track, FILE *to);
MUST_USE Result track_copy(const Track *track, Track *out); // MEMORY, logged
void track_clear(Track *track);

double track_duration_s(const Track *track);
int track_gap_count(const Track *track);
bool track_is_derived(const Track *track);   // the attitude of any point
bool track_has_pressure(const Track *track); // pressure altitudes of all points, beside the others or in their place

typedef struct TrackState {
    Viewpoint at;
    double bank_deg; // right wing down, -180..180
    bool in_gap;     // nothing is known of this time: the last point before it is held
    bool derived;    // the attitude was worked out from the path
    double held_s;   // in a gap since that point, 0 else
    bool has_pressure;
    double pressure_m; // in the standard atmosphere, between two points on a straight line; with has_pressure
} TrackState;

// `t_s` from the first point. Positions are interpolated C1 (cubic Hermite with the slopes of the neighbours), attitude
// by slerp; between two points without bank the direction goes along a great circle and stays level. Across a gap
// nothing is interpolated; before the start and after the end it stands still. Rounded to what track_write and a
// command line can tell exactly: 1e-9 degrees of place, 1e-6 of direction, 1 mm.
TrackState track_state_at(const Track *track, double t_s);
// The eye of track_state_at.
Viewpoint track_at(const Track *track, double t_s);
// Of all points: to tell tracks apart.
uint64_t track_hash(const Track *track);

// A point every `interval_s` instead of those there are, interpolated as by track_state_at; each stretch without a gap
// begins with its first point and ends with its last. MEMORY; RANGE, logged: more points than tracks have.
MUST_USE Result track_resample(Track *track, double interval_s);
// Whether a track may have so many points so far apart; else RANGE, logged with an interval that would do.
MUST_USE Result track_check_interval(const char *name, double points, double interval_s, double duration_s);

// The direction from one place to another, at the first; heading 0..360. The same place: north, level.
void track_look(const Viewpoint *from, const Viewpoint *to, double *heading_deg, double *pitch_deg);
