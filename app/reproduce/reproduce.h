// app/reproduce/reproduce.h: what the four experiments share: options, terrains, workers, a GL context, the report.
// Units as named.
// A Reproduce owns all of it, and cmd_reproduce ends it. Main thread.
#pragma once
#include "app/reproduce/reproduce_circuit.h"
#include "app/reproduce/reproduce_race.h"
#include "app/reproduce/reproduce_report.h"
#include "app/reproduce/reproduce_site.h"
#include "base/base.h"
#include "config/options.h"
#include "render/context/context.h"

#define REPRODUCE_SIDES_MAX 8
#define REPRODUCE_FRAME_HZ 60.0
#define REPRODUCE_FOV_DEG 60.0   // vertical; no paper tells its own
#define REPRODUCE_HEIGHT_M 500.0 // of the flights above the ground; nor that
#define REPRODUCE_WARM_UP 10     // frames that make the first pages
#define REPRODUCE_TRIANGLES_MAX 64000000

typedef struct Reproduce {
    const Options *options;
    bool quick;
    int sides[REPRODUCE_SIDES_MAX], side_count; // as given; 0: the paper's
    double seconds;                             // as given; 0: the experiment's own
    Site site;
    Jobs *one, *all;
    Context *context; // NULL: nothing is drawn
    Report report;
} Reproduce;

// Each fills run->report. What loading, refining or drawing fails with; logged.
MUST_USE Result reproduce_loeffler(Reproduce *run);
// The first table of reproduce_loeffler.
MUST_USE Result reproduce_preprocess(Reproduce *run);
MUST_USE Result reproduce_biedermann(Reproduce *run);
MUST_USE Result reproduce_yalcin(Reproduce *run);
MUST_USE Result reproduce_ye(Reproduce *run);

// Up to REPRODUCE_SIDES_MAX sides for `what` ("table 1"): those given, else the paper's, of which --quick takes the
// first `quick_count` and notes the others as left out. Returns their number.
int reproduce_sides(Reproduce *run, const char *what, const int *full, int full_count, int quick_count, int *out);
// Of a flight: as given, else `full`, or `quick` with a note.
double reproduce_seconds(Reproduce *run, const char *what, double full, double quick);
// Of one method, refined without a bound on triangles.
LodOptions reproduce_lod_options(LodMethod method);
double reproduce_px_per_rad(int height_px);
// A ground of a size with total errors, and the circuit over it. The caller destroys the terrain.
MUST_USE Result reproduce_terrain(const Reproduce *run, SiteGround ground, int side, Circuit *circuit, Terrain **out);
// Draws a few views from `part` of the circuit on, `step` apart; nothing without a context.
MUST_USE Result reproduce_draw(Reproduce *run, Race *race, const Circuit *circuit, int width, int height, double tau_px,
                               double part, double step);
