// terrain/lod/lod_patch.c: static regular patches over the patch hierarchy: Boesch, Goswami, Pajarola 2009 (RASTeR), as
// Loeffler, Schwanke, Schumann 2010 compare against in their table 2. A patch that is selected shows all vertices of
// its page; patches of one depth share one index list.
//
// Difference from the papers: a DEM of any size. What the largest base tiles leave over is triangulated by vertex
// (lod_patch_rest.c), so that it agrees with the static patches beside (lod_patch_seam.c).
#include "terrain/lod/budget.h"
#include "terrain/lod/lod_method.h"
#include "terrain/lod/lod_patch_near.h"
#include "terrain/lod/lod_patch_rest.h"
#include "terrain/lod/lod_patch_seam.h"
#include "terrain/terrain_parts.h"

#include "base/clock.h"

#include <stdlib.h>

typedef struct Static { // of a node of the patch forest
    Page *page;
    uint64_t made_frame;
} Static;

typedef struct PatchMethod {
    LodOptions options;
    const Terrain *terrain;
    Budget budget;
    PageStore pages;
    PatchSelection selection;
    Static *nodes;                              // [node_count]
    int32_t *rest_of_node;                      // [node_count] in `rest`; -1: a static patch; NULL: all are
    uint16_t *lists[PATCH_FOREST_TEMPLATES];    // every triangle of a page, shared by all pages of one depth
    uint64_t revisions[PATCH_FOREST_TEMPLATES]; // theirs
    uint64_t next_revision;
    PatchSeam seam;
    PatchRest rest;
} PatchMethod;

typedef struct Update {
    PatchMethod *m;
    const LodCall *call;
    double nearest_m; // from the eye to the terrain; 0: not asked for yet
    int32_t *fresh;   // [fresh_count] choices whose page is to be filled
    int32_t fresh_count;
} Update;

// Selection ----------------------------------------------------------------------------------------------------

static int32_t patches_max(const PatchMethod *m, double tau_px) {
    if (!budget_may_give_up(&m->budget, tau_px))
        return INT32_MAX;
    int64_t most = m->options.max_triangles >> m->terrain->patches.depth;
    most += m->rest.count + 2 * (int64_t)m->terrain->patches.tile_count; // patches of fewer triangles
    return most < INT32_MAX ? (int32_t)most : INT32_MAX;
}

typedef struct Asking {
    const PatchForest *forest;
    const SeamView *view;
} Asking;

static bool splits(void *user, const PatchTile *tile, PatchCorner middle) {
    const Asking *asking = user;
    const PatchVertex *vertex = patch_forest_vertex(asking->forest, middle);
    (void)tile;
    return seam_view_matters(asking->view, vertex->delta) &&
           refine_is_active(&asking->view->view, vertex->position, vertex->delta, vertex->radius);
}

// Around the eye patches split for their nested radius alone, at any tolerance. Where that is too much for the budget,
// the true distance to the terrain bounds what their errors can look like.
static SeamView view_at(Update *u, double tau_px) {
    const LodView *view = u->call->view;
    if (tau_px > view->tau_px && u->nearest_m <= 0.0)
        u->nearest_m = near_distance_m(u->m->terrain, view->eye_ecef);
    return (SeamView){refine_view(view, tau_px), tau_px > view->tau_px ? u->nearest_m : 0.0};
}

static Result select_patches(Update *u, double tau_px) {
    PatchMethod *m = u->m;
    const LodCall *call = u->call;
    SeamView view = view_at(u, tau_px);
    int32_t most = patches_max(m, tau_px);
    if (m->seam.empty) {
        Asking asking = {&m->terrain->patches, &view};
        return patch_select_where(asking.forest, splits, &asking, most, &m->selection);
    }
    seam_begin(&m->seam);
    Result result = seam_split(&m->seam, &view, most, &m->selection);
    if (result != RESULT_OK)
        return result;
    rest_decide(&m->rest, &m->seam, &view, call, !m->options.reuse);
    result = seam_close(&m->seam);
    return result == RESULT_OK ? seam_select(&m->seam, most, &m->selection) : result;
}

// Pages --------------------------------------------------------------------------------------------------------

