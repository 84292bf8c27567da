#include "terrain/patches/page.h"

#include "terrain/terrain_parts.h"

#include <stdlib.h>

#define LANES 16 // arrays are padded to whole vectors

static size_t padded(const PatchTemplate *patch) {
    return ((size_t)patch->vertex_count + LANES - 1) & ~(size_t)(LANES - 1);
}

size_t page_bytes(const PatchTemplate *patch) {
    return sizeof(Page) + padded(patch) * (sizeof(LodVertex) + 3 * sizeof(int32_t) + 2 * sizeof(uint16_t));
}

static Page *page_allocate(const PatchTemplate *patch) {
    size_t count = padded(patch);
    Page *page = calloc(1, sizeof *page);
    unsigned char *memory = page ? aligned_alloc(64, (page_bytes(patch) + 63) & ~(size_t)63) : NULL;
    if (!memory) {
        free(page);
        return NULL;
    }
    page->patch = patch;
    page->shown.vertices = (LodVertex *)(void *)memory;
    page->x = (int32_t *)(void *)(memory + count * sizeof(LodVertex));
    page->y = page->x + count;
    page->z = page->y + count;
    page->delta = (uint16_t *)(void *)(page->z + count);
    page->radius = page->delta + count;
    page->shown.vertex_count = patch->vertex_count;
    return page;
}

static void page_free(Page *page) {
    free((void *)(uintptr_t)page->shown.vertices);
    free(page);
}

static void list_append(PageStore *store, Page *page) {
    page->older = store->newest;
    page->newer = NULL;
    if (store->newest)
        store->newest->newer = page;
    else
        store->oldest = page;
    store->newest = page;
}

static void list_remove(PageStore *store, Page *page) {
    if (page->older)
        page->older->newer = page->newer;
    else
        store->oldest = page->newer;
    if (page->newer)
        page->newer->older = page->older;
    else
        store->newest = page->older;
}

void page_store_destroy(PageStore *store) {
    while (store->oldest) {
        Page *page = store->oldest;
        list_remove(store, page);
        page_free(page);
    }
    for (int i = 0; i < PATCH_FOREST_TEMPLATES; i++) {
        while (store->free_pages[i]) {
            Page *page = store->free_pages[i];
            store->free_pages[i] = page->next_free;
            page_free(page);
        }
    }
    *store = (PageStore){0};
}

Page *page_store_take(PageStore *store, const PatchForest *forest, int template_index, int32_t node) {
    Page *page = store->free_pages[template_index];
    if (page)
        store->free_pages[template_index] = page->next_free;
    else
        page = page_allocate(&forest->templates[template_index]);
    if (!page)
        return NULL;
    page->shown.id = ++store->next_id;
    page->filled = false;
    page->node = node;
    store->bytes += page_bytes(page->patch);
    list_append(store, page);
    return page;
}

void page_store_touch(PageStore *store, Page *page, uint64_t frame) {
    page->last_frame = frame;
    if (store->newest == page)
        return;
    list_remove(store, page);
    list_append(store, page);
}

Page *page_store_oldest(const PageStore *store, uint64_t released) {
    return store->oldest && store->oldest->last_frame <= released ? store->oldest : NULL;
}

void page_store_give_back(PageStore *store, Page *page) {
    list_remove(store, page);
    store->bytes -= page_bytes(page->patch);
    Page **slot = &store->free_pages[page->patch->depth / 2];
    page->next_free = *slot;
    *slot = page;
}

static PatchCorner vertex_corner(const PatchTemplate *patch, const PatchTriangle *t, int v) {
    int i = patch->position[v][0], j = patch->position[v][1], side = patch->side;
    return (PatchCorner){
        t->apex.col + (i * (t->left.col - t->apex.col) + j * (t->right.col - t->apex.col)) / side,
        t->apex.row + (i * (t->left.row - t->apex.row) + j * (t->right.row - t->apex.row)) / side,
    };
}

static int least(int a, int b) {
    return a < b ? a : b;
}

static void fill_sphere(Page *page) {
    double most = 0.0;
    for (int v = 0; v < page->shown.vertex_count; v++) {
        GridPoint p = {page->shown.origin.x + page->x[v], page->shown.origin.y + page->y[v],
                       page->shown.origin.z + page->z[v]};
        double d = vec3d_distance(grid_point_ecef(p), page->centre_ecef);
        most = d > most ? d : most;
    }
    page->radius_m = most * (1.0 + 1e-12);
}

void page_fill(Page *page, const Terrain *terrain, const PatchTriangle *t) {
    PatchCorner middle = patch_triangle_middle(t);
    GridPoint centre = terrain_point(terrain, middle.col, middle.row);
    LodPage *shown = &page->shown;
    LodVertex *vertices = (LodVertex *)(uintptr_t)shown->vertices; // the store's own memory
    shown->origin = grid_whole_metres(centre);
    shown->col0 = least(t->apex.col, least(t->left.col, t->right.col));
    shown->row0 = least(t->apex.row, least(t->left.row, t->right.row));
    for (int v = 0; v < shown->vertex_count; v++) {
        PatchCorner c = vertex_corner(page->patch, t, v);
        GridPoint p = terrain_point(terrain, c.col, c.row);
        ErrorCodes codes = error_field_at(&terrain->errors, c.col, c.row);
        page->x[v] = (int32_t)(p.x - shown->origin.x);
        page->y[v] = (int32_t)(p.y - shown->origin.y);
        page->z[v] = (int32_t)(p.z - shown->origin.z);
        page->delta[v] = codes.delta;
        page->radius[v] = codes.radius;
        vertices[v] = (LodVertex){page->x[v], page->y[v], page->z[v], (uint16_t)(c.col - shown->col0),
                                  (uint16_t)(c.row - shown->row0)};
    }
    page->centre_ecef = grid_point_ecef(centre);
    fill_sphere(page);
    page->filled = true;
}
