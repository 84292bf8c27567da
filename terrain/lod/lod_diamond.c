// terrain/lod/lod_diamond.c: the method of Yalcin, Weiss, De Floriani 2011: errors generated once (section 5), then in
// every frame a predicate asked of every diamond (6), closed under the dependency (7), and turned into triangles (8).
// On the processor here; or, as an order, left to the renderer's compute shaders.
//
// Differences from the paper: the hierarchy is a forest's, of any size; triangles are handed out as 16-bit lists, a
// square of the terrain each, and a square whose split bits did not change keeps its list; above the budget the
// tolerance is raised.
#include "terrain/diamond/diamond.h"
#include "terrain/diamond/diamond_squares.h"
#include "terrain/lod/budget.h"
#include "terrain/lod/lod_method.h"
#include "terrain/patches/index_list.h"
#include "terrain/squares/square_page.h"
#include "terrain/terrain_parts.h"

#include "base/clock.h"
#include "base/log.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

typedef struct Square { // what is kept of a square between frames
    SquarePage *page;
    IndexList list;
    uint64_t revision;
} Square;

typedef struct Diamonds {
    LodOptions options;
    const Terrain *terrain;
    DiamondModel model;
    DiamondProgram program;
    int64_t vertices; // that are asked about in a frame
    SquareGrid grid;
    DiamondSquares squares;
    SquarePageStore pages;
    Square *kept;            // [grid.count]
    uint32_t *bits, *before; // [word_count]: of this frame, of the one before
    bool has_before;
    IndexStore lists; // a pool a worker
    uint64_t next_revision;
    Budget budget;
} Diamonds;

static void diamonds_release(void *state, uint64_t frame) {
    Diamonds *d = state;
    index_store_release(&d->lists, frame);
}

// ---- the model ----

static Result create_squares(Diamonds *d) {
    Result result =
        square_grid_create(&d->terrain->forest, square_grid_fitting_side(d->terrain, DIAMOND_SQUARE_SIDE), &d->grid);
    if (result != RESULT_OK)
        return result;
    result = diamond_squares_create(&d->model.layout, &d->grid, &d->squares);
    if (result != RESULT_OK)
        return result;
    result = square_page_store_create(&d->grid, lod_first_id(&d->options), &d->pages);
    if (result != RESULT_OK)
        return result;
    d->kept = calloc((size_t)d->grid.count, sizeof *d->kept);
    d->bits = malloc(sizeof *d->bits * d->model.layout.word_count);
    d->before = malloc(sizeof *d->before * d->model.layout.word_count);
    return d->kept && d->bits && d->before ? RESULT_OK : RESULT_MEMORY;
}

static void destroy_parts(Diamonds *d) {
    square_page_store_destroy(&d->pages);
    diamond_squares_destroy(&d->squares);
    square_grid_destroy(&d->grid);
    diamond_model_destroy(&d->model);
    free(d->kept);
    free(d->bits);
    free(d->before);
}

static Result make_model(Diamonds *d, Jobs *jobs) {
    unsigned fields = d->options.select ? diamond_select_fields(d->options.select) : 0;
    Result result = diamond_model_create(d->terrain, fields, lod_first_id(&d->options) + 1, jobs, &d->model);
    if (result == RESULT_OK && !d->options.resident)
        result = diamond_generate_errors(&d->model, jobs, NULL);
    if (result == RESULT_OK && !d->options.resident)
        result = create_squares(d);
    if (result != RESULT_OK)
        return result;
    diamond_select_bind(d->options.select, &d->model, &d->program);
    d->vertices = diamond_count(&d->model, d->model.valid);
    return RESULT_OK;
}

// ---- split bits ----

typedef struct Update { // of one frame
    Diamonds *d;
    const LodCall *call;
    DiamondSurvey *surveys; // [grid.count]
    bool *stale;            // [grid.count]
    bool *failed;           // [workers]
} Update;

static void survey_task(void *user, int64_t begin, int64_t end, int worker) {
    const Update *u = user;
    const Diamonds *d = u->d;
    (void)worker;
    for (int64_t i = begin; i < end; i++)
        u->surveys[i] = diamond_squares_survey(&d->squares, (int32_t)i, d->bits, d->has_before ? d->before : NULL);
}

static const DiamondLens *lens_of(const Diamonds *d) {
    return d->options.select ? diamond_select_lens(d->options.select) : NULL;
}

