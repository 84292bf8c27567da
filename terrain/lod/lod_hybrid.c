// terrain/lod/lod_hybrid.c: the hybrid method of Loeffler, Schwanke, Schumann 2010, section 4: a cut through the patch
// hierarchy (4.1), each selected patch triangulated by vertex (4.2), its triangulation kept and drawn again while the
// eye stays in its sphere of validity (4.3). What is stale is triangulated in partitions along the observer line, by
// the pool.
//
// Differences from the paper: activity is nu delta + r > d, which does not flip its sign inside a vertex's sphere;
// selection is done anew each frame (microseconds), so the sphere need not count the patch's own split; triangles are
// an index list, no strip.
#include "terrain/lod/budget.h"
#include "terrain/lod/lod_method.h"
#include "terrain/lod/partition.h"
#include "terrain/patches/index_list.h"
#include "terrain/patches/page.h"
#include "terrain/patches/patch_select.h"
#include "terrain/patches/refine.h"
#include "terrain/terrain_parts.h"

#include "base/clock.h"
#include "base/log.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// A selection is given up, before it costs memory, when its patches at one in so many of their triangles are above the
// budget.
#define PATCH_SHARE 8
// Predicted nanoseconds, to balance partitions: measured on one core at 2.5 GHz, only their ratios matter.
#define WORK_FILL_VERTEX 30.0
#define WORK_DECIDE_VERTEX 1.5
#define WORK_TRIANGLE 5.0

typedef struct Node { // of the patch forest: what is kept of a patch between frames
    Page *page;
    IndexList list;
    int32_t vertex_count;
    uint64_t revision;
    Vec3d built_eye;
    double built_nu, validity_m;
} Node;

typedef struct Selected { // what this frame finds out about a chosen patch
    double turn;
    uint16_t partition;
    bool stale;
} Selected;

typedef struct Stale { // a patch to be triangulated in this frame
    int32_t choice;    // index in the selection
    uint16_t partition;
    IndexList list;
    RefineResult result;
} Stale;

typedef struct Scratch { // of a partition
    uint8_t *active;
    uint16_t *indices;
} Scratch;

typedef struct Hybrid {
    LodOptions options;
    const Terrain *terrain;
    PageStore pages;
    Node *nodes; // [node_count]
    uint64_t next_revision;
    Budget budget;
    PatchSelection selection;
    Selected *selected; // [selection.count], in the frame's memory
    IndexStore lists;   // a pool a partition
    Scratch scratch[LOD_PARTITIONS_MAX];
} Hybrid;

// Index lists and pages of earlier frames ----------------------------------------------------------------------

static void hybrid_release(void *state, uint64_t frame) {
    Hybrid *h = state;
    index_store_release(&h->lists, frame);
}

// A page goes with its node's triangulation. Both were drawn last in a released frame, so nobody reads them.
static void evict_pages(Hybrid *h, uint64_t released) {
    Page *page;
    while (h->pages.bytes > h->options.page_bytes_max && (page = page_store_oldest(&h->pages, released))) {
        Node *node = &h->nodes[page->node];
        index_list_give_back(&h->lists, &node->list);
        *node = (Node){0};
        page_store_give_back(&h->pages, page);
    }
}

// Selection (4.1) ---------------------------------------------------------------------------------------------

static int32_t patches_max(const Hybrid *h, double tau_px) {
    if (!budget_may_give_up(&h->budget, tau_px))
        return INT32_MAX;
    int64_t share = ((int64_t)1 << h->terrain->options.patch_level) / PATCH_SHARE;
    int64_t most = h->options.max_triangles / (share > 1 ? share : 1);
    most += 8 * (int64_t)h->terrain->patches.tile_count; // small tiles: patches of few triangles
    return most < INT32_MAX ? (int32_t)most : INT32_MAX;
}

static Result select_patches(Hybrid *h, const LodCall *call, const RefineView *view, double tau_px) {
    Result result = patch_select(&h->terrain->patches, view, patches_max(h, tau_px), &h->selection);
    if (result != RESULT_OK)
        return result;
    h->selected = arena_new(call->frame, Selected, h->selection.count);
    if (!h->selected)
        return RESULT_MEMORY;
    memset(h->selected, 0, sizeof *h->selected * (size_t)h->selection.count);
    return RESULT_OK;
}

