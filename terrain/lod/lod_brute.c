// terrain/lod/lod_brute.c: every sample, all the time: the reference that the other methods are measured against. The
// budget does not apply to it.
#include "terrain/lod/lod_method.h"
#include "terrain/patches/page.h"
#include "terrain/patches/patch_select.h"
#include "terrain/patches/refine.h"
#include "terrain/terrain_parts.h"

#include "base/clock.h"

#include <stdlib.h>

typedef struct Brute {
    const Terrain *terrain;
    PageStore pages;
    PatchSelection leaves;
    Page **leaf_pages;                         // [leaves.count]
    uint16_t *indices[PATCH_FOREST_TEMPLATES]; // every triangle of a page, shared by all pages of one depth
    bool filled;
} Brute;

static void brute_destroy(void *state) {
    Brute *b = state;
    page_store_destroy(&b->pages);
    for (int i = 0; i < PATCH_FOREST_TEMPLATES; i++)
        free(b->indices[i]);
    free(b->leaf_pages);
    patch_selection_destroy(&b->leaves);
    free(b);
}

static Result create_leaves(Brute *b) {
    const PatchForest *forest = &b->terrain->patches;
    Result result = patch_select_finest(forest, &b->leaves);
    if (result != RESULT_OK)
        return result;
    b->leaf_pages = calloc((size_t)b->leaves.count, sizeof *b->leaf_pages);
    if (!b->leaf_pages)
        return RESULT_MEMORY;
    for (int32_t i = 0; i < b->leaves.count; i++) {
        const PatchChoice *leaf = &b->leaves.choices[i];
        b->leaf_pages[i] = page_store_take(&b->pages, forest, leaf->template_index, leaf->node);
        if (!b->leaf_pages[i])
            return RESULT_MEMORY;
    }
    return RESULT_OK;
}

static Result brute_create(const LodOptions *options, const Terrain *terrain, void **state) {
    Brute *b = calloc(1, sizeof *b);
    if (!b)
        return RESULT_MEMORY;
    b->terrain = terrain;
    b->pages.next_id = lod_first_id(options);
    Result result = create_leaves(b);
    for (int i = 0; i < PATCH_FOREST_TEMPLATES && result == RESULT_OK; i++) {
        const PatchTemplate *patch = &terrain->patches.templates[i];
        if (!patch->position)
            continue;
        b->indices[i] = malloc(sizeof **b->indices * refine_indices_max(patch));
        if (b->indices[i])
            refine_all(patch, b->indices[i]);
        else
            result = RESULT_MEMORY;
    }
    if (result != RESULT_OK) {
        brute_destroy(b);
        return result;
    }
    *state = b;
    return RESULT_OK;
}

static void fill_task(void *user, int64_t begin, int64_t end, int worker) {
    Brute *b = user;
    (void)worker;
    for (int64_t i = begin; i < end; i++)
        page_fill(b->leaf_pages[i], b->terrain, &b->leaves.choices[i].triangle);
}

static LodItem item_of(const Brute *b, int32_t leaf, bool first) {
    const Page *page = b->leaf_pages[leaf];
    const PatchTemplate *patch = page->patch;
    return (LodItem){
        .page = &page->shown,
        .revision = 1,
        .indices = b->indices[patch->depth / 2],
        .index_count = 3 * patch->triangle_count,
        .level = b->leaves.choices[leaf].level,
        .state = first ? LOD_ITEM_REBUILT : LOD_ITEM_REUSED,
        .centre_ecef = page->centre_ecef,
        .radius_m = page->radius_m,
    };
}

static Result brute_update(void *state, const LodCall *call, LodCut *cut) {
    Brute *b = state;
    int64_t begin = clock_now_ns();
    bool first = !b->filled;
    if (first)
        jobs_run(call->jobs, b->leaves.count, 8, fill_task, b);
    b->filled = true;
    LodItem *items = arena_new(call->frame, LodItem, b->leaves.count);
    if (!items)
        return RESULT_MEMORY;
    cut->stats = (LodStats){.patches = b->leaves.count, .patches_reused = first ? 0 : b->leaves.count};
    for (int32_t i = 0; i < b->leaves.count; i++) {
        items[i] = item_of(b, i, first);
        cut->stats.triangles += items[i].index_count / 3;
        cut->stats.vertices += items[i].page->vertex_count;
        cut->stats.index_bytes += first ? (int64_t)sizeof(uint16_t) * items[i].index_count : 0;
    }
    cut->stats.triangles_rebuilt = first ? cut->stats.triangles : 0;
    cut->stats.partitions = 1;
    cut->stats.refine_ns = clock_now_ns() - begin;
    cut->items = items;
    cut->item_count = b->leaves.count;
    cut->promises = true;
    return RESULT_OK;
}

static void brute_release(void *state, uint64_t frame) {
    (void)state;
    (void)frame; // pages and lists live as long as the method
}

const LodOps LOD_BRUTE_OPS = {
    .create = brute_create,
    .destroy = brute_destroy,
    .update = brute_update,
    .release = brute_release,
};
