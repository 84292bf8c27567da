// Popping over many cuts: samples that a changed or a vanished item covers are looked at again, in all items of the new
// cut that cover them, so that samples on the border of an unchanged item keep the highest of all. Rises are taken from
// one place of the terrain instead of the eye, so that rounding moves nothing.
#include "base/hash.h"
#include "base/log.h"
#include "base/pages.h"
#include "terrain/lod/cut_copy.h"
#include "terrain/measure/measure_internal.h"

#include <math.h>
#include <stdlib.h>

// What an item draws.
typedef struct Content {
    uint64_t hash;
    int32_t item;
    bool changed; // the other cut has no such item
} Content;

typedef struct Contents {
    Content *of; // [count], ascending by hash
    int32_t count, capacity;
} Contents;

struct MeasureStretch {
    const Terrain *terrain;
    Vec3d from_ecef;
    int64_t samples;
    CutCopy before;
    Contents contents[2]; // before, now
    float *rise_m[2];
    _Atomic uint32_t *rises; // measure_key, where touched
    MeasureTouched touched;
};

typedef struct Adding {
    MeasureStretch *stretch;
    const LodCut *cuts[2];
    LodCut seen; // the cut, from `from_ecef`
    MeasureRun run;
} Adding;

// ---- contents ----

static uint64_t hash_item(const LodItem *item) {
    const LodPage *page = item->page;
    uint64_t hash = (uint64_t)(uint32_t)item->index_count;
    for (int32_t k = 0; k < item->index_count; k++) {
        if (item->indices[k] >= page->vertex_count)
            continue;
        const LodVertex *v = &page->vertices[item->indices[k]];
        hash = hash_mix(hash, (uint64_t)(uint32_t)(page->col0 + v->col) << 32 | (uint32_t)(page->row0 + v->row));
        hash = hash_mix(hash, (uint64_t)(page->origin.x + v->x));
        hash = hash_mix(hash, (uint64_t)(page->origin.y + v->y));
        hash = hash_mix(hash, (uint64_t)(page->origin.z + v->z));
    }
    return hash;
}

static void task_hash(void *user, int64_t begin, int64_t end, int worker) {
    Adding *a = user;
    (void)worker;
    for (int64_t i = begin; i < end; i++)
        a->stretch->contents[1].of[i] = (Content){hash_item(&a->cuts[1]->items[i]), (int32_t)i, true};
}

static int compare_contents(const void *left, const void *right) {
    const Content *a = left, *b = right;
    return (a->hash > b->hash) - (a->hash < b->hash);
}

// One of the other cut for each: of two alike where there was one, one changed.
static void match(Contents *a, Contents *b) {
    for (int32_t i = 0, k = 0; i < a->count && k < b->count;) {
        int order = compare_contents(&a->of[i], &b->of[k]);
        if (order == 0)
            a->of[i].changed = b->of[k].changed = false;
        i += order <= 0;
        k += order >= 0;
    }
}

static Result take_contents(Adding *a, Jobs *jobs) {
    Contents *old = &a->stretch->contents[0], *now = &a->stretch->contents[1];
    if (now->capacity < a->cuts[1]->item_count) {
        free(now->of);
        now->of = malloc(sizeof *now->of * (size_t)a->cuts[1]->item_count);
        now->capacity = now->of ? a->cuts[1]->item_count : 0;
    }
    now->count = now->of ? a->cuts[1]->item_count : 0;
    if (now->count < a->cuts[1]->item_count)
        return RESULT_MEMORY;
    jobs_run(jobs, now->count, 1, task_hash, a);
    if (now->count)
        qsort(now->of, (size_t)now->count, sizeof *now->of, compare_contents);
    for (int32_t i = 0; i < old->count; i++)
        old->of[i].changed = true;
    match(old, now);
    return RESULT_OK;
}

// ---- maps ----

static void task_touch(void *user, int64_t begin, int64_t end, int worker) {
    const Adding *a = user;
    const Contents *old = &a->stretch->contents[0], *now = &a->stretch->contents[1];
    (void)worker;
    for (int64_t i = begin; i < end; i++) {
        const Content *c = i < old->count ? &old->of[i] : &now->of[i - old->count];
        if (c->changed)
            measure_touch(&a->run, &a->cuts[i >= old->count]->items[c->item], &a->stretch->touched);
    }
}

static void task_rasterise(void *user, int64_t begin, int64_t end, int worker) {
    Adding *a = user;
    (void)worker;
    for (int64_t i = begin; i < end; i++)
        measure_rasterise_touched(&a->run, &a->seen.items[i]);
}