// What is stale (4.3) ------------------------------------------------------------------------------------------

typedef struct Update { // one pass over the selection
    Hybrid *h;
    const LodCall *call;
    RefineView view;
    Stale *stale;
    int32_t stale_count;
    double *turns, *costs;   // [stale]
    int32_t *order, *begins; // [stale] grouped by partition; [partitions + 1]
    double borders[LOD_PARTITIONS_MAX];
    int partitions;
    bool failed[LOD_PARTITIONS_MAX];
} Update;

static bool is_valid(const Hybrid *h, const Node *node, const RefineView *view, Vec3d eye) {
    return h->options.reuse && node->list.indices && node->built_nu == view->nu &&
           vec3d_distance(eye, node->built_eye) < node->validity_m;
}

static double predicted_work(const Node *node) {
    const PatchTemplate *patch = node->page->patch;
    double fill = node->page->filled ? 0.0 : WORK_FILL_VERTEX * patch->vertex_count;
    double triangles = node->list.indices ? node->list.index_count / 3.0 : 0.25 * patch->triangle_count;
    return fill + WORK_DECIDE_VERTEX * patch->vertex_count + WORK_TRIANGLE * triangles;
}

static Vec3d patch_middle(const Update *u, const PatchChoice *choice) {
    PatchCorner c = patch_triangle_middle(&choice->triangle);
    return terrain_ecef(u->h->terrain, c.col, c.row);
}

static Result mark_stale(Update *u, const ObserverLine *line) {
    Hybrid *h = u->h;
    for (int32_t i = 0; i < h->selection.count; i++) {
        Selected *selected = &h->selected[i];
        const PatchChoice *choice = &h->selection.choices[i];
        Node *node = &h->nodes[choice->node];
        bool filled = node->page && node->page->filled;
        if (u->partitions > 1)
            selected->turn = partition_turn(line, filled ? node->page->centre_ecef : patch_middle(u, choice));
        if (node->page && is_valid(h, node, &u->view, u->call->view->eye_ecef))
            continue;
        selected->stale = true;
        if (!node->page)
            node->page = page_store_take(&h->pages, &h->terrain->patches, choice->template_index, choice->node);
        if (!node->page)
            return RESULT_MEMORY;
        page_store_touch(&h->pages, node->page, u->call->number);
        u->turns[u->stale_count] = selected->turn;
        u->costs[u->stale_count] = predicted_work(node);
        u->stale[u->stale_count++] = (Stale){.choice = i};
    }
    return RESULT_OK;
}

// Groups the stale patches by partition, in the order of the selection within each.
static void group_stale(Update *u) {
    partition_borders(u->partitions, u->turns, u->costs, u->stale_count, u->order, u->borders);
    memset(u->begins, 0, sizeof *u->begins * (size_t)(u->partitions + 1));
    for (int32_t i = 0; i < u->stale_count; i++) {
        u->stale[i].partition = (uint16_t)partition_of(u->borders, u->partitions, u->turns[i]);
        u->begins[u->stale[i].partition + 1]++;
    }
    int32_t next[LOD_PARTITIONS_MAX];
    for (int p = 0; p < u->partitions; p++) {
        u->begins[p + 1] += u->begins[p];
        next[p] = u->begins[p];
    }
    for (int32_t i = 0; i < u->stale_count; i++)
        u->order[next[u->stale[i].partition]++] = i;
}

// Triangulation (4.2), by the workers --------------------------------------------------------------------------

static bool triangulate(const Update *u, Stale *stale, int partition) {
    Hybrid *h = u->h;
    Scratch *scratch = &h->scratch[partition];
    const PatchChoice *choice = &h->selection.choices[stale->choice];
    Page *page = h->nodes[choice->node].page;
    if (!page->filled)
        page_fill(page, h->terrain, &choice->triangle);
    stale->result = refine_page(page, &u->view, scratch->active, scratch->indices);
    if (!index_list_take(&h->lists, partition, stale->result.index_count, &stale->list))
        return false;
    memcpy(stale->list.indices, scratch->indices, sizeof(uint16_t) * (size_t)stale->list.index_count);
    return true;
}

