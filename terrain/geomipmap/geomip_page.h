// terrain/geomipmap/geomip_page.h: vertices as Ye, Wang morph them: pages that live as long as one state of a tile.
// Lattice units (grid.h) from the page's origin; levels as in geomip_levels.h.
// Pages belong to a GeomipPageStore; workers fill them, the thread that owns it takes and retires them.
#pragma once
#include "terrain/geomipmap/geomip_mesh.h"
#include "terrain/lod/lod.h"

typedef struct GeomipPage {
    LodPage shown; // vertices in the order of GeomipOutline
    Vec3d centre_ecef;
    double radius_m; // of a sphere around all vertices
    int size_class;
    uint64_t last_frame; // that may read a retired page
    struct GeomipPage *next;
} GeomipPage;

#define GEOMIP_PAGE_CLASSES 16 // 4, 8, 16 .. 2^17 vertices

typedef struct GeomipPageStore {
    GeomipPage *free_pages[GEOMIP_PAGE_CLASSES];
    GeomipPage *retired, *retired_last; // in the order of last_frame
    uint64_t next_id;
} GeomipPageStore;
void geomip_page_store_destroy(GeomipPageStore *store);

// A page with a new id and room for so many vertices; NULL when memory is out.
GeomipPage *geomip_page_take(GeomipPageStore *store, int vertex_count);
// The page may be read until `last_frame` is released. NULL: nothing happens.
void geomip_page_retire(GeomipPageStore *store, GeomipPage *page, uint64_t last_frame);
void geomip_page_store_release(GeomipPageStore *store, uint64_t frame);

// Section 3.3: each vertex that the next level lacks on its way to the middle of that level's edge; border vertices by
// the coarser side's level, whose line the finer ones lie on: the same bits in both tiles' pages. Pure but for the
// page.
void geomip_page_fill(GeomipPage *page, const GeomipTiles *tiles, const int16_t *drawn, int32_t tile,
                      const GeomipOutline *outline);
