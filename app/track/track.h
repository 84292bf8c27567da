// app/track/track.h: a recorded flight of the eye: where it is and looks at each moment.
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

typedef struct TrackPoint {
    double t_s; // grows from point to point
    Viewpoint at;
} TrackPoint;

typedef struct Track {
    char name[TRACK_NAME_BYTES]; // "valley", or the file's name without folder and ending
    TrackPoint *points;
    int count; // >= 1
} Track;

// A flight over the world's terrain; the same terrain gives the same bits. RANGE: not one sample has data; MEMORY.
MUST_USE Result track_builtin(const World *world, TrackKind kind, Track *out);
// A CSV file: a line of column names (t_s, lat_deg, lon_deg, alt_m, and heading_deg, pitch_deg or neither; others are
// left alone, and so are lines that begin with '#'), then a line a point. Without directions the eye looks along its
// way. NOT_FOUND, IO, MEMORY; FORMAT names the file, the line, and what was expected.
MUST_USE Result track_read(const char *path, Track *out);
// The same file, with directions. True when all of it was taken.
bool track_write(const Track *track, FILE *to);
void track_clear(Track *track);

double track_duration_s(const Track *track);
// Positions are interpolated C1 (cubic Hermite with the slopes of the neighbours), directions along great circles;
// before the start and after the end it stands still. Rounded to what track_write and a command line can tell exactly:
// 1e-9 degrees of place, 1e-6 of direction, 1 mm.
Viewpoint track_at(const Track *track, double t_s);
// Of all points: to tell tracks apart.
uint64_t track_hash(const Track *track);

// The direction from one place to another, at the first; heading 0..360. The same place: north, level.
void track_look(const Viewpoint *from, const Viewpoint *to, double *heading_deg, double *pitch_deg);