static void triangulate_partitions(void *user, int64_t begin, int64_t end, int worker) {
    Update *u = user;
    (void)worker;
    for (int p = (int)begin; p < (int)end; p++)
        for (int32_t k = u->begins[p]; k < u->begins[p + 1] && !u->failed[p]; k++)
            u->failed[p] = !triangulate(u, &u->stale[u->order[k]], p);
}

static Result create_scratch(Hybrid *h, int partitions) {
    const PatchForest *forest = &h->terrain->patches;
    size_t active = 0, indices = 0;
    for (int i = 0; i < PATCH_FOREST_TEMPLATES; i++) {
        if (forest->templates[i].position) { // the last one in use is the largest
            active = refine_active_bytes(&forest->templates[i]);
            indices = refine_indices_max(&forest->templates[i]);
        }
    }
    for (int p = 0; p < partitions; p++) {
        Scratch *scratch = &h->scratch[p];
        if (!scratch->active)
            scratch->active = malloc(active);
        if (!scratch->indices)
            scratch->indices = malloc(indices * sizeof *scratch->indices);
        if (!scratch->active || !scratch->indices)
            return RESULT_MEMORY;
    }
    return RESULT_OK;
}

// The new triangulations take their nodes' places, in the order of the selection.
static Result adopt(Update *u, LodStats *stats) {
    Hybrid *h = u->h;
    Result result = RESULT_OK;
    for (int32_t i = 0; i < u->stale_count; i++) {
        Stale *stale = &u->stale[i];
        Node *node = &h->nodes[h->selection.choices[stale->choice].node];
        if (result == RESULT_OK)
            result = index_list_retire(&h->lists, &node->list, u->call->number - 1);
        if (result != RESULT_OK || !stale->list.indices)
            continue;
        node->list = stale->list;
        node->vertex_count = stale->result.vertex_count;
        node->revision = ++h->next_revision;
        node->built_eye = u->call->view->eye_ecef;
        node->built_nu = u->view.nu;
        node->validity_m = stale->result.validity_m;
        stats->triangles_rebuilt += stale->list.index_count / 3;
        stats->vertices_evaluated += stale->result.evaluated;
        stats->index_bytes += (int64_t)sizeof(uint16_t) * stale->list.index_count;
    }
    for (int p = 0; p < u->partitions; p++)
        if (u->failed[p])
            result = RESULT_MEMORY;
    return result;
}

static int partition_count(const Hybrid *h, const Jobs *jobs) {
    if (h->options.partitions)
        return h->options.partitions;
    int workers = jobs_worker_count(jobs);
    return workers == 1 ? 1 : workers < LOD_PARTITIONS_MAX / 2 ? 2 * workers : LOD_PARTITIONS_MAX;
}

static bool allocate_update(Update *u) {
    int32_t most = u->h->selection.count;
    u->stale = arena_new(u->call->frame, Stale, most);
    u->turns = arena_new(u->call->frame, double, most);
    u->costs = arena_new(u->call->frame, double, most);
    u->order = arena_new(u->call->frame, int32_t, most);
    u->begins = arena_new(u->call->frame, int32_t, u->partitions + 1);
    return u->stale && u->turns && u->costs && u->order && u->begins;
}

static Result triangulate_stale(Update *u, LodStats *stats) {
    if (!allocate_update(u))
        return RESULT_MEMORY;
    ObserverLine line = partition_observer_line(u->call->view->eye_ecef, u->call->view->forward_ecef);
    Result result = create_scratch(u->h, u->partitions);
    if (result == RESULT_OK)
        result = mark_stale(u, &line);
    if (result != RESULT_OK)
        return result;
    group_stale(u);
    jobs_run(u->call->jobs, u->partitions, 1, triangulate_partitions, u);
    for (int32_t i = 0; u->partitions > 1 && i < u->h->selection.count; i++)
        u->h->selected[i].partition = (uint16_t)partition_of(u->borders, u->partitions, u->h->selected[i].turn);
    return adopt(u, stats);
}

