#include "app/flight/governor.h"

#include "base/statistics.h"

#include <math.h>
#include <string.h>

// Where the moving view's tolerance goes: a frame that costs x times the target calls for x^(1/ELASTICITY) times its
// own tolerance. As each wish is reckoned from the tolerance that its own frame had, frames that come late swing
// nothing: for costs that fall with the tolerance's power 0 .. 2 ELASTICITY any delay is stable.
#define ELASTICITY 0.8
#define APPROACH 0.12 // share of the way a frame
#define APPROACH_MOST 0.4
#define HURRY_S 2.0

// The set point: the 95th percentile of the cost is held a little below the target.
#define AIM (-0.02)
#define SPREAD_BEGIN 0.06
#define SPREAD_MIN 0.02
#define SPREAD_MAX 0.6
#define SPREAD_STEP 0.01 // in the long run; wider at first
#define SPREAD_NEWS 0.5
#define SHARE_ABOVE 0.05
#define STEADY 0.05 // tolerances this near, in logarithms, compare

// Still views.
#define STILL_FRAMES 3 // a slow simulation gives the same view now and then
#define STILL_S 0.08
#define SKIP 2          // frames of a new tolerance that make what they draw
#define CLEAR_COUNT 3   // so many are enough where all of them
#define CLEAR 0.25      // are this far off, in logarithms
#define NEAR 0.12       // beyond it GOVERNOR_RECENT frames are enough
#define FITS_BELOW 0.06 // of the set point, in logarithms
#define FITS_ABOVE 0.04
#define STEP_MAX 1.4
#define ELASTICITY_MIN 0.15 // nearly all of the cost is fixed: more would be noise
#define SLOW 2.0            // times the target; once SLOW_FRAMES take longer a frame counts as the target
#define SLOW_FRAMES 10
#define HOPELESS 2.0      // times the set point
#define LEAPT_FRAMES 14   // then in place of GOVERNOR_SETTLE_FRAMES
#define MISSED_NEWS 0.025 // share of a frame in `missed`
#define MISSED_FROM 0.1   // a few frames by chance are not enough
#define MISSED_TO 0.05
#define NARROW 0.03 // a bracket that is not worth halving
#define INSIDE 0.15 // of a bracket: how near to its ends the next try may be

static double clamp(double x, double least, double most) {
    return fmin(fmax(x, least), most);
}

static double within_limits(double tau_px) {
    return clamp(tau_px, GOVERNOR_TAU_MIN_PX, GOVERNOR_TAU_MAX_PX);
}

const char *governor_reach_name(GovernorReach reach) {
    static const char *const names[] = {"in reach", "too slow", "too fast", "not met"};
    return names[reach];
}

bool governor_is_out_of_reach(GovernorReach reach) {
    return reach == GOVERNOR_TOO_SLOW || reach == GOVERNOR_TOO_FAST;
}

static void forget_view(Governor *g) {
    if (g->settled) // what frames called for before it settled is of long ago
        g->wishes = g->steady = 0;
    g->settled = false;
    g->changes_settled = 0;
    g->still_frames = g->slow_frames = 0;
    g->still_s = g->search_s = 0.0;
    g->slow = g->fast = (GovernorProbe){0};
    g->cost_count = g->skipped = 0;
    g->probe_px = g->leapt_px = 0.0;
}

static void begin_anew(Governor *g) {
    forget_view(g);
    g->wishes = g->steady = 0;
    g->steady_px = g->tau_px;
    g->hurry_s = HURRY_S;
    g->reach = GOVERNOR_IN_REACH;
}

Governor governor_create(double target_ms, double tau_px) {
    Governor g = {.target_ms = target_ms,
                  .tau_px = within_limits(tau_px),
                  .goal_px = within_limits(tau_px),
                  .spread = SPREAD_BEGIN};
    begin_anew(&g);
    return g;
}

void governor_set_target(Governor *g, double target_ms) {
    g->target_ms = target_ms;
    begin_anew(g);
}

// Logarithm of the median that brings the 95th percentile to the target.
static double set_point(const Governor *g) {
    return log(g->target_ms) + AIM - g->spread;
}

static double median_of(const double *values, int count) {
    double sorted[GOVERNOR_PROBE_MOST];
    memcpy(sorted, values, sizeof *sorted * (size_t)count);
    statistics_sort(sorted, count);
    return statistics_percentile(sorted, count, 0.5);
}