static int32_t rest_of(const PatchMethod *m, const PatchChoice *choice) {
    return m->rest_of_node ? m->rest_of_node[choice->node] : -1;
}

static Result take_pages(Update *u) {
    PatchMethod *m = u->m;
    u->fresh = arena_new(u->call->frame, int32_t, m->selection.count);
    if (!u->fresh)
        return RESULT_MEMORY;
    for (int32_t i = 0; i < m->selection.count; i++) {
        const PatchChoice *choice = &m->selection.choices[i];
        Static *node = &m->nodes[choice->node];
        if (rest_of(m, choice) >= 0 || (node->page && node->page->filled && m->options.reuse))
            continue;
        if (!node->page)
            node->page = page_store_take(&m->pages, &m->terrain->patches, choice->template_index, choice->node);
        if (!node->page)
            return RESULT_MEMORY;
        page_store_touch(&m->pages, node->page, u->call->number);
        node->made_frame = u->call->number;
        if (!node->page->filled)
            u->fresh[u->fresh_count++] = i;
    }
    return RESULT_OK;
}

static void fill_task(void *user, int64_t begin, int64_t end, int worker) {
    const Update *u = user;
    (void)worker;
    for (int64_t i = begin; i < end; i++) {
        const PatchChoice *choice = &u->m->selection.choices[u->fresh[i]];
        page_fill(u->m->nodes[choice->node].page, u->m->terrain, &choice->triangle);
    }
}

static void evict_pages(PatchMethod *m, uint64_t released) {
    Page *page;
    while (m->pages.bytes > m->options.page_bytes_max && (page = page_store_oldest(&m->pages, released))) {
        m->nodes[page->node] = (Static){0};
        page_store_give_back(&m->pages, page);
    }
}

// The cut ------------------------------------------------------------------------------------------------------

static LodItem item_of(const PatchMethod *m, const PatchChoice *choice, uint64_t frame) {
    int32_t rest = rest_of(m, choice);
    const Static *node = &m->nodes[choice->node];
    const RestPage *r = rest < 0 ? NULL : &m->rest.pages[rest];
    const Page *page = r ? r->page : node->page;
    int half_depth = choice->template_index;
    return (LodItem){
        .page = &page->shown,
        .revision = r ? r->revision : m->revisions[half_depth],
        .indices = r ? r->list.indices : m->lists[half_depth],
        .index_count = r ? r->list.index_count : 3 * page->patch->triangle_count,
        .level = choice->level,
        .state = (r ? r->built_frame : node->made_frame) == frame ? LOD_ITEM_REBUILT : LOD_ITEM_REUSED,
        .centre_ecef = page->centre_ecef,
        .radius_m = page->radius_m,
    };
}

static void count_items(const PatchMethod *m, uint64_t frame, LodStats *stats) {
    for (int32_t i = 0; i < m->selection.count; i++) {
        const PatchChoice *choice = &m->selection.choices[i];
        LodItem item = item_of(m, choice, frame);
        int32_t rest = rest_of(m, choice);
        bool rebuilt = item.state == LOD_ITEM_REBUILT;
        stats->triangles += item.index_count / 3;
        stats->vertices += rest < 0 ? item.page->vertex_count : m->rest.pages[rest].vertex_count;
        stats->vertices_evaluated += rest < 0 || !m->rest.pages[rest].stale ? 0 : m->rest.pages[rest].evaluated;
        stats->patches_reused += !rebuilt;
        stats->triangles_rebuilt += rebuilt ? item.index_count / 3 : 0;
        stats->index_bytes += rebuilt ? (int64_t)sizeof(uint16_t) * item.index_count : 0;
    }
    stats->patches = m->selection.count;
    stats->partitions = 1;
}

static Result refine_at(void *user, double tau_px, LodStats *stats) {
    Update *u = user;
    PatchMethod *m = u->m;
    *stats = (LodStats){.select_ns = stats->select_ns, .refine_ns = stats->refine_ns};
    int64_t begin = clock_now_ns();
    u->fresh_count = 0;
    Result result = select_patches(u, tau_px);
    int64_t selected = clock_now_ns();
    stats->select_ns += selected - begin;
    if (result == RESULT_OK)
        result = take_pages(u);
    if (result != RESULT_OK)
        return result;
    jobs_run(u->call->jobs, u->fresh_count, 4, fill_task, u);
    if (!m->seam.empty)
        result = rest_triangulate(&m->rest, &m->seam, u->call, !m->options.reuse, &m->next_revision);
    stats->refine_ns += clock_now_ns() - selected;
    if (result == RESULT_OK)
        count_items(m, u->call->number, stats);
    return result;
}

