// base/arena.h: memory that is freed all at once, by frame or by job.
// Sizes in bytes.
// The arena owns what it hands out, until arena_reset or arena_destroy. One thread at a time.
#pragma once
#include "base/base.h"

typedef struct Arena Arena;

// `block_bytes`: the size asked from the system at a time, > 0.
MUST_USE Result arena_create(size_t block_bytes, Arena **out);
void arena_destroy(Arena **arena);

// 64-byte aligned, not zeroed; NULL when the system has no memory left. After warm-up a reset arena gives
// memory without asking the system again.
void *arena_alloc(Arena *arena, size_t bytes);
void arena_reset(Arena *arena);

// How often the system was asked for memory since creation: a test holds it still after warm-up.
size_t arena_system_allocations(const Arena *arena);
size_t arena_capacity(const Arena *arena);

#define arena_new(arena, Type, count) ((Type *)arena_alloc((arena), sizeof(Type) * (size_t)(count)))