static void split_at(Update *u, double tau_px, LodStats *stats) {
    Diamonds *d = u->d;
    int64_t begin = clock_now_ns();
    DiamondView view = diamond_view(&d->model, u->call->view, tau_px, lens_of(d));
    diamond_evaluate(&d->model, &d->program, &view, u->call->jobs, d->bits);
    stats->chosen = diamond_count(&d->model, d->bits);
    diamond_close(&d->model, u->call->jobs, d->bits);
    stats->closed = diamond_count(&d->model, d->bits);
    int64_t closed = clock_now_ns();
    jobs_run(u->call->jobs, d->grid.count, 16, survey_task, u);
    stats->select_ns += closed - begin;
    stats->refine_ns += clock_now_ns() - closed;
    stats->vertices_evaluated = d->vertices;
    stats->patches = d->grid.count;
    stats->triangles = stats->vertices = 0;
    for (int32_t i = 0; i < d->grid.count; i++) {
        stats->triangles += u->surveys[i].triangles;
        stats->vertices += u->surveys[i].vertices;
    }
}

// A selection is what somebody asked for: nothing in it is raised.
static Result split_selection(Update *u, LodCut *cut) {
    const Diamonds *d = u->d;
    split_at(u, u->call->view->tau_px, &cut->stats);
    if (cut->stats.triangles <= d->options.max_triangles)
        return RESULT_OK;
    log_error("the selection '%s' takes %" PRId64 " triangles, more than the %" PRId64
              " allowed: select less, or raise --max-triangles",
              diamond_select_text(d->options.select), cut->stats.triangles, d->options.max_triangles);
    return RESULT_RANGE;
}

static Result refine_at(void *user, double tau_px, LodStats *stats) {
    split_at(user, tau_px, stats);
    return RESULT_OK;
}

// ---- triangles ----

static Result take_pages(Update *u) {
    Diamonds *d = u->d;
    for (int32_t i = 0; i < d->grid.count; i++) {
        SquarePage *page = square_page_take(&d->pages, i, u->surveys[i].stride, u->call->number);
        if (!page)
            return RESULT_MEMORY;
        u->stale[i] = !d->options.reuse || u->surveys[i].changed || d->kept[i].page != page;
        d->kept[i].page = page;
    }
    return RESULT_OK;
}

static Result retire_stale(Update *u) {
    Diamonds *d = u->d;
    Result result = RESULT_OK;
    for (int32_t i = 0; i < d->grid.count && result == RESULT_OK; i++)
        if (u->stale[i])
            result = index_list_retire(&d->lists, &d->kept[i].list, u->call->number - 1);
    return result;
}

static void emit_task(void *user, int64_t begin, int64_t end, int worker) {
    Update *u = user;
    Diamonds *d = u->d;
    for (int32_t i = (int32_t)begin; i < (int32_t)end && !u->failed[worker]; i++) {
        Square *kept = &d->kept[i];
        if (!u->stale[i])
            continue;
        if (!kept->page->filled)
            square_page_fill(kept->page, &d->grid, d->terrain);
        int32_t count = 3 * u->surveys[i].triangles;
        u->failed[worker] = !index_list_take(&d->lists, worker, count + 1, &kept->list);
        if (u->failed[worker])
            continue;
        kept->list.index_count = count;
        diamond_squares_emit(&d->squares, i, u->surveys[i].stride, d->bits, kept->list.indices);
    }
}

static LodItem item_of(Update *u, int32_t i, LodStats *stats) {
    Diamonds *d = u->d;
    Square *kept = &d->kept[i];
    if (u->stale[i]) {
        kept->revision = ++d->next_revision;
        stats->triangles_rebuilt += kept->list.index_count / 3;
        stats->index_bytes += (int64_t)sizeof(uint16_t) * kept->list.index_count;
    }
    stats->patches_reused += !u->stale[i];
    return (LodItem){
        .page = &kept->page->shown,
        .revision = kept->revision,
        .indices = kept->list.indices,
        .index_count = kept->list.index_count,
        .level = (uint8_t)__builtin_ctz((unsigned)(d->grid.squares[i].side / kept->page->stride)),
        .state = u->stale[i] ? LOD_ITEM_REBUILT : LOD_ITEM_REUSED,
        .centre_ecef = kept->page->centre_ecef,
        .radius_m = kept->page->radius_m,
    };
}

