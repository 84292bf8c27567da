// terrain/lod_brute.c: every sample, all the time: the reference that the other methods are measured against. The budget
// does not apply to it.
#include "terrain/lod_method.h"
#include "terrain/page.h"
#include "terrain/refine.h"
#include "terrain/terrain_parts.h"

#include "base/clock.h"

#include <stdlib.h>

typedef struct Leaf {
    Page *page;
    PatchTriangle triangle;
    uint8_t level;
} Leaf;

typedef struct Brute {
    const Terrain *terrain;
    PageStore pages;
    Leaf *leaves;
    int32_t leaf_count;
    uint16_t *indices[PATCH_FOREST_TEMPLATES]; // every triangle of a page, shared by all pages of one depth
    bool filled;
} Brute;

static void brute_destroy(void *state) {
    Brute *b = state;
    page_store_destroy(&b->pages);
    for (int i = 0; i < PATCH_FOREST_TEMPLATES; i++)
        free(b->indices[i]);
    free(b->leaves);
    free(b);
}

static void add_leaves(Brute *b, const PatchTile *tile, const PatchTriangle *triangle, int level) {
    if (level == tile->levels) {
        b->leaves[b->leaf_count++] = (Leaf){.triangle = *triangle, .level = (uint8_t)level};
        return;
    }
    PatchCorner middle = patch_triangle_middle(triangle);
    for (int half = 0; half < 2; half++) {
        PatchTriangle child = patch_triangle_half(triangle, middle, half);
        add_leaves(b, tile, &child, level + 1);
    }
}

static Result create_leaves(Brute *b) {
    const PatchForest *forest = &b->terrain->patches;
    size_t count = 0;
    for (int32_t i = 0; i < forest->tile_count; i++)
        count += (size_t)2 << forest->tiles[i].levels;
    b->leaves = malloc(sizeof *b->leaves * count);
    if (!b->leaves)
        return RESULT_MEMORY;
    for (int32_t i = 0; i < forest->tile_count; i++) {
        const PatchTile *tile = &forest->tiles[i];
        int32_t first = b->leaf_count;
        for (int root = 0; root < 2; root++) {
            PatchTriangle triangle = patch_forest_root(&tile->tile, root);
            add_leaves(b, tile, &triangle, 0);
        }
        for (int32_t leaf = first; leaf < b->leaf_count; leaf++) {
            b->leaves[leaf].page = page_store_take(&b->pages, forest, tile->template_index, leaf);
            if (!b->leaves[leaf].page)
                return RESULT_MEMORY;
        }
    }
    return RESULT_OK;
}

static Result brute_create(const LodOptions *options, const Terrain *terrain, void **state) {
    (void)options;
    Brute *b = calloc(1, sizeof *b);
    if (!b)
        return RESULT_MEMORY;
    b->terrain = terrain;
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
        page_fill(b->leaves[i].page, b->terrain, &b->leaves[i].triangle);
}

static LodItem item_of(const Brute *b, const Leaf *leaf, bool first) {
    const PatchTemplate *patch = leaf->page->patch;
    return (LodItem){
        .page = &leaf->page->shown,
        .revision = 1,
        .indices = b->indices[patch->depth / 2],
        .index_count = 3 * patch->triangle_count,
        .level = leaf->level,
        .state = first ? LOD_ITEM_REBUILT : LOD_ITEM_REUSED,
        .centre_ecef = leaf->page->centre_ecef,
        .radius_m = leaf->page->radius_m,
    };
}

static Result brute_update(void *state, const LodCall *call, LodCut *cut) {
    Brute *b = state;
    int64_t begin = clock_now_ns();
    bool first = !b->filled;
    if (first)
        jobs_run(call->jobs, b->leaf_count, 8, fill_task, b);
    b->filled = true;
    LodItem *items = arena_new(call->frame, LodItem, b->leaf_count);
    if (!items)
        return RESULT_MEMORY;
    cut->stats = (LodStats){.patches = b->leaf_count, .patches_reused = first ? 0 : b->leaf_count};
    for (int32_t i = 0; i < b->leaf_count; i++) {
        items[i] = item_of(b, &b->leaves[i], first);
        cut->stats.triangles += items[i].index_count / 3;
        cut->stats.vertices += items[i].page->vertex_count;
        cut->stats.index_bytes += first ? (int64_t)sizeof(uint16_t) * items[i].index_count : 0;
    }
    cut->stats.triangles_rebuilt = first ? cut->stats.triangles : 0;
    cut->stats.refine_ns = clock_now_ns() - begin;
    cut->items = items;
    cut->item_count = b->leaf_count;
    cut->promises = true;
    return RESULT_OK;
}

static void brute_release(void *state, uint64_t frame) {
    (void)state;
    (void)frame; // pages and lists live as long as the method
}

const LodOps LOD_BRUTE_OPS = {
    .name = "brute",
    .create = brute_create,
    .destroy = brute_destroy,
    .update = brute_update,
    .release = brute_release,
};