// Towards a tolerance within the limits, no faster than `rate` allows. It is asked for in steps: another tolerance lets
// no triangulation be used again.
static void go_to(Governor *g, double tau_px, double rate, double passed_s) {
    double most = pow(rate, clamp(passed_s, 0.0, 1.0));
    g->goal_px = clamp(tau_px, g->goal_px / most, g->goal_px * most);
    bool there = g->goal_px == g->probe_px || g->goal_px <= GOVERNOR_TAU_MIN_PX || g->goal_px >= GOVERNOR_TAU_MAX_PX;
    if (g->goal_px == g->tau_px || (!there && fabs(log(g->goal_px / g->tau_px)) < log(GOVERNOR_STEP)))
        return;
    g->tau_px = g->goal_px;
    g->changes++;
    g->changes_settled += g->settled;
}

// ---- what frames tell, moving or still ----

static int recent(const Governor *g) {
    return g->wishes < GOVERNOR_RECENT ? g->wishes : GOVERNOR_RECENT;
}

// The running quantile moves up by much and seldom, down by little and often.
static void learn_spread(Governor *g, double wish) {
    if (g->steady < GOVERNOR_RECENT)
        return;
    double above = ELASTICITY * (wish - median_of(g->wish, GOVERNOR_RECENT));
    double step = SPREAD_STEP + SPREAD_NEWS / (double)(g->learned + 20);
    g->learned++;
    g->spread += above > g->spread ? step * (1.0 - SHARE_ABOVE) : -step * SHARE_ABOVE;
    g->spread = clamp(g->spread, SPREAD_MIN, SPREAD_MAX);
}

static void watch_tolerance(Governor *g, double tau_px) {
    bool same = fabs(log(tau_px / g->steady_px)) < STEADY;
    g->steady = same ? g->steady + (g->steady < GOVERNOR_RECENT) : 0;
    if (!same)
        g->steady_px = tau_px;
}

static double learn(Governor *g, const GovernorFrame *frame) {
    double wish = log(frame->tau_px) + (log(frame->cost_ms) - set_point(g)) / ELASTICITY;
    watch_tolerance(g, frame->tau_px);
    learn_spread(g, wish);
    g->wish[g->wishes++ % GOVERNOR_RECENT] = wish;
    if (g->wishes == 2 * GOVERNOR_RECENT) // only its rest and whether the ring is full count
        g->wishes = GOVERNOR_RECENT;
    return median_of(g->wish, recent(g));
}

static bool is_budgeted(const GovernorFrame *frame) {
    return frame->reached_px > frame->tau_px * 1.0001;
}

// ---- a moving view ----

// What was out of reach stays so until the set point is passed: noise does not make it come and go.
static GovernorReach judge_reach(const Governor *g, const GovernorFrame *frame, double off) {
    bool coarsest = g->tau_px >= GOVERNOR_TAU_MAX_PX, finest = g->tau_px <= GOVERNOR_TAU_MIN_PX || is_budgeted(frame);
    double above = g->reach == GOVERNOR_TOO_SLOW ? 0.0 : FITS_ABOVE;
    double below = g->reach == GOVERNOR_TOO_FAST ? 0.0 : FITS_BELOW;
    return coarsest && off > above ? GOVERNOR_TOO_SLOW : finest && off < -below ? GOVERNOR_TOO_FAST : GOVERNOR_IN_REACH;
}

// Frames that take longer than the target are few: each goes further.
static double approach(const Governor *g, const GovernorFrame *frame) {
    return fmin(APPROACH * fmax(frame->passed_s * 1e3 / g->target_ms, 1.0), APPROACH_MOST);
}

static void follow(Governor *g, const GovernorFrame *frame, double wish) {
    double u = log(g->goal_px);
    if (recent(g) < CLEAR_COUNT)
        return;
    g->reach = judge_reach(g, frame, ELASTICITY * (wish - log(g->tau_px)));
    if (is_budgeted(frame) && wish < u) // finer is asked for in vain
        return;
    double rate = g->hurry_s > 0.0 ? GOVERNOR_RATE_FINDING : GOVERNOR_RATE_MOVING;
    go_to(g, within_limits(exp(u + approach(g, frame) * (wish - u))), rate, frame->passed_s);
}

// ---- a still view ----

static void settle(Governor *g, GovernorReach reach) {
    g->settled = true;
    g->reach = reach;
    g->missed = 0.0;
}

// The tolerance stays, whatever frames cost; but nobody is to be told that the target is met when it is not.
static void watch_settled(Governor *g, const GovernorFrame *frame) {
    double late = frame->cost_ms > GOVERNOR_PROMISE * g->target_ms ? 1.0 : 0.0;
    g->missed += (late - g->missed) * MISSED_NEWS;
    if (g->reach == GOVERNOR_IN_REACH && g->missed > MISSED_FROM)
        g->reach = GOVERNOR_NOT_MET;
    else if (g->reach == GOVERNOR_NOT_MET && g->missed < MISSED_TO)
        g->reach = GOVERNOR_IN_REACH;
}

