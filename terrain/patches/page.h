// terrain/patches/page.h: the static vertices of a patch: what is uploaded once, and what the refinement decides upon.
// Lattice units (grid.h) from the page's origin; errors as 16-bit codes (error_field.h).
// Pages belong to a PageStore; they are made by workers and retired by the thread that owns the store.
#pragma once
#include "terrain/lod/lod.h"
#include "terrain/patches/patch_forest.h"
#include "terrain/terrain.h"

typedef struct Page {
    LodPage shown; // what the renderer sees; `vertices` points below
    const PatchTemplate *patch;
    // [vertex_count], numbered as in the template: offsets, and the vertices' error codes.
    int32_t *x, *y, *z;
    uint16_t *delta, *radius;
    Vec3d centre_ecef;
    double radius_m;            // of a sphere around all vertices
    bool filled;                // page_fill has been here since the page was taken
    int32_t node;               // of the patch forest
    uint64_t last_frame;        // drawn last
    struct Page *older, *newer; // least recently drawn first
    struct Page *next_free;
} Page;

typedef struct PageStore {
    Page *free_pages[PATCH_FOREST_TEMPLATES];
    Page *oldest, *newest;
    size_t bytes; // of all pages in use
    uint64_t next_id;
} PageStore;

void page_store_destroy(PageStore *store);
// A page without contents for this node, at the end of the list; NULL when memory is out.
Page *page_store_take(PageStore *store, const PatchForest *forest, int template_index, int32_t node);
// Marks a page as drawn in `frame`.
void page_store_touch(PageStore *store, Page *page, uint64_t frame);
// The least recently drawn page, if it was drawn last in frame `released` or before; else NULL.
Page *page_store_oldest(const PageStore *store, uint64_t released);
void page_store_give_back(PageStore *store, Page *page);

// Fills a taken page: positions, codes, sphere. Pure but for the page: any thread.
void page_fill(Page *page, const Terrain *terrain, const PatchTriangle *triangle);
size_t page_bytes(const PatchTemplate *patch);
