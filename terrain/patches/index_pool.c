#include "terrain/patches/index_pool.h"

#include <stdlib.h>

#define SLAB_BYTES (256 * 1024) // lists are cut from slabs, so that the system is seldom asked

typedef struct Link {
    struct Link *next;
} Link;

int index_pool_class(int32_t index_count) {
    int size_class = 0;
    while (INDEX_POOL_SMALLEST << size_class < index_count)
        size_class++;
    return size_class;
}

static bool add_slab(IndexPool *pool, int size_class) {
    size_t bytes = (size_t)(INDEX_POOL_SMALLEST << size_class) * sizeof(uint16_t);
    size_t count = SLAB_BYTES / bytes ? SLAB_BYTES / bytes : 1;
    unsigned char *slab = malloc(sizeof(Link) + 8 + count * bytes);
    if (!slab)
        return false;
    pool->system_allocations++;
    Link *chain = (Link *)(void *)slab;
    chain->next = pool->blocks;
    pool->blocks = chain;
    unsigned char *first = slab + sizeof(Link);
    for (size_t i = 0; i < count; i++)
        index_pool_give_back(pool, (uint16_t *)(void *)(first + i * bytes), size_class);
    return true;
}

uint16_t *index_pool_take(IndexPool *pool, int size_class) {
    if (!pool->free_lists[size_class] && !add_slab(pool, size_class))
        return NULL;
    Link *link = pool->free_lists[size_class];
    pool->free_lists[size_class] = link->next;
    return (uint16_t *)(void *)link;
}

void index_pool_give_back(IndexPool *pool, uint16_t *indices, int size_class) {
    Link *link = (Link *)(void *)indices;
    link->next = pool->free_lists[size_class];
    pool->free_lists[size_class] = link;
}

void index_pool_destroy(IndexPool *pool) {
    for (Link *block = pool->blocks; block;) {
        Link *next = block->next;
        free(block);
        block = next;
    }
    *pool = (IndexPool){0};
}
