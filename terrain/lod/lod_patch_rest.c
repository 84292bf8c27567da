// Triangulation by vertex, as the hybrid method's (Loeffler, Schwanke, Schumann 2010, section 4.2), of vertices that
// are active by their error or because a static patch beside shows them.
#include "terrain/lod/lod_patch_rest.h"

#include "terrain/terrain_parts.h"

#include <stdlib.h>
#include <string.h>

typedef struct Pass {
    PatchRest *rest;
    const PatchSeam *seam;
    const SeamView *view;
    const LodCall *call;
    bool all;
    int parts;
    bool failed[LOD_PARTITIONS_MAX];
} Pass;

// Making and ending --------------------------------------------------------------------------------------------

static bool never(void *user, const PatchTile *tile, PatchCorner middle) {
    const PatchSeam *seam = user;
    (void)middle;
    return !seam_is_static(seam, &tile->tile);
}

static int32_t square_of(const PatchSeam *seam, const PatchTriangle *t) {
    int32_t col = (t->left.col + t->right.col + t->apex.col) / 3, row = (t->left.row + t->right.row + t->apex.row) / 3;
    return square_grid_at(&seam->squares, col, row);
}

static Result take_pages(const PatchSeam *seam, PageStore *store, const PatchSelection *finest, PatchRest *rest) {
    const PatchForest *forest = &seam->terrain->patches;
    size_t bytes = 0;
    rest->pages = calloc((size_t)finest->count, sizeof *rest->pages);
    for (int32_t i = 0; rest->pages && i < finest->count; i++) {
        const PatchChoice *choice = &finest->choices[i];
        int32_t square = square_of(seam, &choice->triangle);
        if (seam->tile_sides[square] >= seam->static_side)
            continue;
        RestPage *r = &rest->pages[rest->count++];
        r->triangle = choice->triangle;
        r->square = square;
        r->page = page_store_take(store, forest, choice->template_index, choice->node);
        if (!r->page)
            return RESULT_MEMORY;
        size_t indices = refine_indices_max(r->page->patch);
        rest->scratch_count = indices > rest->scratch_count ? indices : rest->scratch_count;
        bytes += 3 * refine_active_bytes(r->page->patch);
    }
    rest->activity = calloc(bytes + 1, 1);
    return rest->pages && rest->activity ? RESULT_OK : RESULT_MEMORY;
}

static void share_activity(PatchRest *rest) {
    uint8_t *next = rest->activity;
    for (int32_t i = 0; i < rest->count; i++) {
        size_t bytes = refine_active_bytes(rest->pages[i].page->patch);
        rest->pages[i].decided = next;
        rest->pages[i].active = next + bytes;
        rest->pages[i].drawn = next + 2 * bytes;
        next += 3 * bytes;
    }
}

Result rest_create(const PatchSeam *seam, PageStore *pages, PatchRest *out) {
    PatchRest rest = {0};
    PatchSelection finest = {0};
    PatchSeam *user = (PatchSeam *)(uintptr_t)seam; // only read
    Result result = patch_select_where(&seam->terrain->patches, never, user, INT32_MAX, &finest);
    if (result == RESULT_OK)
        result = take_pages(seam, pages, &finest, &rest);
    patch_selection_destroy(&finest);
    if (result != RESULT_OK) {
        rest_destroy(&rest);
        return result;
    }
    share_activity(&rest);
    *out = rest;
    return RESULT_OK;
}

void rest_destroy(PatchRest *rest) {
    for (int p = 0; p < LOD_PARTITIONS_MAX; p++)
        free(rest->scratch[p]);
    free(rest->pages);
    free(rest->activity);
    index_store_destroy(&rest->lists);
    *rest = (PatchRest){0};
}

// Deciding -----------------------------------------------------------------------------------------------------

static bool is_valid(const RestPage *r, const Pass *pass) {
    const SeamView *view = pass->view;
    return !pass->all && r->page->filled && r->built_nu == view->view.nu && r->built_nearest_m == view->nearest_m &&
           vec3d_distance(pass->call->view->eye_ecef, r->built_eye) < r->validity_m;
}

static void decide(const Pass *pass, RestPage *r) {
    if (!r->page->filled)
        page_fill(r->page, pass->seam->terrain, &r->triangle);
    RefineResult result = refine_decide(r->page, &pass->view->view, r->decided);
    int first = r->page->patch->level_begin[0];
    for (int v = first; pass->view->nearest_m > 0.0 && v < first + result.evaluated; v++)
        r->decided[v] &= seam_view_matters(pass->view, error_field_decode(r->page->delta[v]));
    r->built_eye = pass->call->view->eye_ecef;
    r->built_nu = pass->view->view.nu;
    r->built_nearest_m = pass->view->nearest_m;
    r->validity_m = result.validity_m;
    r->evaluated = result.evaluated;
}

static void decide_task(void *user, int64_t begin, int64_t end, int worker) {
    Pass *pass = user;
    (void)worker;
    for (int64_t i = begin; i < end; i++) {
        RestPage *r = &pass->rest->pages[i];
        r->stale = !is_valid(r, pass);
        if (r->stale)
            decide(pass, r);
        r->changed = r->changed || r->stale;
    }
}

