#include "terrain/roam/roam_ground.h"

#include "base/log.h"
#include "terrain/terrain_parts.h"

#include <stdlib.h>
#include <string.h>

// ---- squares ----

static Result create_squares(RoamGround *g, int side) {
    Result result = square_grid_create(&g->terrain->forest, side, &g->grid);
    if (result != RESULT_OK)
        return result;
    result = roam_base_create(&g->grid, &g->terrain->errors, &g->base);
    if (result != RESULT_OK)
        square_grid_destroy(&g->grid);
    return result;
}

// Half of the budget is for what the view needs.
static bool is_too_fine(const RoamGround *g, int side) {
    return side < ROAM_SIDE_MAX && 2 * (int64_t)g->base.mesh.leaf_count > g->options.max_triangles &&
           square_grid_fitting_side(g->terrain, 2 * side) == 2 * side;
}

static Result fit_squares(RoamGround *g) {
    int side = g->terrain->patches.side;
    Result result = create_squares(g, side);
    while (result == RESULT_OK && is_too_fine(g, side)) {
        roam_base_destroy(&g->base);
        square_grid_destroy(&g->grid);
        side *= 2;
        result = create_squares(g, side);
    }
    return result;
}

Result roam_ground_create(const LodOptions *options, const Terrain *terrain, RoamGround *out) {
    *out = (RoamGround){.options = *options, .terrain = terrain, .next_revision = lod_first_id(options)};
    Result result = fit_squares(out);
    if (result == RESULT_OK)
        result = roam_field_create(&out->grid, terrain, &out->field);
    if (result == RESULT_OK)
        result = square_page_store_create(&out->grid, lod_first_id(options), &out->pages);
    if (result == RESULT_OK) {
        out->drawn = calloc((size_t)out->grid.count, sizeof *out->drawn);
        result = out->drawn ? RESULT_OK : RESULT_MEMORY;
    }
    if (result != RESULT_OK)
        roam_ground_destroy(out);
    return result;
}

void roam_ground_destroy(RoamGround *ground) {
    free(ground->drawn);
    index_store_destroy(&ground->lists);
    square_page_store_destroy(&ground->pages);
    roam_field_destroy(&ground->field);
    roam_base_destroy(&ground->base);
    square_grid_destroy(&ground->grid);
    *ground = (RoamGround){0};
}

void roam_ground_release(RoamGround *ground, uint64_t frame) {
    index_store_release(&ground->lists, frame);
}

// ---- index lists ----

static bool is_as_before(const RoamDrawn *d, const RoamEmitted *now, const uint16_t *indices) {
    return d->list.indices && d->shape.stride == now->stride && d->list.index_count == now->index_count &&
           memcmp(d->list.indices, indices, sizeof *indices * (size_t)now->index_count) == 0;
}

void roam_ground_draw(RoamGround *ground, const RoamMesh *mesh, int32_t root, int32_t square, int pool,
                      RoamScratch *scratch) {
    RoamDrawn *d = &ground->drawn[square];
    index_list_give_back(&ground->lists, &d->fresh_list); // of a try at a smaller tolerance: nobody read it
    d->failed = false;
    d->fresh = roam_emit(mesh, root, &ground->grid, scratch);
    if (ground->options.reuse && is_as_before(d, &d->fresh, scratch->indices))
        return;
    d->failed = !index_list_take(&ground->lists, pool, d->fresh.index_count, &d->fresh_list);
    if (!d->failed)
        memcpy(d->fresh_list.indices, scratch->indices, sizeof *scratch->indices * (size_t)d->fresh.index_count);
}

// A list has one owner at any time, so that whatever fails later, nothing is retired or given back twice.
static Result adopt_one(RoamGround *g, RoamDrawn *d, const LodCall *call) {
    Result result = index_list_retire(&g->lists, &d->list, call->number - 1);
    if (result != RESULT_OK)
        return result;
    d->list = d->fresh_list;
    d->shape = d->fresh;
    d->fresh_list = (IndexList){0};
    d->revision = ++g->next_revision;
    d->rebuilt = true;
    return RESULT_OK;
}