// The cut ------------------------------------------------------------------------------------------------------

typedef struct Refining {
    Hybrid *h;
    const LodCall *call;
} Refining;

static Result refine_at(void *user, double tau_px, LodStats *stats) {
    const Refining *refining = user;
    Hybrid *h = refining->h;
    const LodCall *call = refining->call;
    *stats = (LodStats){.select_ns = stats->select_ns, .refine_ns = stats->refine_ns};
    int64_t begin = clock_now_ns();
    Update u = {
        .h = h, .call = call, .view = refine_view(call->view, tau_px), .partitions = partition_count(h, call->jobs)};
    Result result = select_patches(h, call, &u.view, tau_px);
    int64_t selected = clock_now_ns();
    stats->select_ns += selected - begin;
    if (result != RESULT_OK)
        return result;
    result = triangulate_stale(&u, stats);
    stats->refine_ns += clock_now_ns() - selected;
    for (int32_t i = 0; i < h->selection.count && result == RESULT_OK; i++) {
        const Node *node = &h->nodes[h->selection.choices[i].node];
        stats->triangles += node->list.index_count / 3;
        stats->vertices += node->vertex_count;
        stats->patches_reused += !h->selected[i].stale;
    }
    stats->patches = h->selection.count;
    stats->partitions = u.partitions;
    return result;
}

static LodItem item_of(const Hybrid *h, int32_t index) {
    const PatchChoice *choice = &h->selection.choices[index];
    const Selected *selected = &h->selected[index];
    const Node *node = &h->nodes[choice->node];
    return (LodItem){
        .page = &node->page->shown,
        .revision = node->revision,
        .indices = node->list.indices,
        .index_count = node->list.index_count,
        .level = choice->level,
        .state = selected->stale ? LOD_ITEM_REBUILT : LOD_ITEM_REUSED,
        .partition = selected->partition,
        .centre_ecef = node->page->centre_ecef,
        .radius_m = node->page->radius_m,
    };
}

static Result hybrid_update(void *state, const LodCall *call, LodCut *cut) {
    Hybrid *h = state;
    Refining refining = {h, call};
    Result result = budget_refine(&h->budget, refine_at, &refining, cut);
    if (result != RESULT_OK && result != RESULT_BUDGET)
        return result;
    LodItem *items = arena_new(call->frame, LodItem, h->selection.count);
    if (!items)
        return RESULT_MEMORY;
    for (int32_t i = 0; i < h->selection.count; i++) {
        page_store_touch(&h->pages, h->nodes[h->selection.choices[i].node].page, call->number);
        items[i] = item_of(h, i);
    }
    cut->items = items;
    cut->item_count = h->selection.count;
    cut->promises = h->terrain->options.error == TERRAIN_ERROR_TOTAL;
    evict_pages(h, call->released);
    return result;
}

static void hybrid_destroy(void *state) {
    Hybrid *h = state;
    page_store_destroy(&h->pages);
    for (int p = 0; p < LOD_PARTITIONS_MAX; p++) {
        free(h->scratch[p].active);
        free(h->scratch[p].indices);
    }
    free(h->nodes);
    patch_selection_destroy(&h->selection);
    index_store_destroy(&h->lists);
    free(h);
}

static Result hybrid_create(const LodOptions *options, const Terrain *terrain, void **state) {
    Hybrid *h = calloc(1, sizeof *h);
    if (!h)
        return RESULT_MEMORY;
    h->options = *options;
    h->terrain = terrain;
    h->budget.max_triangles = options->max_triangles;
    h->pages.next_id = h->next_revision = lod_first_id(options);
    h->nodes = calloc((size_t)terrain->patches.node_count, sizeof *h->nodes);
    if (!h->nodes) {
        hybrid_destroy(h);
        return RESULT_MEMORY;
    }
    *state = h;
    return RESULT_OK;
}

const LodOps LOD_HYBRID_OPS = {
    .create = hybrid_create,
    .destroy = hybrid_destroy,
    .update = hybrid_update,
    .release = hybrid_release,
};
