// Yalcin, Weiss, De Floriani 2011, section 7: the transitive closure of the dependency, bottom-up, a barrier per
// level. Our own: parents gather from their children instead of children setting parents, so no operation is atomic,
// and a row of super-squares is a loop over words.
#include "terrain/diamond/diamond_internal.h"
#include "terrain/diamond/diamond_rules.h"

#include <string.h>

#define CHUNK_ROWS 16 // of super-squares

typedef struct Closing {
    const DiamondModel *model;
    uint32_t *bits;
    int plane;
} Closing;

static uint32_t *row_of(const Closing *c, int plane, int64_t j) {
    const DiamondLayout *layout = &c->model->layout;
    return c->bits + layout->offset[plane] + (uint32_t)j * layout->across[plane];
}

// ---- edge midpoints to the centres beside them ----

SIMD_CLONES
static void close_inner(uint32_t *restrict own, const uint32_t *restrict south, const uint32_t *restrict valid,
                        int count) {
    // Only centres are written and only edge midpoints are read: the order of words does not matter.
    for (int i = 0; i < count; i++)
        own[i] |= diamond_close_centres(own[i], own[i + 1], south[i]) & valid[i];
}

static void close_row(const Closing *c, int64_t j) {
    const DiamondLayout *layout = &c->model->layout;
    uint32_t *own = row_of(c, c->plane, j);
    const uint32_t *valid = c->model->valid + (own - c->bits);
    int last = (int)layout->across[c->plane] - 1;
    if (j + 1 < layout->down[c->plane]) {
        const uint32_t *south = own + layout->across[c->plane];
        close_inner(own, south, valid, last);
        own[last] |= diamond_close_centres(own[last], 0, south[last]) & valid[last];
    } else {
        for (int i = 0; i <= last; i++)
            own[i] |= diamond_close_centres(own[i], i < last ? own[i + 1] : 0, 0) & valid[i];
    }
}

// All but the last row of each chunk, which reads the next chunk.
static void centres_task(void *user, int64_t begin, int64_t end, int worker) {
    const Closing *c = user;
    int64_t down = c->model->layout.down[c->plane];
    (void)worker;
    int64_t last = end * CHUNK_ROWS < down ? end * CHUNK_ROWS : down;
    for (int64_t j = begin * CHUNK_ROWS; j < last; j++)
        if (j % CHUNK_ROWS != CHUNK_ROWS - 1 || j == down - 1)
            close_row(c, j);
}

static void close_centres(const Closing *c, Jobs *jobs) {
    int64_t down = c->model->layout.down[c->plane];
    jobs_run(jobs, (down + CHUNK_ROWS - 1) / CHUNK_ROWS, 1, centres_task, (void *)(uintptr_t)c);
    for (int64_t j = CHUNK_ROWS - 1; j < down - 1; j += CHUNK_ROWS)
        close_row(c, j);
}

// ---- centres to the edge midpoints of the next plane ----

typedef struct Quarter {         // of a super-square: the finer ones that it asks
    const uint32_t *own, *north; // rows of the finer plane; NULL: none
    int half_y;
} Quarter;

static uint32_t edges_of(const Quarter *q, uint32_t fine_i, uint32_t fine_across, int half_x) {
    if (!q->own || fine_i >= fine_across)
        return 0;
    uint32_t west = fine_i > 0 ? q->own[fine_i - 1] : 0, north = q->north ? q->north[fine_i] : 0;
    return diamond_close_edges(q->own[fine_i], west, north, half_x, q->half_y);
}

static Quarter quarter_of(const Closing *c, int64_t j, int half_y) {
    int64_t fine_j = 2 * j + half_y;
    bool there = fine_j < c->model->layout.down[c->plane - 1];
    return (Quarter){.own = there ? row_of(c, c->plane - 1, fine_j) : NULL,
                     .north = there && fine_j > 0 ? row_of(c, c->plane - 1, fine_j - 1) : NULL,
                     .half_y = half_y};
}

static void edges_task(void *user, int64_t begin, int64_t end, int worker) {
    const Closing *c = user;
    const DiamondLayout *layout = &c->model->layout;
    uint32_t fine_across = layout->across[c->plane - 1];
    (void)worker;
    for (int64_t j = begin; j < end; j++) {
        uint32_t *own = row_of(c, c->plane, j);
        const uint32_t *valid = c->model->valid + (own - c->bits);
        Quarter upper = quarter_of(c, j, 0), lower = quarter_of(c, j, 1);
        for (uint32_t i = 0; i < layout->across[c->plane]; i++) {
            uint32_t edges = edges_of(&upper, 2 * i, fine_across, 0) | edges_of(&upper, 2 * i + 1, fine_across, 1) |
                             edges_of(&lower, 2 * i, fine_across, 0) | edges_of(&lower, 2 * i + 1, fine_across, 1);
            own[i] |= edges & valid[i];
        }
    }
}

// ---- all planes ----

void diamond_close(const DiamondModel *model, Jobs *jobs, uint32_t *bits) {
    Closing c = {.model = model, .bits = bits};
    for (c.plane = 0; c.plane < model->layout.level_count; c.plane++) {
        if (c.plane > 0)
            diamond_run_rows(jobs, &model->layout, c.plane, edges_task, &c);
        close_centres(&c, jobs);
    }
}

void diamond_fill(const DiamondModel *model, uint32_t *bits) {
    memcpy(bits, model->valid, sizeof *bits * model->layout.word_count);
}

SIMD_CLONES
static uint32_t count_words(const uint32_t *restrict bits, uint32_t count) {
    uint32_t sum = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += diamond_popcount(bits[i]);
    return sum;
}

int64_t diamond_count(const DiamondModel *model, const uint32_t *bits) {
    return count_words(bits, model->layout.word_count);
}