// The probes' own line through two of them, in logarithms; without two, the usual one through the last.
static double solve(const Governor *g, const GovernorProbe *last) {
    double set = set_point(g), elasticity = ELASTICITY;
    const GovernorProbe *a = &g->slow, *b = &g->fast;
    if (a->known && b->known && b->u > a->u && a->cost > b->cost)
        elasticity = clamp((a->cost - b->cost) / (b->u - a->u), ELASTICITY_MIN, 2.0);
    double step = clamp((last->cost - set) / elasticity, -STEP_MAX, STEP_MAX);
    return last->u + step;
}

// Between what is known to be too slow and what is not.
static double next_try(const Governor *g, const GovernorProbe *last) {
    double u = solve(g, last), low = g->slow.u, high = g->fast.u;
    if (g->slow.known && g->fast.known && high > low)
        return clamp(u, low + INSIDE * (high - low), high - INSIDE * (high - low));
    // Beyond what is known on one side: at least so far that the probe can tell something new.
    return last->cost > set_point(g) ? fmax(u, last->u + NARROW) : fmin(u, last->u - NARROW);
}

static bool fits(const Governor *g, double cost) {
    double off = cost - set_point(g);
    return off <= FITS_ABOVE && off >= -FITS_BELOW;
}

static void try_at(Governor *g, double tau_px) {
    g->probe_px = within_limits(tau_px);
    g->cost_count = g->skipped = 0;
}

// ---- frames that take hopelessly long ----

// Nothing is known, and frames take so long that few would tell of it in two seconds: the first goes straight to where
// they are quick, and the search comes back from there.
static void leap(Governor *g, const GovernorFrame *frame) {
    double times = log(frame->cost_ms) - set_point(g);
    double goal_px = within_limits(frame->tau_px * exp(times / ELASTICITY));
    bool first = g->wishes == 1 && g->hurry_s > 0.0;
    if (!first || times < log(HOPELESS) || is_budgeted(frame) || goal_px < g->tau_px * GOVERNOR_STEP)
        return;
    g->tau_px = g->goal_px = goal_px;
    g->changes++;
    g->slow = (GovernorProbe){log(frame->tau_px), log(frame->cost_ms), true};
    g->leapt_px = frame->tau_px;
}

// Those that were on their way tell whether the first one was but an accident; the search's time begins after them.
static void confirm_leap(Governor *g, const GovernorFrame *frame) {
    if (frame->tau_px != g->leapt_px || g->fast.known || g->cost_count > 0)
        return;
    g->slow.cost = fmin(g->slow.cost, log(frame->cost_ms));
    g->slow.known = g->slow.known && g->slow.cost > set_point(g);
    g->still_s = g->search_s = 0.0;
    g->still_frames = g->slow_frames = 0;
}

static void remember(Governor *g, const GovernorProbe *probe) {
    bool slow = probe->cost > set_point(g);
    if (slow && (!g->slow.known || probe->u >= g->slow.u))
        g->slow = *probe;
    if (!slow && (!g->fast.known || probe->u <= g->fast.u))
        g->fast = *probe;
}

static bool is_narrow(const Governor *g) {
    return g->slow.known && g->fast.known && g->fast.u - g->slow.u < NARROW;
}

// The tolerance tried is known to cost so much: it stays, or another one is tried.
static void conclude(Governor *g, const GovernorFrame *frame) {
    GovernorProbe probe = {log(g->probe_px), log(median_of(g->costs, g->cost_count)), true};
    double off = probe.cost - set_point(g);
    remember(g, &probe);
    if (fits(g, probe.cost))
        settle(g, GOVERNOR_IN_REACH);
    else if (off > 0.0 && g->probe_px >= GOVERNOR_TAU_MAX_PX)
        settle(g, GOVERNOR_TOO_SLOW);
    else if (off < 0.0 && (g->probe_px <= GOVERNOR_TAU_MIN_PX || is_budgeted(frame)))
        settle(g, GOVERNOR_TOO_FAST);
    else if (is_narrow(g))
        try_at(g, exp(g->fast.u));
    else
        try_at(g, exp(next_try(g, &probe)));
}

