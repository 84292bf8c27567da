// terrain/lod/lod.h: choose which triangles to draw for one view. Many methods, one interface.
// Units: ECEF metres in double; page positions in lattice units (grid.h). Errors in pixels at the image centre.
// A Lod borrows its Terrain, which must outlive it; one thread at a time may use it.
#pragma once
#include "base/arena.h"
#include "base/base.h"
#include "base/vec.h"
#include "terrain/jobs.h"
#include "terrain/terrain.h"

#define LOD_PARTITIONS_MAX 64

// X(identifier, name, source), in the order in which keys and reports go through them.
#define LOD_METHOD_TABLE(X)                                                                                            \
    X(HYBRID, "hybrid", "Loeffler et al. 2010")                                                                        \
    X(PATCH, "patch", "Boesch et al. 2009")                                                                            \
    X(ROAM, "roam", "Duchaineau et al. 1997")                                                                          \
    X(ROAM_PARALLEL, "roam-parallel", "Biedermann, Rivara")                                                            \
    X(GEOMIPMAP, "geomipmap", "de Boer 2000")                                                                          \
    X(GEOMIPMAP_YE, "geomipmap-ye", "Ye, Wang")                                                                        \
    X(DIAMOND, "diamond", "Yalcin et al. 2011")                                                                        \
    X(BRUTE, "brute", "every sample")

typedef enum LodMethod {
#define LOD_METHOD_ENUM(id, name, source) LOD_##id,
    LOD_METHOD_TABLE(LOD_METHOD_ENUM) LOD_METHOD_COUNT
#undef LOD_METHOD_ENUM
} LodMethod;
const char *lod_method_name(LodMethod method);   // "hybrid"
const char *lod_method_source(LodMethod method); // "Loeffler et al. 2010"

// Which error a method keeps.
typedef enum LodBound {
    LOD_BOUND_PUBLISHED, // what its paper keeps: for the geomipmap methods no bound at every sample
    LOD_BOUND_CENTRE,    // tau at every sample, seen at the image's centre
} LodBound;

typedef struct DiamondSelect DiamondSelect; // terrain/diamond/diamond_select.h
typedef struct DiamondOrder DiamondOrder;   // terrain/diamond/diamond.h

typedef struct LodOptions {
    LodMethod method;
    int partitions;        // along the observer line; 0: one per worker
    int64_t max_triangles; // > 0; above it the tolerance is raised
    size_t page_bytes_max; // CPU memory for vertex pages no longer drawn
    bool reuse;            // false: every patch is triangulated anew each frame; roam: the mesh is built anew
    uint32_t serial;       // 0 .. 2^24 - 1; Lods drawn by one renderer have different ones, and so have their pages
    LodBound bound;
    double unit_m;               // geomipmap-ye: the unit of length whose square its rule takes, > 0
    int tile_side;               // of the geomipmap methods, samples: 2^n + 1, 3 .. 129
    bool resident;               // diamond: leave the triangles to the renderer's compute shaders
    const DiamondSelect *select; // diamond: what splits besides the view's tolerance; NULL: the tolerance. Borrowed
} LodOptions;
LodOptions lod_default_options(void);

typedef struct LodView {
    Vec3d eye_ecef;     // metres, finite
    Vec3d forward_ecef; // unit; the observer line is its horizontal direction. Balances work, changes no triangle
    double px_per_rad;  // at the image centre: height_px / (2 tan(fov_y / 2)), > 0
    double tau_px;      // tolerated error, pixels, > 0
} LodView;

// The static vertices of a patch. Constant once made; lives until lod_release allows its end.
typedef struct LodVertex {
    int32_t x, y, z;   // lattice units from the page's origin
    uint16_t col, row; // samples from the page's (col0, row0)
} LodVertex;
typedef struct LodPage {
    uint64_t id;          // never used again for other contents
    int32_t vertex_count; // <= 65536
    int32_t col0, row0;
    GridPoint origin; // multiples of GRID_LATTICE_PER_M: whole metres
    const LodVertex *vertices;
} LodPage;

typedef enum LodItemState {
    LOD_ITEM_REUSED,  // as in the frame before
    LOD_ITEM_REBUILT, // triangulated anew this frame
} LodItemState;

typedef struct LodItem {
    const LodPage *page;
    uint64_t revision;       // of the index list; never used again for other contents
    const uint16_t *indices; // 3 a triangle, counter-clockwise seen from above; lives until lod_release
    int32_t index_count;
    uint8_t level; // of the patch in its base tile's bintree: 0 the coarsest
    uint8_t state; // LodItemState
    uint16_t partition;
    Vec3d centre_ecef; // of a sphere around everything the patch can draw
    double radius_m;
} LodItem;

typedef struct LodStats {
    int64_t triangles, patches, patches_reused, triangles_rebuilt;
    int64_t vertices;           // drawn, counted per patch
    int64_t vertices_evaluated; // activity decisions this frame
    int64_t index_bytes;        // that changed
    int64_t select_ns, refine_ns;
    int partitions;                        // that were refined side by side
    double balance;                        // the longest partition's time over their mean, 1 at best; 0: not measured
    int64_t cut_vertices;                  // drawn once more because two partitions share them
    int64_t splits, forced_splits, merges; // roam: of triangle pairs, in this frame
    int64_t chosen, closed;                // diamond: split before and after the closure
} LodStats;

typedef struct LodCut {
    uint64_t frame; // counts up from 1
    LodView view;
    double reached_px; // the error that holds: tau_px, or more when the budget was reached
    bool promises;     // whether the method bounds the error at every sample
    int32_t item_count;
    const LodItem *items;         // in the order of the patch hierarchy; in `frame`'s memory
    const DiamondOrder *resident; // no items: the renderer makes and draws the triangles (terrain/diamond); else NULL
    LodStats stats;
} LodCut;

typedef struct Lod Lod;
MUST_USE Result lod_create(const LodOptions *options, const Terrain *terrain, Lod **out);
void lod_destroy(Lod **lod);

// The cut for this view, in `frame` until arena_reset; pages and index lists until lod_release or arena_reset,
// whichever comes first. The same sequence of views gives the same bytes for any number of workers and partitions.
// RANGE: a view that is not finite or not positive. BUDGET: the triangle budget was reached, the cut is valid and
// cut->reached_px says which error holds instead.
MUST_USE Result lod_update(Lod *lod, const LodView *view, Jobs *jobs, Arena *frame, LodCut *cut);

// Cuts up to and including `frame` are no longer read by anyone.
void lod_release(Lod *lod, uint64_t frame);
