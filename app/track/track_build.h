// app/track/track_build.h: what every reader of tracks does with a point: order, limits, gaps, and what was left out.
// Seconds of any origin until track_build_end, from the first point afterwards; degrees; metres above the geoid.
// A TrackBuild borrows the path and the Track it fills. One thread.
#pragma once
#include "app/track/track.h"

#define TRACK_GAP_S 10.0        // longer than this,
#define TRACK_GAP_INTERVALS 5.0 // and than so many times the median interval: a gap
#define TRACK_JUMP_M_S 1000.0   // faster than this,
#define TRACK_JUMP_SPEEDS 5.0   // and than so many times the median speed: a jump, which is a gap as well
#define TRACK_DEPTH_MIN_M (-20000.0)
#define TRACK_HEIGHT_MAX_M 1e9
#define TRACK_OTHERS_MAX 8

// A track or object that was not asked for.
typedef struct TrackOther {
    char id[24];   // its number, or an ACMI id
    char name[40]; // "": none
} TrackOther;

typedef struct TrackBuild {
    const char *path;
    const char *asked; // TrackReading.object, of the readers that know it; NULL: none
    TrackOther others[TRACK_OTHERS_MAX];
    int other_count;
    bool more_others; // than are listed
    Track *track;
    int capacity;
    bool gap;                             // the next point begins anew
    int64_t first_line[TRACK_SKIP_COUNT]; // where each reason was met first
} TrackBuild;

TrackBuild track_build_begin(const char *path, Track *track);
// A point whose time is not after the last one's is left out and counted; so is one whose numbers are none of a place.
// FORMAT: more than TRACK_POINTS_MAX; MEMORY.
MUST_USE Result track_build_add(TrackBuild *build, int64_t line, const TrackPoint *point);
void track_build_skip(TrackBuild *build, TrackSkip why, int64_t line);
void track_build_gap(TrackBuild *build);
// Notes another track or object than the one asked for, once, to be told where that one is not there. `name`: or NULL.
void track_build_other(TrackBuild *build, const char *id, const char *name);
// Forgets all points, to begin with another track of the file.
void track_build_restart(TrackBuild *build);

// Whether this is a file to be read: warns of what was left out with the line of the first; FORMAT, with file and line,
// if no point is left, more went back in time than on, or more were damaged than not.
MUST_USE Result track_build_check(const TrackBuild *build);
// As track_build_check; then marks gaps, counts time from the first point (`is_utc`: that point's time becomes the
// start, otherwise the start is unknown), and derives the attitude of points marked so. Also MEMORY.
MUST_USE Result track_build_end(TrackBuild *build, bool is_utc);

// Marks what is too long or too fast to be one flight, by the limits above.
void track_mark_gaps(Track *track);
// The file's name without folder and ending.
void track_name_after(const char *path, char out[TRACK_NAME_BYTES]);
