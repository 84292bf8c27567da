#define _GNU_SOURCE // qsort_r
#include "terrain/lod/cut_copy.h"

#include "base/log.h"

#include <stdlib.h>
#include <string.h>

typedef struct Sizes {
    int64_t items, vertices, indices;
} Sizes;

static Sizes sizes_of(const LodCut *cut) {
    Sizes sizes = {.items = cut->item_count};
    for (int32_t i = 0; i < cut->item_count; i++) {
        sizes.vertices += cut->items[i].page->vertex_count;
        sizes.indices += cut->items[i].index_count;
    }
    return sizes;
}

// Contents are not kept.
static bool reserve(void **memory, int64_t *capacity, int64_t count, size_t bytes_each) {
    if (count <= *capacity)
        return true;
    free(*memory);
    *memory = malloc((size_t)count * bytes_each);
    *capacity = *memory ? count : 0;
    return *memory;
}

static bool reserve_items(CutCopy *copy, int64_t count) {
    int64_t capacity = copy->item_capacity;
    return reserve((void **)&copy->items, &capacity, count, sizeof *copy->items) &&
           reserve((void **)&copy->pages, &copy->item_capacity, count, sizeof *copy->pages);
}

static void copy_items(CutCopy *copy, const LodCut *cut) {
    LodVertex *vertices = copy->vertices;
    uint16_t *indices = copy->indices;
    for (int32_t i = 0; i < cut->item_count; i++) {
        const LodItem *from = &cut->items[i];
        LodItem *item = &copy->items[i];
        LodPage *page = &copy->pages[i];
        *item = *from;
        *page = *from->page;
        item->page = page;
        page->vertices = memcpy(vertices, from->page->vertices, sizeof *vertices * (size_t)page->vertex_count);
        vertices += page->vertex_count;
        if (item->index_count > 0)
            item->indices = memcpy(indices, from->indices, sizeof *indices * (size_t)item->index_count);
        indices += item->index_count;
    }
}

static size_t bytes_of(const CutCopy *copy, const Sizes *sizes) {
    return (size_t)sizes->items * (sizeof *copy->items + sizeof *copy->pages) +
           (size_t)sizes->vertices * sizeof *copy->vertices + (size_t)sizes->indices * sizeof *copy->indices;
}

Result cut_copy_take(CutCopy *copy, const LodCut *cut, size_t bytes_max) {
    Sizes sizes = sizes_of(cut);
    if (bytes_of(copy, &sizes) > bytes_max) {
        cut_copy_free(copy);
        return RESULT_BUDGET;
    }
    if (!reserve_items(copy, sizes.items) ||
        !reserve((void **)&copy->vertices, &copy->vertex_capacity, sizes.vertices, sizeof *copy->vertices) ||
        !reserve((void **)&copy->indices, &copy->index_capacity, sizes.indices, sizeof *copy->indices)) {
        cut_copy_free(copy);
        log_error("no memory for a copy of a cut of %lld triangles", (long long)cut->stats.triangles);
        return RESULT_MEMORY;
    }
    copy_items(copy, cut);
    copy->cut = *cut;
    copy->cut.items = copy->items;
    copy->cut.resident = NULL;
    return RESULT_OK;
}

static double nearest_m(const LodItem *item, const Vec3d *eye_ecef) {
    return vec3d_length(vec3d_sub(item->centre_ecef, *eye_ecef)) - item->radius_m;
}

static int compare_nearest(const void *a, const void *b, void *user) {
    double x = nearest_m(a, user), y = nearest_m(b, user);
    return (x > y) - (x < y);
}

void cut_copy_sort(CutCopy *copy) {
    qsort_r(copy->items, (size_t)copy->cut.item_count, sizeof *copy->items, compare_nearest, &copy->cut.view.eye_ecef);
}

void cut_copy_free(CutCopy *copy) {
    free(copy->items);
    free(copy->pages);
    free(copy->vertices);
    free(copy->indices);
    *copy = (CutCopy){0};
}
