// terrain/lod/lod_patch_rest.h: the remainder beside static patches: its pages, triangulated by vertex.
// As terrain/lod/lod_patch_seam.h.
// A PatchRest owns its lists; its pages are the PageStore's. One thread at a time.
#pragma once
#include "terrain/lod/lod_method.h"
#include "terrain/lod/lod_patch_seam.h"
#include "terrain/patches/index_list.h"

typedef struct RestPage {
    Page *page;
    PatchTriangle triangle;
    int32_t square;                    // of the seam's grid
    uint8_t *decided, *active, *drawn; // [vertex_count] by its error; in this frame; in the list
    Vec3d built_eye;
    double built_nu, built_nearest_m, validity_m; // of `decided`; the last as RefineResult has it
    bool stale;                                   // decided anew in this pass
    bool changed;                                 // decided anew since it was last read
    IndexList list, next;                         // next: made in this frame, not yet adopted
    uint64_t revision;
    uint64_t built_frame;
    int32_t vertex_count, evaluated; // drawn; decided upon when it was last
} RestPage;

typedef struct PatchRest {
    RestPage *pages; // [count], in the order of the selection
    int32_t count;
    uint8_t *activity; // of all pages
    uint16_t *scratch[LOD_PARTITIONS_MAX];
    size_t scratch_count; // indices
    bool failed;          // the last pass: lists and activity do not agree, all are to be made anew
    IndexStore lists;     // a pool a worker
} PatchRest;

// Takes a page for each of the remainder's finest patches. MEMORY.
MUST_USE Result rest_create(const PatchSeam *seam, PageStore *pages, PatchRest *out);
void rest_destroy(PatchRest *rest);

// Activates in the seam what is active by its error. Pages are decided anew outside their sphere of validity, or all.
void rest_decide(PatchRest *rest, PatchSeam *seam, const SeamView *view, const LodCall *call, bool all);
// Triangulates, after the seam was closed, the pages whose active vertices changed, or all. Revisions count up. MEMORY.
MUST_USE Result rest_triangulate(PatchRest *rest, PatchSeam *seam, const LodCall *call, bool all, uint64_t *revision);
