// terrain/lod/lod_geomipmap.c: the methods of de Boer 2000 (geomipmap) and of Ye, Wang (geomipmap-ye): square tiles,
// each drawn at one of a few regular levels, the borders between different levels re-triangulated. What a tile shows is
// made anew when its level or a neighbour's changes, with Ye's method its morph as well, by the pool; else it is kept.
// docs/geomipmap.md says where they differ from their papers.
#include "terrain/geomipmap/geomip_page.h"
#include "terrain/lod/budget.h"
#include "terrain/lod/lod_method.h"
#include "terrain/patches/index_list.h"
#include "terrain/squares/square_page.h"
#include "terrain/terrain_parts.h"

#include "base/clock.h"
#include "base/log.h"

#include <stdlib.h>
#include <string.h>

typedef struct Node { // what is kept of a tile between frames
    IndexList list;
    int32_t vertex_count; // drawn
    uint64_t revision;
    GeomipPage *page;   // Ye
    SquarePage *square; // de Boer
    bool stale;         // in this frame
} Node;

typedef struct Geomip {
    LodOptions options;
    GeomipRule rule;
    GeomipBorder border;
    GeomipTiles tiles;
    GeomipLevels levels;
    int16_t *before; // [tile] the levels of the frame before
    bool has_before;
    Node *nodes; // [tile]
    IndexStore lists;
    GeomipPageStore pages;
    SquarePageStore squares;
    uint64_t next_revision;
} Geomip;

typedef struct Update {
    Geomip *g;
    const LodCall *call;
    int32_t *stale; // [stale_count] tiles
    int32_t stale_count;
} Update;

// ---- levels within the budget ----

typedef struct Choosing {
    Geomip *g;
    const LodCall *call;
} Choosing;

static Result choose_at(void *user, double tau_px, LodStats *stats) {
    const Choosing *choosing = user;
    Geomip *g = choosing->g;
    const LodView *view = choosing->call->view;
    geomip_levels_choose(&g->tiles, g->rule, view->eye_ecef, view->px_per_rad, tau_px, choosing->call->jobs,
                         &g->levels);
    stats->vertices_evaluated += g->tiles.squares.count;
    stats->triangles = g->levels.triangles;
    return RESULT_OK;
}

// Levels are chosen soon enough to begin anew in each frame: what is drawn follows from the view alone.
static Result choose_levels(Geomip *g, const LodCall *call, LodCut *cut) {
    Choosing choosing = {g, call};
    Budget budget = {.max_triangles = g->options.max_triangles};
    return budget_refine(&budget, choose_at, &choosing, cut);
}

// ---- what is stale ----

static bool border_changed(const Geomip *g, const GeomipLink *link, int own) {
    int now = geomip_level_beyond(g->levels.drawn, link, own), then = geomip_level_beyond(g->before, link, own);
    if (now == then)
        return false;
    return geomip_border_stride(g->border, own, now) != geomip_border_stride(g->border, own, then) ||
           geomip_border_level(own, now) != geomip_border_level(own, then);
}

static bool is_stale(const Geomip *g, int32_t tile) {
    int own = g->levels.drawn[tile];
    if (!g->options.reuse || !g->has_before || !g->nodes[tile].list.indices || own != g->before[tile])
        return true;
    for (int32_t k = g->tiles.tiles[tile].first_link; k < g->tiles.tiles[tile + 1].first_link; k++)
        if (border_changed(g, &g->tiles.links[k], own))
            return true;
    return false;
}

// Takes the places of what is stale; the workers fill them.
static Result renew(Update *u, int32_t tile) {
    Geomip *g = u->g;
    Node *node = &g->nodes[tile];
    GeomipSize size = geomip_mesh_size(&g->tiles, g->levels.drawn, tile, g->border);
    Result result = index_list_retire(&g->lists, &node->list, u->call->number - 1);
    if (result != RESULT_OK)
        return result;
    if (!index_list_take(&g->lists, 0, 3 * size.triangles, &node->list))
        return RESULT_MEMORY;
    if (g->rule.ye) {
        geomip_page_retire(&g->pages, node->page, u->call->number - 1);
        node->page = geomip_page_take(&g->pages, size.vertices);
        if (!node->page)
            return RESULT_MEMORY;
    }
    node->revision = ++g->next_revision;
    u->stale[u->stale_count++] = tile;
    return RESULT_OK;
}