static void task_join(void *user, int64_t begin, int64_t end, int worker) {
    const MeasureStretch *s = ((Adding *)user)->stretch;
    int64_t width = terrain_dem(s->terrain)->width;
    (void)worker;
    for (int64_t i = begin * width; i < end * width; i++) {
        s->rise_m[1][i] = s->rise_m[0][i];
        if (!atomic_load_explicit(&s->touched.samples[i], memory_order_relaxed))
            continue;
        uint32_t key = atomic_load_explicit(&s->rises[i], memory_order_relaxed);
        s->rise_m[1][i] = key == MEASURE_NO_KEY ? NAN : measure_value_of_key(key);
        atomic_store_explicit(&s->rises[i], MEASURE_NO_KEY, memory_order_relaxed);
    }
}

static void look_again(Adding *a, Jobs *jobs) {
    MeasureStretch *s = a->stretch;
    memset((void *)s->touched.samples, 0, (size_t)s->samples);
    memset((void *)s->touched.blocks, 0, (size_t)s->touched.block_cols * (size_t)s->touched.block_rows);
    jobs_run(jobs, s->contents[0].count + s->contents[1].count, 4, task_touch, a);
    jobs_run(jobs, a->seen.item_count, 4, task_rasterise, a);
    jobs_run(jobs, terrain_dem(s->terrain)->height, 16, task_join, a);
}

// ---- stretches ----

static Result reserve(MeasureStretch *s) {
    const Dem *dem = terrain_dem(s->terrain);
    s->samples = (int64_t)dem->width * dem->height;
    s->touched.block_cols = (dem->width >> MEASURE_BLOCK_SHIFT) + 1;
    s->touched.block_rows = (dem->height >> MEASURE_BLOCK_SHIFT) + 1;
    s->touched.samples = malloc((size_t)s->samples);
    s->touched.blocks = malloc((size_t)s->touched.block_cols * (size_t)s->touched.block_rows);
    s->rises = calloc((size_t)s->samples, sizeof *s->rises); // MEASURE_NO_KEY
    for (int i = 0; i < 2; i++)
        s->rise_m[i] = malloc((size_t)s->samples * sizeof *s->rise_m[i]);
    if (!s->touched.samples || !s->touched.blocks || !s->rises || !s->rise_m[0] || !s->rise_m[1])
        return RESULT_MEMORY;
    pages_own((void *)s->rises, (size_t)s->samples * sizeof *s->rises);
    for (int64_t i = 0; i < s->samples; i++)
        s->rise_m[0][i] = s->rise_m[1][i] = NAN;
    return RESULT_OK;
}

Result measure_stretch_create(const Terrain *terrain, MeasureStretch **out) {
    const Dem *dem = terrain_dem(terrain);
    *out = calloc(1, sizeof **out);
    if (*out)
        **out = (MeasureStretch){.terrain = terrain,
                                 .from_ecef = grid_ecef(terrain_grid(terrain), dem->width / 2, dem->height / 2, 0.0)};
    if (*out && reserve(*out) == RESULT_OK)
        return RESULT_OK;
    log_error("measure: no memory for %d x %d samples; measure a smaller DEM", dem->width, dem->height);
    measure_stretch_destroy(out);
    return RESULT_MEMORY;
}

void measure_stretch_destroy(MeasureStretch **stretch) {
    MeasureStretch *s = *stretch;
    if (!s)
        return;
    cut_copy_free(&s->before);
    for (int i = 0; i < 2; i++) {
        free(s->contents[i].of);
        free(s->rise_m[i]);
    }
    free((void *)s->rises);
    free((void *)s->touched.samples);
    free((void *)s->touched.blocks);
    free(s);
    *stretch = NULL;
}

static void put_behind(MeasureStretch *s) {
    Contents contents = s->contents[0];
    float *rise_m = s->rise_m[0];
    s->contents[0] = s->contents[1];
    s->contents[1] = contents;
    s->rise_m[0] = s->rise_m[1];
    s->rise_m[1] = rise_m;
}

Result measure_stretch_add(MeasureStretch *stretch, const LodCut *cut, Jobs *jobs, MeasurePopping *out) {
    Adding a = {.stretch = stretch, .cuts = {&stretch->before.cut, cut}, .seen = *cut};
    a.seen.view.eye_ecef = stretch->from_ecef;
    a.run = (MeasureRun){.dem = terrain_dem(stretch->terrain),
                         .grid = terrain_grid(stretch->terrain),
                         .cut = &a.seen,
                         .rises = stretch->rises,
                         .touched = &stretch->touched};
    Result result = take_contents(&a, jobs);
    if (result == RESULT_MEMORY)
        log_error("measure: no memory for the items of a cut");
    if (result != RESULT_OK)
        return result;
    look_again(&a, jobs);
    result = measure_popping_touched(stretch->terrain, &cut->view,
                                     (const float *const[2]){stretch->rise_m[0], stretch->rise_m[1]}, &stretch->touched,
                                     jobs, out);
    put_behind(stretch);
    return result == RESULT_OK ? cut_copy_take(&stretch->before, cut, SIZE_MAX) : result;
}

const float *measure_stretch_rise_m(const MeasureStretch *stretch) {
    return stretch->rise_m[0];
}
