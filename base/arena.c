#include "base/arena.h"

#include <stdlib.h>

#define ALIGNMENT 64

typedef struct Block {
    struct Block *next;
    size_t capacity;
    size_t used;
    unsigned char *bytes;
} Block;

struct Arena {
    size_t block_bytes;
    Block *first;
    Block *current;
    size_t system_allocations;
    size_t capacity;
};

Result arena_create(size_t block_bytes, Arena **out) {
    Arena *arena = calloc(1, sizeof *arena);
    if (!arena)
        return RESULT_MEMORY;
    arena->block_bytes = block_bytes;
    *out = arena;
    return RESULT_OK;
}

void arena_destroy(Arena **arena) {
    if (!*arena)
        return;
    for (Block *block = (*arena)->first; block;) {
        Block *next = block->next;
        free(block->bytes);
        free(block);
        block = next;
    }
    free(*arena);
    *arena = NULL;
}

static size_t round_up(size_t bytes) {
    return (bytes + ALIGNMENT - 1) & ~(size_t)(ALIGNMENT - 1);
}

static Block *add_block(Arena *arena, size_t bytes) {
    size_t capacity = bytes > arena->block_bytes ? bytes : round_up(arena->block_bytes);
    Block *block = calloc(1, sizeof *block);
    if (!block)
        return NULL;
    block->bytes = aligned_alloc(ALIGNMENT, capacity);
    if (!block->bytes) {
        free(block);
        return NULL;
    }
    block->capacity = capacity;
    arena->system_allocations++;
    arena->capacity += capacity;
    if (arena->current) {
        block->next = arena->current->next;
        arena->current->next = block;
    } else {
        arena->first = block;
    }
    return block;
}

void *arena_alloc(Arena *arena, size_t bytes) {
    if (bytes > SIZE_MAX / 2)
        return NULL;
    size_t size = round_up(bytes ? bytes : 1);
    Block *block = arena->current;
    while (block && block->capacity - block->used < size) {
        block = block->next;
        if (block) {
            block->used = 0;
            arena->current = block;
        }
    }
    if (!block) {
        block = add_block(arena, size);
        if (!block)
            return NULL;
        arena->current = block;
    }
    void *memory = block->bytes + block->used;
    block->used += size;
    return memory;
}

void arena_reset(Arena *arena) {
    arena->current = arena->first;
    if (arena->first)
        arena->first->used = 0;
}

size_t arena_system_allocations(const Arena *arena) {
    return arena->system_allocations;
}

size_t arena_capacity(const Arena *arena) {
    return arena->capacity;
}
