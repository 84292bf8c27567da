// app/flight/governor.h: moves the tolerated error so that frames take a target time: from what frames cost to the
// tolerance of the next ones. Knows no clock, no GL and no thread. Milliseconds, seconds, pixels.
// A value; what it answers depends on what it was told and on nothing else.
#pragma once
#include "base/base.h"

#define GOVERNOR_TAU_MIN_PX 0.1
#define GOVERNOR_TAU_MAX_PX 64.0
#define GOVERNOR_RATE_MOVING 2.0   // a tolerance changes by this factor a second at most while the view moves,
#define GOVERNOR_RATE_FINDING 64.0 // and by this one on a still view, and in the first seconds of a flight or target
#define GOVERNOR_SETTLE_S 1.75     // by then a still view keeps its tolerance, where frames keep GOVERNOR_SETTLE_FRAMES
#define GOVERNOR_SETTLE_FRAMES 20
#define GOVERNOR_PROMISE 1.15  // times the target, for 95 of 100 frames
#define GOVERNOR_STEP 1.04     // factor between two tolerances while the view moves, at least
#define GOVERNOR_RECENT 9      // frames whose median counts
#define GOVERNOR_PROBE_MOST 21 // frames of one tolerance in a still view

// A drawn frame.
typedef struct GovernorFrame {
    double cost_ms;            // without waiting; not more than 0: unknown
    double passed_s;           // since the end of the frame before
    double tau_px, reached_px; // that it was drawn with; more is reached than asked for by a triangle budget
    bool another;              // made otherwise than the frame before, so that nothing known of costs holds any more
    bool moved;                // another view than that of the frame before
    bool disturbed;            // its cost tells nothing of the next ones
} GovernorFrame;

typedef enum GovernorReach {
    GOVERNOR_IN_REACH,
    GOVERNOR_TOO_SLOW, // even GOVERNOR_TAU_MAX_PX takes longer than the target
    GOVERNOR_TOO_FAST, // GOVERNOR_TAU_MIN_PX, or all that the triangle budget allows, takes less
    GOVERNOR_NOT_MET,  // it settled, and too many frames take longer than GOVERNOR_PROMISE times the target
} GovernorReach;
const char *governor_reach_name(GovernorReach reach); // "too slow"
bool governor_is_out_of_reach(GovernorReach reach);   // at any tolerance

// What a still view has shown at one tolerance. Logarithms.
typedef struct GovernorProbe {
    double u, cost; // of pixels; of the median in milliseconds
    bool known;
} GovernorProbe;

typedef struct Governor {
    double target_ms;
    double tau_px; // to ask for
    GovernorReach reach;
    bool settled;            // the view is still and the tolerance stays until it moves
    int64_t changes;         // of the tolerance
    int64_t changes_settled; // in this view since it settled: none

    // Inner state.
    double goal_px;               // where tau_px follows in steps
    double spread;                // logarithm of how far the 95th percentile of costs lies above their median
    int64_t learned;              // frames behind `spread`
    double wish[GOVERNOR_RECENT]; // logarithms of the tolerances that the latest frames call for
    int wishes, steady;           // frames heard; of them in a row with about the tolerance steady_px
    double steady_px;
    double hurry_s;                // left of the time in which tolerances may change fast
    double still_s;                // since the view moved last
    double search_s;               // the same, but of a frame not more than the target
    int still_frames, slow_frames; // since then; that took more than twice the target
    double leapt_px;               // whose first frame took so long that it led straight to a coarse one; 0: none did
    double probe_px;               // the tolerance tried in a still view; what its frames cost:
    double costs[GOVERNOR_PROBE_MOST];
    int cost_count, skipped;
    double missed;            // share of the latest frames since it settled that take longer than was promised
    GovernorProbe slow, fast; // nearest tolerances known to take too long, and not
} Governor;

// `tau_px` is where it starts, brought within the limits.
Governor governor_create(double target_ms, double tau_px);
// Another target; what is known of the frames' spread stays.
void governor_set_target(Governor *governor, double target_ms);
// Told once of each drawn frame, in order; answers the tolerance to ask for.
double governor_hear(Governor *governor, const GovernorFrame *frame);

#define GOVERNOR_NOTICE_S 2.0 // what lasts so long is worth a word

// When to say that frames take too long: once, and again only after they did not for as long, or of another target.
typedef struct GovernorNotice {
    double target_ms; // that it is about
    bool said;
    double other_s; // for how long it has not been as was said: too slow, or no longer
} GovernorNotice;

// Told after each governor_hear; true when it is to be said now: what settled too slow is said at once.
bool governor_notice_slow(GovernorNotice *notice, const Governor *governor, double passed_s);