static Result make_triangles(Update *u, LodCut *cut) {
    Diamonds *d = u->d;
    LodItem *items = arena_new(u->call->frame, LodItem, d->grid.count);
    Result result = items ? take_pages(u) : RESULT_MEMORY;
    if (result == RESULT_OK)
        result = retire_stale(u);
    if (result != RESULT_OK)
        return result;
    jobs_run(u->call->jobs, d->grid.count, 4, emit_task, u);
    for (int worker = 0; worker < jobs_worker_count(u->call->jobs); worker++)
        if (u->failed[worker])
            return RESULT_MEMORY;
    for (int32_t i = 0; i < d->grid.count; i++)
        items[i] = item_of(u, i, &cut->stats);
    cut->items = items;
    cut->item_count = d->grid.count;
    return RESULT_OK;
}

// ---- the cut ----

static bool keeps_tau(const Diamonds *d) {
    return !d->options.select || diamond_select_promises(d->options.select);
}

static Result give_order(Diamonds *d, const LodCall *call, LodCut *cut) {
    DiamondOrder *order = arena_new(call->frame, DiamondOrder, 1);
    if (!order)
        return RESULT_MEMORY;
    *order = (DiamondOrder){.model = &d->model,
                            .program = &d->program,
                            .view = diamond_view(&d->model, call->view, call->view->tau_px, lens_of(d)),
                            .max_triangles = d->options.max_triangles,
                            .may_raise = !d->options.select};
    cut->resident = order;
    cut->promises = keeps_tau(d);
    cut->stats.vertices_evaluated = d->vertices;
    return RESULT_OK;
}

static bool allocate_update(Update *u) {
    u->surveys = arena_new(u->call->frame, DiamondSurvey, u->d->grid.count);
    u->stale = arena_new(u->call->frame, bool, u->d->grid.count);
    int workers = jobs_worker_count(u->call->jobs);
    u->failed = arena_new(u->call->frame, bool, workers);
    for (int i = 0; u->failed && i < workers; i++)
        u->failed[i] = false;
    return u->surveys && u->stale && u->failed;
}

// Memory that ran out leaves lists behind that are no frame's: nothing is taken as kept in the next one.
static Result refine(Update *u, LodCut *cut) {
    Diamonds *d = u->d;
    Result split = d->options.select ? split_selection(u, cut) : budget_refine(&d->budget, refine_at, u, cut);
    if (split != RESULT_OK && split != RESULT_BUDGET)
        return split;
    int64_t begin = clock_now_ns();
    Result made = make_triangles(u, cut);
    d->has_before = made == RESULT_OK;
    cut->stats.refine_ns += clock_now_ns() - begin;
    cut->stats.partitions = 1;
    uint32_t *bits = d->bits;
    d->bits = d->before;
    d->before = bits;
    return made == RESULT_OK ? split : made;
}

static Result diamonds_update(void *state, const LodCall *call, LodCut *cut) {
    Diamonds *d = state;
    if (d->options.resident)
        return give_order(d, call, cut);
    Update u = {.d = d, .call = call};
    if (!allocate_update(&u))
        return RESULT_MEMORY;
    Result result = refine(&u, cut);
    cut->promises = keeps_tau(d);
    square_page_evict(&d->pages, call->released, d->options.page_bytes_max);
    return result;
}

static void diamonds_destroy(void *state) {
    Diamonds *d = state;
    index_store_destroy(&d->lists);
    destroy_parts(d);
    free(d);
}

// With workers of its own, as those of the frames may be at work.
static Result diamonds_create(const LodOptions *options, const Terrain *terrain, void **state) {
    Diamonds *d = calloc(1, sizeof *d);
    Jobs *jobs = NULL;
    if (!d)
        return RESULT_MEMORY;
    d->options = *options;
    d->budget.max_triangles = options->max_triangles;
    d->terrain = terrain;
    d->next_revision = lod_first_id(options);
    Result result = jobs_create(0, &jobs);
    if (result == RESULT_OK)
        result = make_model(d, jobs);
    jobs_destroy(&jobs);
    if (result != RESULT_OK) {
        diamonds_destroy(d);
        return result;
    }
    *state = d;
    return RESULT_OK;
}

const LodOps LOD_DIAMOND_OPS = {
    .create = diamonds_create,
    .destroy = diamonds_destroy,
    .update = diamonds_update,
    .release = diamonds_release,
};
