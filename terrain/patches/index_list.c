#include "terrain/patches/index_list.h"

#include <stdlib.h>
#include <string.h>

void index_store_destroy(IndexStore *store) {
    for (int p = 0; p < LOD_PARTITIONS_MAX; p++)
        index_pool_destroy(&store->pools[p]);
    free(store->retired);
    store->retired = NULL;
    store->retired_begin = store->retired_count = store->retired_capacity = 0;
}

bool index_list_take(IndexStore *store, int pool, int32_t index_count, IndexList *out) {
    int size_class = index_pool_class(index_count);
    uint16_t *indices = index_pool_take(&store->pools[pool], size_class);
    *out = (IndexList){indices, index_count, (int16_t)pool, (int16_t)size_class};
    return indices;
}

void index_list_give_back(IndexStore *store, IndexList *list) {
    if (list->indices)
        index_pool_give_back(&store->pools[list->pool], list->indices, list->size_class);
    *list = (IndexList){0};
}

static Result make_room(IndexStore *store) {
    if (store->retired_count < store->retired_capacity)
        return RESULT_OK;
    if (store->retired_begin > store->retired_capacity / 2) {
        store->retired_count -= store->retired_begin;
        memmove(store->retired, store->retired + store->retired_begin,
                sizeof *store->retired * (size_t)store->retired_count);
        store->retired_begin = 0;
        return RESULT_OK;
    }
    int32_t larger = store->retired_capacity * 2 + 256;
    IndexRetired *grown = realloc(store->retired, sizeof *grown * (size_t)larger);
    if (!grown)
        return RESULT_MEMORY;
    store->retired = grown;
    store->retired_capacity = larger;
    return RESULT_OK;
}

Result index_list_retire(IndexStore *store, IndexList *list, uint64_t last_frame) {
    if (!list->indices)
        return RESULT_OK;
    Result result = make_room(store);
    if (result != RESULT_OK)
        return result;
    store->retired[store->retired_count++] = (IndexRetired){last_frame, *list};
    *list = (IndexList){0};
    return RESULT_OK;
}

void index_store_release(IndexStore *store, uint64_t frame) {
    for (; store->retired_begin < store->retired_count && store->retired[store->retired_begin].last_frame <= frame;
         store->retired_begin++)
        index_list_give_back(store, &store->retired[store->retired_begin].list);
    if (store->retired_begin == store->retired_count)
        store->retired_begin = store->retired_count = 0;
}
