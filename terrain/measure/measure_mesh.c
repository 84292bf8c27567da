#include "terrain/measure/measure_internal.h"

#include <stdlib.h>
#include <string.h>

bool measure_triangle(const MeasureRun *run, const LodItem *item, int64_t triangle, MeasureTriangle *out) {
    const LodPage *page = item->page;
    for (int i = 0; i < 3; i++) {
        uint16_t index = item->indices[3 * triangle + i];
        if (index >= page->vertex_count)
            return false;
        out->vertex[i] = index;
        out->col[i] = page->col0 + page->vertices[index].col;
        out->row[i] = page->row0 + page->vertices[index].row;
        if (out->col[i] < 0 || out->row[i] < 0 || out->col[i] >= run->dem->width || out->row[i] >= run->dem->height)
            return false;
    }
    // Rows run south, so counter-clockwise from above is clockwise in columns and rows.
    out->area2 = (out->col[2] - out->col[0]) * (out->row[1] - out->row[0]) -
                 (out->col[1] - out->col[0]) * (out->row[2] - out->row[0]);
    return out->area2 > 0;
}

GridPoint measure_drawn(const LodPage *page, uint16_t vertex) {
    const LodVertex *v = &page->vertices[vertex];
    return (GridPoint){page->origin.x + v->x, page->origin.y + v->y, page->origin.z + v->z};
}

// ---- edges of one item ----

static MeasureEdge edge_between(const MeasureTriangle *t, int i, int j) {
    bool forward = t->row[i] < t->row[j] || (t->row[i] == t->row[j] && t->col[i] < t->col[j]);
    int from = forward ? i : j, to = forward ? j : i;
    return (MeasureEdge){.col = (int32_t)t->col[from],
                         .row = (int32_t)t->row[from],
                         .dcol = (int32_t)(t->col[to] - t->col[from]),
                         .drow = (int32_t)(t->row[to] - t->row[from]),
                         .forward = forward,
                         .backward = !forward};
}

static bool edge_same(const MeasureEdge *a, const MeasureEdge *b) {
    return a->col == b->col && a->row == b->row && a->dcol == b->dcol && a->drow == b->drow;
}

static uint64_t edge_hash(const MeasureEdge *e) {
    uint64_t h = ((uint64_t)(uint32_t)e->row << 32 | (uint32_t)e->col) * UINT64_C(0x9e3779b97f4a7c15);
    h ^= ((uint64_t)(uint32_t)e->drow << 32 | (uint32_t)e->dcol) * UINT64_C(0xc2b2ae3d27d4eb4f);
    return (h ^ (h >> 29)) * UINT64_C(0x165667b19e3779f9) >> 24;
}

static void table_add(MeasureEdge *table, uint64_t mask, MeasureEdge edge) {
    uint64_t at = edge_hash(&edge) & mask;
    while ((table[at].forward || table[at].backward) && !edge_same(&table[at], &edge))
        at = (at + 1) & mask;
    edge.forward += table[at].forward;
    edge.backward += table[at].backward;
    table[at] = edge;
}

static bool edge_on_border(const Dem *dem, const MeasureEdge *e) {
    return (e->dcol == 0 && (e->col == 0 || e->col == dem->width - 1)) ||
           (e->drow == 0 && (e->row == 0 || e->row == dem->height - 1));
}

static bool edge_is_whole(const Dem *dem, const MeasureEdge *e) {
    if (edge_on_border(dem, e))
        return e->forward + e->backward == 1;
    return e->forward == 1 && e->backward == 1;
}

static void keep_open(MeasureWorker *worker, const MeasureEdge *edge) {
    if (worker->open_count == worker->open_capacity) {
        int64_t capacity = worker->open_capacity ? 2 * worker->open_capacity : 4096;
        MeasureEdge *grown = realloc(worker->open, sizeof *grown * (size_t)capacity);
        if (!grown) {
            worker->out_of_memory = true;
            return;
        }
        worker->open = grown;
        worker->open_capacity = capacity;
    }
    worker->open[worker->open_count++] = *edge;
}

static void mark_used(MeasureRun *run, MeasureWorker *worker, const LodItem *item, uint64_t mask) {
    MeasureTriangle t;
    for (int64_t i = 0; i < item->index_count / 3; i++) {
        if (!measure_triangle(run, item, i, &t))
            continue;
        for (int k = 0; k < 3; k++) {
            worker->used[t.vertex[k]] = 1;
            table_add(worker->table, mask, edge_between(&t, k, (k + 1) % 3));
        }
    }
}

// ---- vertices ----

static GridPoint drawn_by_ordinal(const MeasureRun *run, uint32_t ordinal) {
    int64_t low = 0, high = run->cut->item_count; // the last item that begins at or before it
    while (high - low > 1) {
        int64_t middle = (low + high) / 2;
        if (run->first_ordinal[middle] <= (int64_t)ordinal)
            low = middle;
        else
            high = middle;
    }
    return measure_drawn(run->cut->items[low].page, (uint16_t)((int64_t)ordinal - run->first_ordinal[low]));
}