static Result patch_update(void *state, const LodCall *call, LodCut *cut) {
    PatchMethod *m = state;
    Update u = {.m = m, .call = call};
    Result result = budget_refine(&m->budget, refine_at, &u, cut);
    if (result != RESULT_OK && result != RESULT_BUDGET)
        return result;
    LodItem *items = arena_new(call->frame, LodItem, m->selection.count);
    if (!items)
        return RESULT_MEMORY;
    for (int32_t i = 0; i < m->selection.count; i++) {
        const PatchChoice *choice = &m->selection.choices[i];
        int32_t rest = rest_of(m, choice);
        page_store_touch(&m->pages, rest < 0 ? m->nodes[choice->node].page : m->rest.pages[rest].page, call->number);
        items[i] = item_of(m, choice, call->number);
    }
    cut->items = items;
    cut->item_count = m->selection.count;
    cut->promises = m->terrain->options.error == TERRAIN_ERROR_TOTAL;
    evict_pages(m, call->released);
    return result;
}

// Making and ending --------------------------------------------------------------------------------------------

static void patch_release(void *state, uint64_t frame) {
    PatchMethod *m = state;
    index_store_release(&m->rest.lists, frame);
}

static void patch_destroy(void *state) {
    PatchMethod *m = state;
    page_store_destroy(&m->pages);
    rest_destroy(&m->rest);
    seam_destroy(&m->seam);
    for (int i = 0; i < PATCH_FOREST_TEMPLATES; i++)
        free(m->lists[i]);
    free(m->nodes);
    free(m->rest_of_node);
    patch_selection_destroy(&m->selection);
    free(m);
}

static Result create_lists(PatchMethod *m) {
    for (int i = 0; i < PATCH_FOREST_TEMPLATES; i++) {
        const PatchTemplate *patch = &m->terrain->patches.templates[i];
        if (!patch->position)
            continue;
        m->lists[i] = malloc(sizeof **m->lists * refine_indices_max(patch));
        if (!m->lists[i])
            return RESULT_MEMORY;
        refine_all(patch, m->lists[i]);
        m->revisions[i] = ++m->next_revision;
    }
    return RESULT_OK;
}

static Result create_rest(PatchMethod *m) {
    Result result = seam_create(m->terrain, &m->seam);
    if (result != RESULT_OK || m->seam.empty)
        return result;
    int32_t count = m->terrain->patches.node_count;
    m->rest_of_node = malloc(sizeof *m->rest_of_node * (size_t)count);
    result = m->rest_of_node ? rest_create(&m->seam, &m->pages, &m->rest) : RESULT_MEMORY;
    if (result != RESULT_OK)
        return result;
    for (int32_t i = 0; i < count; i++)
        m->rest_of_node[i] = -1;
    for (int32_t i = 0; i < m->rest.count; i++)
        m->rest_of_node[m->rest.pages[i].page->node] = i;
    return RESULT_OK;
}

static Result patch_create(const LodOptions *options, const Terrain *terrain, void **state) {
    PatchMethod *m = calloc(1, sizeof *m);
    if (!m)
        return RESULT_MEMORY;
    m->options = *options;
    m->terrain = terrain;
    m->budget.max_triangles = options->max_triangles;
    m->pages.next_id = m->next_revision = lod_first_id(options);
    m->nodes = calloc((size_t)terrain->patches.node_count, sizeof *m->nodes);
    Result result = m->nodes ? create_lists(m) : RESULT_MEMORY;
    if (result == RESULT_OK)
        result = create_rest(m);
    if (result != RESULT_OK) {
        patch_destroy(m);
        return result;
    }
    *state = m;
    return RESULT_OK;
}

const LodOps LOD_PATCH_OPS = {
    .create = patch_create,
    .destroy = patch_destroy,
    .update = patch_update,
    .release = patch_release,
};