static Result take_square(Update *u, int32_t tile) {
    Geomip *g = u->g;
    int stride = 1 << g->levels.drawn[tile] / GEOMIP_LEVEL;
    g->nodes[tile].square = square_page_take(&g->squares, tile, stride, u->call->number);
    return g->nodes[tile].square ? RESULT_OK : RESULT_MEMORY;
}

static Result renew_stale(Update *u) {
    Geomip *g = u->g;
    Result result = RESULT_OK;
    for (int32_t i = 0; i < g->tiles.squares.count && result == RESULT_OK; i++) {
        if (!g->rule.ye)
            result = take_square(u, i);
        g->nodes[i].stale = is_stale(g, i);
        if (result == RESULT_OK && g->nodes[i].stale)
            result = renew(u, i);
    }
    return result;
}

// ---- the workers' part ----

static void fill_tile(Geomip *g, int32_t tile) {
    Node *node = &g->nodes[tile];
    GeomipOutline outline;
    geomip_mesh_outline(&g->tiles, g->levels.drawn, tile, g->border, &outline);
    int grid = outline.across * outline.across, omitted = 4 * (outline.across - 1) - outline.count;
    (void)geomip_mesh_indices(&outline, &g->tiles.squares.squares[tile], g->border, node->list.indices);
    node->vertex_count = g->rule.ye ? outline.vertex_count : grid - omitted;
    if (g->rule.ye)
        geomip_page_fill(node->page, &g->tiles, g->levels.drawn, tile, &outline);
    else if (!node->square->filled)
        square_page_fill(node->square, &g->tiles.squares, g->tiles.terrain);
}

static void fill_stale(void *user, int64_t begin, int64_t end, int worker) {
    const Update *u = user;
    (void)worker;
    for (int64_t i = begin; i < end; i++)
        fill_tile(u->g, u->stale[i]);
}

// ---- the cut ----

static LodItem item_of(const Geomip *g, int32_t tile) {
    const Node *node = &g->nodes[tile];
    return (LodItem){
        .page = g->rule.ye ? &node->page->shown : &node->square->shown,
        .revision = node->revision,
        .indices = node->list.indices,
        .index_count = node->list.index_count,
        .level = (uint8_t)(g->tiles.levels - 1 - g->levels.drawn[tile] / GEOMIP_LEVEL),
        .state = node->stale ? LOD_ITEM_REBUILT : LOD_ITEM_REUSED,
        .centre_ecef = g->rule.ye ? node->page->centre_ecef : node->square->centre_ecef,
        .radius_m = g->rule.ye ? node->page->radius_m : node->square->radius_m,
    };
}

static Result fill_cut(const Geomip *g, const LodCall *call, LodCut *cut) {
    int32_t count = g->tiles.squares.count;
    LodItem *items = arena_new(call->frame, LodItem, count);
    if (!items)
        return RESULT_MEMORY;
    LodStats *stats = &cut->stats;
    for (int32_t i = 0; i < count; i++) {
        items[i] = item_of(g, i);
        stats->vertices += g->nodes[i].vertex_count;
        stats->patches_reused += !g->nodes[i].stale;
        stats->triangles_rebuilt += g->nodes[i].stale ? items[i].index_count / 3 : 0;
    }
    stats->patches = count;
    stats->triangles = g->levels.triangles;
    stats->index_bytes = 3 * (int64_t)sizeof(uint16_t) * stats->triangles_rebuilt;
    stats->partitions = 1;
    cut->items = items;
    cut->item_count = count;
    cut->promises = g->rule.bounds;
    return RESULT_OK;
}

static Result build(Geomip *g, const LodCall *call) {
    Update u = {.g = g, .call = call, .stale = arena_new(call->frame, int32_t, g->tiles.squares.count)};
    if (!u.stale)
        return RESULT_MEMORY;
    Result result = renew_stale(&u);
    g->has_before = false; // until all is in place
    if (result != RESULT_OK)
        return result;
    jobs_run(call->jobs, u.stale_count, 4, fill_stale, &u);
    memcpy(g->before, g->levels.drawn, sizeof *g->before * (size_t)g->tiles.squares.count);
    g->has_before = true;
    return RESULT_OK;
}