// The first item to come owns the vertex; a position other than its own splits the vertex, whichever came first.
static void mark_vertex(MeasureRun *run, const LodPage *page, uint16_t vertex, uint32_t ordinal) {
    const LodVertex *v = &page->vertices[vertex];
    _Atomic uint32_t *place = &run->vertices[(int64_t)(page->row0 + v->row) * run->dem->width + page->col0 + v->col];
    uint32_t owner = 0;
    if (atomic_compare_exchange_strong(place, &owner, ordinal))
        return;
    GridPoint a = measure_drawn(page, vertex), b = drawn_by_ordinal(run, owner & MEASURE_ORDINAL);
    if (a.x != b.x || a.y != b.y || a.z != b.z)
        atomic_fetch_or(place, MEASURE_SPLIT);
}

static void mark_item(MeasureRun *run, MeasureWorker *worker, int64_t index) {
    const LodItem *item = &run->cut->items[index];
    uint64_t size = 64;
    while (size < 2 * (uint64_t)item->index_count)
        size *= 2;
    memset(worker->table, 0, sizeof *worker->table * size);
    memset(worker->used, 0, (size_t)item->page->vertex_count);
    mark_used(run, worker, item, size - 1);
    for (uint64_t i = 0; i < size; i++)
        if ((worker->table[i].forward || worker->table[i].backward) && !edge_is_whole(run->dem, &worker->table[i]))
            keep_open(worker, &worker->table[i]);
    for (int32_t i = 0; i < item->page->vertex_count; i++)
        if (worker->used[i])
            mark_vertex(run, item->page, (uint16_t)i, (uint32_t)(run->first_ordinal[index] + i));
}

void measure_mark_vertices(MeasureRun *run, MeasureWorker *worker, int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end && measure_goes_on(run); i++)
        mark_item(run, worker, i);
}

// ---- T-junctions ----

static int64_t greatest_common_divisor(int64_t a, int64_t b) {
    while (b) {
        int64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

static void walk_edge(MeasureRun *run, const MeasureTriangle *t, int i, int j) {
    int64_t dcol = t->col[j] - t->col[i], drow = t->row[j] - t->row[i];
    int64_t steps = greatest_common_divisor(llabs(dcol), llabs(drow));
    for (int64_t k = 1; k < steps; k++) {
        int64_t at = (t->row[i] + drow / steps * k) * run->dem->width + t->col[i] + dcol / steps * k;
        if (atomic_load_explicit(&run->vertices[at], memory_order_relaxed))
            atomic_fetch_or(&run->vertices[at], MEASURE_JUNCTION);
    }
}

void measure_find_junctions(MeasureRun *run, int64_t begin, int64_t end) {
    MeasureTriangle t;
    for (int64_t i = begin; i < end && measure_goes_on(run); i++)
        for (int64_t k = 0; k < run->cut->items[i].index_count / 3; k++)
            if (measure_triangle(run, &run->cut->items[i], k, &t))
                for (int side = 0; side < 3; side++)
                    walk_edge(run, &t, side, (side + 1) % 3);
}

// ---- all items together ----

static int edge_compare(const void *left, const void *right) {
    const MeasureEdge *a = left, *b = right;
    if (a->row != b->row)
        return a->row < b->row ? -1 : 1;
    if (a->col != b->col)
        return a->col < b->col ? -1 : 1;
    if (a->drow != b->drow)
        return a->drow < b->drow ? -1 : 1;
    return (a->dcol > b->dcol) - (a->dcol < b->dcol);
}

static void judge_edge(const Dem *dem, const MeasureEdge *e, Measure *out) {
    if (edge_is_whole(dem, e))
        return;
    if (edge_on_border(dem, e)) {
        out->overlaps++;
        return;
    }
    out->overlaps += (e->forward > 1) + (e->backward > 1);
    out->holes += !e->forward + !e->backward;
}

static void judge_edges(const Dem *dem, const MeasureEdge *edges, int64_t count, Measure *out) {
    for (int64_t i = 0, next; i < count; i = next) {
        MeasureEdge sum = edges[i];
        for (next = i + 1; next < count && edge_same(&edges[next], &sum); next++) {
            sum.forward += edges[next].forward;
            sum.backward += edges[next].backward;
        }
        judge_edge(dem, &sum, out);
    }
}

Result measure_join_edges(const MeasureRun *run, Measure *out) {
    int64_t count = 0, filled = 0;
    for (int i = 0; i < run->worker_count; i++)
        count += run->workers[i].open_count;
    MeasureEdge *edges = malloc(sizeof *edges * (size_t)(count ? count : 1));
    if (!edges)
        return RESULT_MEMORY;
    for (int i = 0; i < run->worker_count; i++) {
        const MeasureWorker *worker = &run->workers[i];
        if (worker->open_count)
            memcpy(edges + filled, worker->open, sizeof *edges * (size_t)worker->open_count);
        filled += worker->open_count;
    }
    qsort(edges, (size_t)count, sizeof *edges, edge_compare);
    judge_edges(run->dem, edges, count, out);
    free(edges);
    return RESULT_OK;
}