// The new lists take the old ones' places, in the order of the squares.
static Result adopt(RoamGround *g, const LodCall *call, LodStats *stats) {
    for (int32_t i = 0; i < g->grid.count; i++) {
        RoamDrawn *d = &g->drawn[i];
        if (d->failed)
            return RESULT_MEMORY;
        if (!d->fresh_list.indices)
            continue;
        Result result = adopt_one(g, d, call);
        if (result != RESULT_OK)
            return result;
        stats->triangles_rebuilt += d->list.index_count / 3;
        stats->index_bytes += (int64_t)sizeof(uint16_t) * d->list.index_count;
    }
    return RESULT_OK;
}

// ---- pages and items ----

typedef struct Filling {
    RoamGround *ground;
    SquarePage **pages; // [squares], those to fill
} Filling;

static void fill_task(void *user, int64_t begin, int64_t end, int worker) {
    Filling *f = user;
    (void)worker;
    for (int64_t i = begin; i < end; i++)
        square_page_fill(f->pages[i], &f->ground->grid, f->ground->terrain);
}

// `pages` is used twice: first for those to fill, then each square's.
static Result take_pages(RoamGround *g, const LodCall *call, SquarePage **pages) {
    int32_t to_fill = 0;
    for (int32_t i = 0; i < g->grid.count; i++) {
        SquarePage *page = square_page_take(&g->pages, i, g->drawn[i].shape.stride, call->number);
        if (!page)
            return RESULT_MEMORY;
        if (!page->filled)
            pages[to_fill++] = page;
    }
    Filling filling = {g, pages};
    jobs_run(call->jobs, to_fill, 4, fill_task, &filling);
    return RESULT_OK;
}

static SquarePage *page_of(const RoamGround *g, int32_t square) {
    return g->pages.pages[square * SQUARE_PAGE_STRIDES + __builtin_ctz((unsigned)g->drawn[square].shape.stride)];
}

static LodItem item_of(const RoamGround *g, int32_t square) {
    const RoamDrawn *d = &g->drawn[square];
    const SquarePage *page = page_of(g, square);
    return (LodItem){
        .page = &page->shown,
        .revision = d->revision,
        .indices = d->list.indices,
        .index_count = d->list.index_count,
        .level = (uint8_t)d->shape.level,
        .state = d->rebuilt ? LOD_ITEM_REBUILT : LOD_ITEM_REUSED,
        .partition = d->partition,
        .centre_ecef = page->centre_ecef,
        .radius_m = page->radius_m,
    };
}

static void count_item(const RoamDrawn *d, LodStats *stats) {
    stats->triangles += d->list.index_count / 3;
    stats->vertices += d->shape.vertex_count;
    stats->patches_reused += !d->rebuilt;
}

// Vertices of squares that are drawn coarser than they are known.
static void drop_unused(RoamGround *g) {
    size_t bytes = roam_field_bytes(&g->field) + g->pages.bytes;
    for (int32_t i = 0; i < g->grid.count && bytes > g->options.page_bytes_max; i++) {
        const RoamPatch *patch = &g->field.patches[i];
        if (!patch->vertices || patch->level_end <= g->drawn[i].shape.level + 2)
            continue;
        bytes -= sizeof *patch->vertices * (size_t)patch->across * (size_t)patch->across;
        roam_field_drop(&g->field, i);
    }
}

Result roam_ground_finish(RoamGround *ground, const LodCall *call, LodCut *cut) {
    int32_t count = ground->grid.count;
    LodItem *items = arena_new(call->frame, LodItem, count);
    SquarePage **pages = arena_new(call->frame, SquarePage *, count);
    if (!items || !pages)
        return RESULT_MEMORY;
    Result result = adopt(ground, call, &cut->stats);
    if (result == RESULT_OK)
        result = take_pages(ground, call, pages);
    if (result != RESULT_OK)
        return result;
    for (int32_t i = 0; i < count; i++) {
        items[i] = item_of(ground, i);
        count_item(&ground->drawn[i], &cut->stats);
        ground->drawn[i].rebuilt = false; // it is told
    }
    cut->stats.patches = count;
    cut->items = items;
    cut->item_count = count;
    cut->promises = ground->terrain->options.error == TERRAIN_ERROR_TOTAL;
    square_page_evict(&ground->pages, call->released, ground->options.page_bytes_max);
    drop_unused(ground);
    return RESULT_OK;
}

void roam_ground_abandon(RoamGround *ground) {
    for (int32_t i = 0; i < ground->grid.count; i++) {
        index_list_give_back(&ground->lists, &ground->drawn[i].fresh_list);
        ground->drawn[i].failed = false;
    }
}
