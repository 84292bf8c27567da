// terrain/patches/refine.h: triangulate one patch for one view: which of its vertices are active, and the triangles
// between. Lattice units inside, metres outside. Pure functions over memory of the caller; any thread. The same bits on
// every processor.
//
// Sources: Lindstrom, Pascucci 2002, sections 3 and 4 (activity by nested spheres); Loeffler et al. 2010, sections 4.2
// and 4.3 (patches as triangular grids, the sphere of validity).
#pragma once
#include "terrain/patches/page.h"

typedef struct RefineView {
    double eye[3]; // lattice units
    double nu;     // lambda / tau, 1 / rad
} RefineView;
RefineView refine_view(const LodView *view, double tau_px);

// Whether a vertex is active: nu delta + radius > |position - eye|. One expression for patches and vertices alike.
bool refine_is_active(const RefineView *view, Vec3d position_ecef, float delta_m, float radius_m);

typedef struct RefineResult {
    int32_t index_count;  // 3 a triangle
    int32_t vertex_count; // drawn
    int32_t evaluated;    // activity decisions
    double validity_m;    // the eye may move by less than this in any direction and no decision changes
} RefineResult;

// Bytes `active` must hold, and indices `indices` must hold, in the worst case.
size_t refine_active_bytes(const PatchTemplate *patch);
size_t refine_indices_max(const PatchTemplate *patch);

// Which vertices are active, [vertex_count]; index_count stays 0.
RefineResult refine_decide(const Page *page, const RefineView *view, uint8_t *active);
// The triangles between active vertices, each of which has its parents active: how many indices.
int32_t refine_emit(const PatchTemplate *patch, const uint8_t *active, uint16_t *indices);
// Both. `indices`: triangles, counter-clockwise seen from above, in depth-first order.
RefineResult refine_page(const Page *page, const RefineView *view, uint8_t *active, uint16_t *indices);
// The same with every vertex active.
int32_t refine_all(const PatchTemplate *patch, uint16_t *indices);
