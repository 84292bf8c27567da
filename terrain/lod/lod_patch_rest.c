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

static bool is_rest(const PatchSeam *seam, const PatchChoice *choice) {
    const PatchTriangle *t = &choice->triangle;
    int32_t col = (t->left.col + t->right.col + t->apex.col) / 3, row = (t->left.row + t->right.row + t->apex.row) / 3;
    return seam->tile_sides[square_grid_at(&seam->squares, col, row)] < seam->static_side;
}

static Result take_pages(const PatchSeam *seam, PageStore *store, const PatchSelection *finest, PatchRest *rest) {
    const PatchForest *forest = &seam->terrain->patches;
    size_t bytes = 0;
    rest->pages = calloc((size_t)finest->count, sizeof *rest->pages);
    for (int32_t i = 0; rest->pages && i < finest->count; i++) {
        const PatchChoice *choice = &finest->choices[i];
        if (!is_rest(seam, choice))
            continue;
        RestPage *r = &rest->pages[rest->count++];
        r->triangle = choice->triangle;
        r->page = page_store_take(store, forest, choice->template_index, choice->node);
        if (!r->page)
            return RESULT_MEMORY;
        size_t indices = refine_indices_max(r->page->patch);
        rest->scratch_count = indices > rest->scratch_count ? indices : rest->scratch_count;
        bytes += 2 * refine_active_bytes(r->page->patch);
    }
    rest->activity = calloc(bytes + 1, 1);
    return rest->pages && rest->activity ? RESULT_OK : RESULT_MEMORY;
}

static void share_activity(PatchRest *rest) {
    uint8_t *next = rest->activity;
    for (int32_t i = 0; i < rest->count; i++) {
        size_t bytes = refine_active_bytes(rest->pages[i].page->patch);
        rest->pages[i].decided = next;
        rest->pages[i].drawn = next + bytes;
        next += 2 * bytes;
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

static void decide_task(void *user, int64_t begin, int64_t end, int worker) {
    Pass *pass = user;
    (void)worker;
    for (int64_t i = begin; i < end; i++) {
        RestPage *r = &pass->rest->pages[i];
        if (!r->page->filled)
            page_fill(r->page, pass->seam->terrain, &r->triangle);
        r->evaluated = refine_decide(r->page, &pass->view->view, r->decided).evaluated;
    }
}

// Its corners, which each page shows, and what is active by its error.
static void activate_page(PatchSeam *seam, const RestPage *r, const SeamView *view) {
    const LodPage *shown = &r->page->shown;
    int first = r->page->patch->level_begin[0], end = first + r->evaluated;
    for (int v = 0; v < end; v++)
        if (v < first || (r->decided[v] && seam_view_matters(view, error_field_decode(r->page->delta[v]))))
            seam_activate(seam, shown->col0 + shown->vertices[v].col, shown->row0 + shown->vertices[v].row);
}

void rest_decide(PatchRest *rest, PatchSeam *seam, const SeamView *view, Jobs *jobs) {
    Pass pass = {.rest = rest, .seam = seam, .view = view};
    jobs_run(jobs, rest->count, 16, decide_task, &pass);
    for (int32_t i = 0; i < rest->count; i++)
        activate_page(seam, &rest->pages[i], view);
}

// Triangulating ------------------------------------------------------------------------------------------------

// The seam's activity on the page's vertices goes to `decided`; how many are active. A level without an active vertex
// has none below.
static int32_t read_activity(const PatchSeam *seam, RestPage *r) {
    const PatchTemplate *patch = r->page->patch;
    const LodPage *shown = &r->page->shown;
    int v = patch->level_begin[0];
    int32_t active = 0, before = -1;
    for (int level = 0; level < patch->depth && active != before; level++) {
        before = active;
        for (; v < patch->level_begin[level + 1]; v++) {
            r->decided[v] =
                seam_is_active(seam, shown->col0 + shown->vertices[v].col, shown->row0 + shown->vertices[v].row);
            active += r->decided[v];
        }
    }
    memset(r->decided + v, 0, (size_t)(patch->vertex_count - v));
    return active;
}

static bool triangulate(const Pass *pass, RestPage *r, int part) {
    PatchRest *rest = pass->rest;
    const PatchTemplate *patch = r->page->patch;
    int first = patch->level_begin[0];
    r->vertex_count = first + read_activity(pass->seam, r);
    size_t bytes = (size_t)(patch->vertex_count - first);
    if (!pass->all && r->list.indices && !memcmp(r->decided + first, r->drawn + first, bytes))
        return true;
    memcpy(r->drawn + first, r->decided + first, bytes);
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

Result rest_triangulate(PatchRest *rest, const PatchSeam *seam, const LodCall *call, bool all, uint64_t *revision) {
    Pass pass = {.rest = rest, .seam = seam, .all = all, .parts = jobs_worker_count(call->jobs)};
    Result result = create_scratch(rest, pass.parts);
    if (result != RESULT_OK)
        return result;
    jobs_run(call->jobs, pass.parts, 1, triangulate_task, &pass);
    for (int32_t i = 0; i < rest->count; i++) {
        RestPage *r = &rest->pages[i];
        if (!r->next.indices)
            continue;
        if (result == RESULT_OK)
            result = index_list_retire(&rest->lists, &r->list, call->number - 1);
        if (result != RESULT_OK)
            continue;
        r->list = r->next;
        r->next = (IndexList){0};
        r->revision = ++*revision;
        r->built_frame = call->number;
    }
    for (int p = 0; p < pass.parts; p++)
        if (pass.failed[p])
            result = RESULT_MEMORY;
    return result;
}
