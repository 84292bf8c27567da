// terrain/diamond/diamond.h: a terrain as a hierarchy of diamonds that any predicate can be asked of: generation of
// errors, evaluation, transitive closure, indices. The same phases, under the same names, are compute shaders in
// render/shaders/diamond_*; both give the same bits.
// Metres; positions in float from an origin of whole metres; columns and rows in samples; eye in ECEF metres.
// A DiamondModel owns its arrays and borrows the Terrain. Constant after creation and generation: any thread may read
// it. The phases write to memory of the caller and may use all of `jobs`.
//
// Source: Yalcin, Weiss, De Floriani 2011: super-squares (3), generation (5), evaluation (6), closure (7), indices (8).
#pragma once
#include "base/vec.h"
#include "terrain/diamond/diamond_layout.h"
#include "terrain/diamond/diamond_select.h"
#include "terrain/jobs.h"
#include "terrain/lod/lod.h"
#include "terrain/terrain.h"

// Upper bounds for the vertices of one row of a plane: what planes of heights leave out. std430 friendly: four floats.
typedef struct DiamondTerms {
    float edge_sag_m, centre_sag_m; // by the Earth's and the map's curvature, by rounding of heights and positions
    float edge_drift, centre_drift; // a metre of height range among the corners: the vertical turns over the diamond
} DiamondTerms;

// A bound for consecutive super-squares: a sphere around all that their diamonds may draw, but for what errors add.
#define DIAMOND_RUN 64 // super-squares
typedef struct DiamondRun {
    float x, y, z, radius_m;
    float error_m; // the largest that is not infinite; -1: no diamond to ask about
} DiamondRun;

typedef struct DiamondModel {
    uint64_t id; // the renderer's key; of two models it draws, no two are equal
    const Terrain *terrain;
    DiamondLayout layout;
    Vec3d origin_ecef;     // whole metres
    const float *height_m; // [height][width], the terrain's own, above the ellipsoid
    DiamondTerms *terms;   // [layout.row_count]
    // By diamond_entry; 0 for samples outside the DEM.
    float *x, *y, *z; // [DIAMOND_SLOTS * word_count]
    float *error_m;   // [DIAMOND_SLOTS * word_count], INFINITY where always split; NULL until diamond_generate_errors
    // Of each plane's words, DIAMOND_RUN at a time; NULL until diamond_generate_errors. Only the processor's side asks
    // them, for what a predicate says of all their diamonds.
    DiamondRun *runs;
    uint32_t run_first[DIAMOND_LEVEL_MAX + 1]; // of each plane, and their number
    // Greatest distance of a diamond's corners from its vertex, in each super-square: [word] of its centres,
    // [word_count + word] of its edge midpoints. Rounded up, position_slack_m included.
    float *reach_m;
    uint32_t *valid, *always; // [word_count]: samples inside the DEM; vertices that are split in every cut
    float extent_m;           // largest coordinate of a position
    float position_slack_m;   // at most so far is a float position from the drawn one
    // What some predicates read, NULL where the model was made without (DiamondSelect.fields). By diamond_entry.
    float *datum_m;              // height above the DEM's own datum
    float *east_deg, *north_deg; // from the middle
    double middle_lat_deg, middle_lon_deg;
    size_t bytes;
    void *memory;
} DiamondModel;

// `fields`: DIAMOND_FIELD_* that predicates will read, 0 for the tolerance. error_m stays NULL. MEMORY, with a message.
MUST_USE Result diamond_model_create(const Terrain *terrain, unsigned fields, uint64_t id, Jobs *jobs,
                                     DiamondModel *out);
void diamond_model_destroy(DiamondModel *model);

// Fills error_m: for each diamond the largest |h - plane| of the samples of its closed triangles, not nested, plus the
// terms of its row, so that |P - Q| <= error for each such sample P and the point Q drawn at its column and row where
// the diamond is not split. `depth_ns`: [2 * level_count], the time each diamond_level took, or NULL. MEMORY.
MUST_USE Result diamond_generate_errors(DiamondModel *model, Jobs *jobs, int64_t *depth_ns);

// What a predicate reads of the view. Floats as both sides read them.
#define DIAMOND_PLANES 5
typedef struct DiamondView {
    float eye[3];     // from the model's origin
    float nu;         // px_per_rad / tau_px, 1 / rad
    float slack_m;    // what float positions and the eye's rounding can hide
    float px_per_rad; // at the image's centre
    float tau_px;
    float plane[DIAMOND_PLANES][3]; // unit normals of half spaces through the eye, inwards: ahead, left, right, bottom,
                                    // top. All 0: everything is in view
} DiamondView;

// `lens`: NULL for a view without sides.
DiamondView diamond_view(const DiamondModel *model, const LodView *view, double tau_px, const DiamondLens *lens);

// All that the renderer needs to run the phases for a frame. In the frame's memory; model and program are the Lod's.
struct DiamondOrder {
    const DiamondModel *model; // error_m may be NULL: the renderer generates errors then
    const DiamondProgram *program;
    DiamondView view;
    int64_t max_triangles; // the budget
    bool may_raise;        // the tolerance, above the budget: not of a selection
};

// ---- the phases; `bits` is [word_count] ----

// Bits of vertices for which the program holds, and of those that are always split.
void diamond_evaluate(const DiamondModel *model, const DiamondProgram *program, const DiamondView *view, Jobs *jobs,
                      uint32_t *bits);
// Splits all ancestors of what is split: from the finest plane up, edges before centres, a barrier between.
void diamond_close(const DiamondModel *model, Jobs *jobs, uint32_t *bits);
// Every bit of a sample inside the DEM: the paper's fully split start.
void diamond_fill(const DiamondModel *model, uint32_t *bits);
int64_t diamond_count(const DiamondModel *model, const uint32_t *bits); // of split diamonds

typedef struct DiamondIndices {
    uint32_t *indices; // row * width + column, 3 a triangle, counter-clockwise seen from above
    size_t count, capacity;
} DiamondIndices;

// The triangles of closed bits, plane by plane from the finest, row by row of super-squares, slot by slot. The same
// bytes for any number of workers. Start with zeros; memory is kept for the next call. MEMORY.
MUST_USE Result diamond_generate_indices(const DiamondModel *model, const uint32_t *bits, Jobs *jobs,
                                         DiamondIndices *out);
void diamond_indices_destroy(DiamondIndices *indices);
