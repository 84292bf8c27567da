// Our own: bounds of runs of super-squares. Yalcin, Weiss, De Floriani 2011, section 6, ask every diamond, which on a
// processor is a question of memory: what lies far off beside its largest error need not be read.
#include "terrain/diamond/diamond_internal.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#define SPHERE_GROW 1.00001f // rounding of a middle, a distance and its root

typedef struct Box {
    float low[3], high[3];
} Box;

static bool is_asked(const DiamondModel *model, uint32_t word, int slot) {
    return (model->valid[word] & ~model->always[word]) >> diamond_slot_bit(slot) & 1;
}

typedef struct Gathering {
    const DiamondModel *model;
    DiamondSpan span;
    Box box;
    DiamondRun run;
} Gathering;

typedef void EntryTask(Gathering *g, uint32_t word, int slot, size_t entry);

static void for_each_entry(Gathering *g, EntryTask *task) {
    for (int slot = 0; slot < DIAMOND_SLOTS; slot++)
        for (uint32_t word = g->span.begin; word < g->span.begin + (uint32_t)g->span.count; word++)
            if (is_asked(g->model, word, slot))
                task(g, word, slot, diamond_entry(&g->model->layout, slot, word));
}

static void widen_box(Gathering *g, uint32_t word, int slot, size_t entry) {
    const float p[3] = {g->model->x[entry], g->model->y[entry], g->model->z[entry]};
    (void)word, (void)slot;
    for (int i = 0; i < 3; i++) {
        g->box.low[i] = p[i] < g->box.low[i] ? p[i] : g->box.low[i];
        g->box.high[i] = p[i] > g->box.high[i] ? p[i] : g->box.high[i];
    }
}

static void widen_sphere(Gathering *g, uint32_t word, int slot, size_t entry) {
    const DiamondModel *model = g->model;
    DiamondRun *run = &g->run;
    float x = model->x[entry] - run->x, y = model->y[entry] - run->y, z = model->z[entry] - run->z;
    float reach = model->reach_m[(diamond_is_centre(slot) ? 0 : model->layout.word_count) + word];
    float radius = sqrtf(x * x + y * y + z * z) * SPHERE_GROW + reach;
    run->radius_m = radius > run->radius_m ? radius : run->radius_m;
    run->error_m = model->error_m[entry] > run->error_m ? model->error_m[entry] : run->error_m;
}

static DiamondRun run_of(const DiamondModel *model, uint32_t number) {
    Gathering g = {.model = model,
                   .span = diamond_run_span(model, number),
                   .box = {{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}},
                   .run = {.error_m = -1.0f}};
    for_each_entry(&g, widen_box);
    if (g.box.low[0] > g.box.high[0])
        return g.run;
    g.run.x = 0.5f * (g.box.low[0] + g.box.high[0]);
    g.run.y = 0.5f * (g.box.low[1] + g.box.high[1]);
    g.run.z = 0.5f * (g.box.low[2] + g.box.high[2]);
    for_each_entry(&g, widen_sphere);
    return g.run;
}

static void run_task(void *user, int64_t begin, int64_t end, int worker) {
    DiamondModel *model = user;
    (void)worker;
    for (int64_t i = begin; i < end; i++)
        model->runs[i] = run_of(model, (uint32_t)i);
}

Result diamond_runs_create(DiamondModel *model, Jobs *jobs) {
    if (!model->runs)
        model->runs = malloc(sizeof *model->runs * diamond_run_count(model));
    if (!model->runs)
        return RESULT_MEMORY;
    jobs_run(jobs, diamond_run_count(model), 16, run_task, model);
    return RESULT_OK;
}
