// terrain/patches/index_list.h: the index lists of patches, kept until nobody reads them.
// Sizes in indices; frames as counted by lod_update.
// An IndexStore owns all lists it handed out; its pools are used by one thread each, all else by one at a time.
#pragma once
#include "terrain/lod/lod.h"
#include "terrain/patches/index_pool.h"

typedef struct IndexList {
    uint16_t *indices; // NULL: none
    int32_t index_count;
    int16_t pool, size_class;
} IndexList;

typedef struct IndexRetired {
    uint64_t last_frame; // that may read the list
    IndexList list;
} IndexRetired;

typedef struct IndexStore {
    IndexPool pools[LOD_PARTITIONS_MAX];
    IndexRetired *retired; // a queue: [retired_begin, retired_count)
    int32_t retired_begin, retired_count, retired_capacity;
} IndexStore;

void index_store_destroy(IndexStore *store);

// Room for at least `index_count`, from pool `pool`; false when memory is out.
MUST_USE bool index_list_take(IndexStore *store, int pool, int32_t index_count, IndexList *out);
// Empties the list, whose indices live until index_store_release of `last_frame`. MEMORY.
MUST_USE Result index_list_retire(IndexStore *store, IndexList *list, uint64_t last_frame);
// Empties a list that nobody reads.
void index_list_give_back(IndexStore *store, IndexList *list);
// Lists retired with this frame or one before are free.
void index_store_release(IndexStore *store, uint64_t frame);