// Few frames tell what is far off, more what is near.
static bool is_clear(const Governor *g) {
    double set = set_point(g);
    if (g->cost_count >= GOVERNOR_RECENT && fabs(log(median_of(g->costs, g->cost_count)) - set) > NEAR)
        return true;
    double least = INFINITY, most = -INFINITY;
    for (int i = 0; i < g->cost_count; i++) {
        least = fmin(least, log(g->costs[i]));
        most = fmax(most, log(g->costs[i]));
    }
    return least > set + CLEAR || most < set - CLEAR;
}

static void probe(Governor *g, const GovernorFrame *frame) {
    if (frame->tau_px != g->probe_px || g->skipped++ < SKIP)
        return;
    g->costs[g->cost_count++] = frame->cost_ms;
    if (g->cost_count == GOVERNOR_PROBE_MOST || (g->cost_count >= CLEAR_COUNT && is_clear(g)))
        conclude(g, frame);
}

// Time is up: what the probes let expect stays.
static void settle_anyway(Governor *g, const GovernorFrame *frame) {
    if (g->cost_count >= CLEAR_COUNT && fits(g, log(median_of(g->costs, g->cost_count)))) {
        settle(g, GOVERNOR_IN_REACH);
        return;
    }
    GovernorProbe last = {log(g->probe_px), g->cost_count ? log(median_of(g->costs, g->cost_count)) : set_point(g),
                          true};
    const GovernorProbe *from = g->cost_count >= CLEAR_COUNT ? &last : g->fast.known ? &g->fast : &g->slow;
    if (from->known)
        try_at(g, exp(next_try(g, from)));
    go_to(g, g->probe_px, GOVERNOR_RATE_FINDING, 1.0);
    settle(g, from->known ? judge_reach(g, frame, from->cost - set_point(g)) : g->reach);
}

static bool is_late(const Governor *g) {
    double passed_s = g->slow_frames < SLOW_FRAMES ? g->still_s : g->search_s; // few long frames do not tell enough
    int least = g->leapt_px > 0.0 ? LEAPT_FRAMES : GOVERNOR_SETTLE_FRAMES;
    return passed_s >= GOVERNOR_SETTLE_S && g->still_frames >= least;
}

static void search(Governor *g, const GovernorFrame *frame, bool heard) {
    if (g->settled)
        return;
    if (heard)
        probe(g, frame);
    if (!g->settled && is_late(g))
        settle_anyway(g, frame);
    if (!g->settled)
        go_to(g, g->probe_px, GOVERNOR_RATE_FINDING, frame->passed_s);
}

// ---- both ----

static bool is_still(const Governor *g) {
    return g->still_frames >= STILL_FRAMES && g->still_s >= STILL_S;
}

static void watch_view(Governor *g, const GovernorFrame *frame) {
    if (frame->another)
        begin_anew(g);
    else if (frame->moved)
        forget_view(g);
    bool was_still = is_still(g);
    g->still_frames += g->still_frames < INT32_MAX && !frame->moved;
    double passed_s = fmax(frame->passed_s, 0.0);
    g->still_s += passed_s;
    g->slow_frames += g->slow_frames < SLOW_FRAMES && frame->cost_ms > SLOW * g->target_ms;
    g->search_s += fmin(passed_s, g->target_ms * 1e-3);
    if (!was_still && is_still(g))
        try_at(g, g->tau_px);
}

static bool is_heard(const GovernorFrame *frame) {
    return !frame->disturbed && frame->cost_ms > 0.0 && isfinite(frame->cost_ms) && frame->tau_px > 0.0;
}

double governor_hear(Governor *g, const GovernorFrame *frame) {
    bool heard = is_heard(frame);
    watch_view(g, frame);
    g->hurry_s = fmax(g->hurry_s - clamp(frame->passed_s, 0.0, g->target_ms * 1e-3), 0.0);
    double wish = heard && !g->settled ? learn(g, frame) : 0.0;
    if (heard && !g->settled) {
        leap(g, frame);
        confirm_leap(g, frame);
    }
    if (g->settled && heard)
        watch_settled(g, frame);
    else if (is_still(g))
        search(g, frame, heard);
    else if (heard)
        follow(g, frame, wish);
    return g->tau_px;
}

bool governor_notice_slow(GovernorNotice *notice, const Governor *g, double passed_s) {
    bool slow = g->reach == GOVERNOR_TOO_SLOW;
    if (notice->target_ms != g->target_ms)
        *notice = (GovernorNotice){.target_ms = g->target_ms};
    notice->other_s = slow != notice->said ? notice->other_s + fmax(passed_s, 0.0) : 0.0;
    if (slow == notice->said || (notice->other_s < GOVERNOR_NOTICE_S && !(slow && g->settled)))
        return false;
    *notice = (GovernorNotice){.target_ms = g->target_ms, .said = slow};
    return slow;
}
