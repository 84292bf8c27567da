#include "terrain/squares/square_page.h"

#include "base/log.h"
#include "terrain/terrain_parts.h"

#include <stdlib.h>

static SquarePage **slot_of(const SquarePageStore *store, int32_t square, int stride) {
    return &store->pages[(size_t)square * SQUARE_PAGE_STRIDES + (size_t)forest_log2(stride)];
}

static size_t page_bytes(int across) {
    return sizeof(SquarePage) + sizeof(LodVertex) * (size_t)across * (size_t)across;
}

Result square_page_store_create(const SquareGrid *grid, uint64_t first_id, SquarePageStore *out) {
    *out = (SquarePageStore){.grid = grid, .next_id = first_id};
    out->pages = calloc((size_t)grid->count * SQUARE_PAGE_STRIDES, sizeof(SquarePage *));
    if (out->pages)
        return RESULT_OK;
    log_error("squares: not enough memory for the table of %d pages", grid->count);
    return RESULT_MEMORY;
}

static void list_append(SquarePageStore *store, SquarePage *page) {
    page->older = store->newest;
    page->newer = NULL;
    *(store->newest ? &store->newest->newer : &store->oldest) = page;
    store->newest = page;
}

static void list_remove(SquarePageStore *store, SquarePage *page) {
    *(page->older ? &page->older->newer : &store->oldest) = page->newer;
    *(page->newer ? &page->newer->older : &store->newest) = page->older;
}

static void free_page(SquarePage *page) {
    free((void *)(uintptr_t)page->shown.vertices);
    free(page);
}

void square_page_store_destroy(SquarePageStore *store) {
    while (store->oldest) {
        SquarePage *page = store->oldest;
        list_remove(store, page);
        free_page(page);
    }
    for (int i = 0; i < SQUARE_PAGE_STRIDES; i++) {
        while (store->free_pages[i]) {
            SquarePage *page = store->free_pages[i];
            store->free_pages[i] = page->next_free;
            free_page(page);
        }
    }
    free(store->pages);
    *store = (SquarePageStore){0};
}

static SquarePage *allocate_page(int across) {
    SquarePage *page = calloc(1, sizeof *page);
    LodVertex *vertices = page ? malloc(sizeof *vertices * (size_t)across * (size_t)across) : NULL;
    if (!vertices) {
        free(page);
        return NULL;
    }
    page->shown.vertices = vertices;
    page->shown.vertex_count = across * across;
    page->across = across;
    return page;
}

static SquarePage *new_page(SquarePageStore *store, int32_t square, int stride) {
    int cells = store->grid->squares[square].side / stride;
    SquarePage **list = &store->free_pages[forest_log2(cells)];
    SquarePage *page = *list;
    if (page)
        *list = page->next_free;
    else
        page = allocate_page(cells + 1);
    if (!page)
        return NULL;
    page->shown.id = ++store->next_id;
    page->square = square;
    page->stride = stride;
    page->filled = false;
    store->bytes += page_bytes(page->across);
    *slot_of(store, square, stride) = page;
    list_append(store, page);
    return page;
}

SquarePage *square_page_take(SquarePageStore *store, int32_t square, int stride, uint64_t frame) {
    SquarePage *page = *slot_of(store, square, stride);
    if (!page)
        page = new_page(store, square, stride);
    if (!page)
        return NULL;
    page->last_frame = frame;
    if (store->newest != page) {
        list_remove(store, page);
        list_append(store, page);
    }
    return page;
}

void square_page_evict(SquarePageStore *store, uint64_t released, size_t bytes_max) {
    while (store->bytes > bytes_max && store->oldest && store->oldest->last_frame <= released) {
        SquarePage *page = store->oldest;
        list_remove(store, page);
        store->bytes -= page_bytes(page->across);
        *slot_of(store, page->square, page->stride) = NULL;
        SquarePage **list = &store->free_pages[forest_log2(page->across - 1)];
        page->next_free = *list;
        *list = page;
    }
}

static double reach_of(const SquarePage *page, const LodVertex *v) {
    const GridPoint *o = &page->shown.origin;
    return vec3d_distance(grid_point_ecef((GridPoint){o->x + v->x, o->y + v->y, o->z + v->z}), page->centre_ecef);
}

void square_page_fill(SquarePage *page, const SquareGrid *grid, const Terrain *terrain) {
    const ForestTile *square = &grid->squares[page->square];
    LodPage *shown = &page->shown;
    LodVertex *vertices = (LodVertex *)(uintptr_t)shown->vertices; // the store's own memory
    GridPoint centre = terrain_point(terrain, square->col + square->side / 2, square->row + square->side / 2);
    shown->origin = grid_whole_metres(centre);
    shown->col0 = square->col;
    shown->row0 = square->row;
    page->centre_ecef = grid_point_ecef(centre);
    page->radius_m = 0.0;
    for (int v = 0; v < shown->vertex_count; v++) {
        int col = v % page->across * page->stride, row = v / page->across * page->stride;
        GridPoint p = terrain_point(terrain, square->col + col, square->row + row);
        vertices[v] = (LodVertex){(int32_t)(p.x - shown->origin.x), (int32_t)(p.y - shown->origin.y),
                                  (int32_t)(p.z - shown->origin.z), (uint16_t)col, (uint16_t)row};
        double reach = reach_of(page, &vertices[v]) * (1.0 + 1e-12);
        page->radius_m = reach > page->radius_m ? reach : page->radius_m;
    }
    page->filled = true;
}
