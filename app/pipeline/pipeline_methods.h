// app/pipeline/pipeline_methods.h: the Lods that a pipeline refines with, one for each half of the picture, and how
// they change while the flight goes on: the next one is created beside it, and the former one lives until its cuts are
// drawn. Milliseconds. Methods owns its Lods and the thread that creates them; it borrows the terrain. Refining thread,
// but for what is said.
#pragma once
#include "base/base.h"
#include "terrain/lod/lod.h"

#include <stdatomic.h>

#define METHODS_HALVES 2 // 0: the whole picture or its left half; 1: the right half

// A Lod that is refined or was. Who holds a cut of it counts among its users.
typedef struct MethodRun {
    Lod *lod;
    LodMethod method;
    bool resident;
    double create_ms;
    atomic_int users;
    _Atomic uint64_t drawn; // LodCut.frame: up to it nothing is read any more
    _Atomic uint64_t held;  // LodCut.frame that somebody still reads, before `drawn` says it is not read; 0: none
    atomic_bool undrawable; // the renderer has no room for what its cuts need: methods_settle
    struct MethodRun *next; // among those that retired
} MethodRun;

typedef struct MethodsOptions {
    bool threaded;    // Lods are created beside the flight; else while it waits
    LodOptions lod;   // but method and serial
    bool bound_brute; // brute, which keeps no budget, is refused where it is more than lod.max_triangles
    const Terrain *terrain;
} MethodsOptions;

// What became of changes of method.
#define METHODS_WHY_BYTES 96
typedef struct MethodChanges {
    int64_t changes, refusals;   // methods that took over; that could not be created or refined
    LodMethod refused;           // the last one
    Result refusal;              // and why; OK: none was
    char why[METHODS_WHY_BYTES]; // in words; "": result_text has them
    int64_t fallbacks;           // resident methods that the renderer had no room for
    double longest_create_ms, longest_first_refine_ms;
} MethodChanges;

typedef struct Methods Methods;
MUST_USE Result methods_create(const MethodsOptions *options, Methods **out);
// When nobody holds a cut any more. Waits for a creation that has begun.
void methods_destroy(Methods **methods);

// Gives a half its first method, at once. Errors of lod_create; RANGE: more brute than is allowed.
MUST_USE Result methods_begin(Methods *methods, int half, LodMethod method);
// What the half is refined with; NULL: nothing yet.
MethodRun *methods_current(const Methods *methods, int half);
// A Lod of the method that is wanted for the half, ready for its first refinement, after which methods_judge is to be
// called. NULL: the half has the method, or it is being created, or it was refused since another one was wanted.
MethodRun *methods_find_candidate(Methods *methods, int half, LodMethod wanted);
// How the candidate's first refinement ended: OK, and the half has it; else it is refused.
void methods_judge(Methods *methods, int half, Result result, double refine_ms);
// The half is not shown any more.
void methods_leave(Methods *methods, int half);
// Before a frame is refined: a half whose method is undrawable goes back to the one before, and no method is made
// resident any more: the processor's twin is created like any other method. At once for a left half that had none
// before. Errors of lod_create.
MUST_USE Result methods_settle(Methods *methods);
// Destroys what retired and has no users.
void methods_sweep(Methods *methods);
MethodChanges methods_changes(const Methods *methods);