static Result geomip_update(void *state, const LodCall *call, LodCut *cut) {
    Geomip *g = state;
    int64_t begin = clock_now_ns();
    Result chosen = choose_levels(g, call, cut);
    int64_t selected = clock_now_ns();
    Result result = build(g, call);
    if (result == RESULT_OK)
        result = fill_cut(g, call, cut);
    if (result != RESULT_OK)
        return result;
    if (!g->rule.ye)
        square_page_evict(&g->squares, call->released, g->options.page_bytes_max);
    cut->stats.select_ns = selected - begin;
    cut->stats.refine_ns = clock_now_ns() - selected;
    return chosen;
}

static void geomip_release(void *state, uint64_t frame) {
    Geomip *g = state;
    index_store_release(&g->lists, frame);
    geomip_page_store_release(&g->pages, frame);
}

// ---- life ----

static void geomip_destroy(void *state) {
    Geomip *g = state;
    for (int32_t i = 0; g->nodes && i < g->tiles.squares.count; i++)
        geomip_page_retire(&g->pages, g->nodes[i].page, 0);
    geomip_page_store_destroy(&g->pages);
    square_page_store_destroy(&g->squares);
    index_store_destroy(&g->lists);
    free(g->nodes);
    free(g->before);
    geomip_levels_destroy(&g->levels);
    geomip_tiles_destroy(&g->tiles);
    free(g);
}

static Result allocate(Geomip *g, const Terrain *terrain, Jobs *jobs) {
    int side = square_grid_fitting_side(terrain, g->options.tile_side - 1);
    GeomipInput input = {terrain, side, g->border, g->rule.bounds};
    Result result = geomip_tiles_create(&input, jobs, &g->tiles);
    if (result != RESULT_OK)
        return result;
    int32_t count = g->tiles.squares.count;
    g->nodes = calloc((size_t)count, sizeof *g->nodes);
    g->before = calloc((size_t)count, sizeof *g->before);
    if (!g->nodes || !g->before)
        return RESULT_MEMORY;
    result = geomip_levels_create(count, &g->levels);
    if (result == RESULT_OK && !g->rule.ye)
        result = square_page_store_create(&g->tiles.squares, lod_first_id(&g->options), &g->squares);
    return result;
}

static Result check_options(const LodOptions *options) {
    int side = options->tile_side - 1;
    if (side >= 2 && side <= 128 && !(side & (side - 1)))
        return RESULT_OK;
    log_error("geomipmap: tiles of %d samples a side; give 3, 5, 9, 17, 33, 65 or 129", options->tile_side);
    return RESULT_RANGE;
}

static Result create(const LodOptions *options, const Terrain *terrain, bool ye, void **state) {
    Result result = check_options(options);
    if (result != RESULT_OK)
        return result;
    Geomip *g = calloc(1, sizeof *g);
    Jobs *jobs = NULL;
    if (!g)
        return RESULT_MEMORY;
    g->options = *options;
    g->rule = (GeomipRule){ye, options->bound == LOD_BOUND_CENTRE, options->unit_m};
    g->border = ye ? GEOMIP_FANNED : GEOMIP_OMITTED;
    g->next_revision = g->pages.next_id = lod_first_id(options);
    result = jobs_create(0, &jobs);
    if (result == RESULT_OK)
        result = allocate(g, terrain, jobs);
    jobs_destroy(&jobs);
    if (result != RESULT_OK) {
        geomip_destroy(g);
        return result;
    }
    *state = g;
    return RESULT_OK;
}

static Result create_de_boer(const LodOptions *options, const Terrain *terrain, void **state) {
    return create(options, terrain, false, state);
}

static Result create_ye(const LodOptions *options, const Terrain *terrain, void **state) {
    return create(options, terrain, true, state);
}

const LodOps LOD_GEOMIPMAP_OPS = {
    .create = create_de_boer,
    .destroy = geomip_destroy,
    .update = geomip_update,
    .release = geomip_release,
};

const LodOps LOD_GEOMIPMAP_YE_OPS = {
    .create = create_ye,
    .destroy = geomip_destroy,
    .update = geomip_update,
    .release = geomip_release,
};
