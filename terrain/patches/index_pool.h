// terrain/patches/index_pool.h: memory for index lists, in sizes of powers of two, kept for reuse.
// Sizes in indices.
// A pool owns all memory it ever handed out; one thread at a time.
#pragma once
#include "base/base.h"

#define INDEX_POOL_CLASSES 14
#define INDEX_POOL_SMALLEST 64 // indices of class 0

typedef struct IndexPool {
    void *free_lists[INDEX_POOL_CLASSES];
    void *blocks; // chain of everything allocated
    size_t system_allocations;
} IndexPool;

int index_pool_class(int32_t index_count);
// 8-byte aligned; room for at least index_count; NULL when memory is out.
uint16_t *index_pool_take(IndexPool *pool, int size_class);
void index_pool_give_back(IndexPool *pool, uint16_t *indices, int size_class);
void index_pool_destroy(IndexPool *pool);