static void tell_errors(PatchSeam *seam, const RestPage *r) {
    const LodPage *shown = &r->page->shown;
    for (int v = r->page->patch->level_begin[0]; v < shown->vertex_count; v++)
        seam_set_by_error(seam, shown->col0 + shown->vertices[v].col, shown->row0 + shown->vertices[v].row,
                          r->decided[v]);
}

void rest_decide(PatchRest *rest, PatchSeam *seam, const SeamView *view, const LodCall *call, bool all) {
    Pass pass = {.rest = rest, .seam = seam, .view = view, .call = call, .all = all};
    jobs_run(call->jobs, rest->count, 16, decide_task, &pass);
    for (int32_t i = 0; i < rest->count; i++)
        if (rest->pages[i].stale)
            tell_errors(seam, &rest->pages[i]);
    for (int32_t i = 0; i < rest->count; i++) { // a page's corners are always drawn
        const LodPage *shown = &rest->pages[i].page->shown;
        for (int v = 0; v < rest->pages[i].page->patch->level_begin[0]; v++)
            seam_activate(seam, shown->col0 + shown->vertices[v].col, shown->row0 + shown->vertices[v].row);
    }
}

// Triangulating ------------------------------------------------------------------------------------------------

// The seam's activity on the page's vertices goes to `active`; how many are active. A level without an active vertex
// has none below.
static int32_t read_activity(const PatchSeam *seam, RestPage *r) {
    const PatchTemplate *patch = r->page->patch;
    const LodPage *shown = &r->page->shown;
    int v = patch->level_begin[0];
    int32_t active = 0, before = -1;
    for (int level = 0; level < patch->depth && active != before; level++) {
        before = active;
        for (; v < patch->level_begin[level + 1]; v++) {
            r->active[v] =
                seam_is_active(seam, shown->col0 + shown->vertices[v].col, shown->row0 + shown->vertices[v].row);
            active += r->active[v];
        }
    }
    memset(r->active + v, 0, (size_t)(patch->vertex_count - v));
    return active;
}

static bool triangulate(const Pass *pass, RestPage *r, int part) {
    PatchRest *rest = pass->rest;
    const PatchTemplate *patch = r->page->patch;
    if (!pass->all && r->list.indices && !r->changed && !seam_is_touched(pass->seam, r->square))
        return true;
    r->changed = false;
    int first = patch->level_begin[0];
    r->vertex_count = first + read_activity(pass->seam, r);
    size_t bytes = (size_t)(patch->vertex_count - first);
    if (!pass->all && r->list.indices && !memcmp(r->active + first, r->drawn + first, bytes))
        return true;
    memcpy(r->drawn + first, r->active + first, bytes);
    int32_t count = refine_emit(patch, r->drawn, rest->scratch[part]);
    if (!index_list_take(&rest->lists, part, count, &r->next))
        return false;
    memcpy(r->next.indices, rest->scratch[part], sizeof(uint16_t) * (size_t)count);
    return true;
}

static void triangulate_task(void *user, int64_t begin, int64_t end, int worker) {
    Pass *pass = user;
    (void)worker;
    for (int part = (int)begin; part < (int)end; part++) {
        int64_t first = (int64_t)pass->rest->count * part / pass->parts;
        int64_t last = (int64_t)pass->rest->count * (part + 1) / pass->parts;
        for (int64_t i = first; i < last && !pass->failed[part]; i++)
            pass->failed[part] = !triangulate(pass, &pass->rest->pages[i], part);
    }
}

static Result create_scratch(PatchRest *rest, int parts) {
    for (int p = 0; p < parts; p++) {
        if (!rest->scratch[p])
            rest->scratch[p] = malloc(rest->scratch_count * sizeof *rest->scratch[p]);
        if (!rest->scratch[p])
            return RESULT_MEMORY;
    }
    return RESULT_OK;
}

static Result adopt(PatchRest *rest, const LodCall *call, uint64_t *revision) {
    for (int32_t i = 0; i < rest->count; i++) {
        RestPage *r = &rest->pages[i];
        if (!r->next.indices)
            continue;
        Result result = index_list_retire(&rest->lists, &r->list, call->number - 1);
        if (result != RESULT_OK)
            return result;
        r->list = r->next;
        r->next = (IndexList){0};
        r->revision = ++*revision;
        r->built_frame = call->number;
    }
    return RESULT_OK;
}

static Result make_lists(Pass *pass, PatchSeam *seam, uint64_t *revision) {
    Result result = create_scratch(pass->rest, pass->parts);
    if (result != RESULT_OK)
        return result;
    jobs_run(pass->call->jobs, pass->parts, 1, triangulate_task, pass);
    seam_settle(seam);
    for (int p = 0; p < pass->parts; p++)
        if (pass->failed[p])
            return RESULT_MEMORY;
    return adopt(pass->rest, pass->call, revision);
}

Result rest_triangulate(PatchRest *rest, PatchSeam *seam, const LodCall *call, bool all, uint64_t *revision) {
    Pass pass = {
        .rest = rest, .seam = seam, .call = call, .all = all || rest->failed, .parts = jobs_worker_count(call->jobs)};
    Result result = make_lists(&pass, seam, revision);
    rest->failed = result != RESULT_OK;
    for (int32_t i = 0; rest->failed && i < rest->count; i++) // nobody read them
        index_list_give_back(&rest->lists, &rest->pages[i].next);
    return result;
}
