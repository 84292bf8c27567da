// render/patch_cache.h: vertex pages and index lists in one big GPU buffer, uploaded once and drawn often.
// Bytes; offsets count from the buffer's begin.
// A PatchCache owns the buffer and belongs to the thread that has the context current.
#pragma once
#include "base/base.h"
#include "terrain/lod/lod.h"

typedef struct PatchCache PatchCache;

// Where an item's data lie, in the units glDrawElementsBaseVertex takes.
typedef struct PatchPlace {
    uint32_t first_index; // 16-bit indices from the buffer's begin
    int32_t base_vertex;  // LodVertex from the buffer's begin
    uint16_t cols, rows;  // samples the page spans, from its first
    bool page_uploaded;   // in this frame
} PatchPlace;

typedef struct PatchCacheStats {
    int64_t upload_bytes, evictions; // of this frame
    int64_t used_bytes;
} PatchCacheStats;

// `bytes`: the memory limit, all of it taken at once; halved, with a warning, while the driver refuses it.
// DEVICE: not even a small buffer was to be had.
MUST_USE Result patch_cache_create(size_t bytes, PatchCache **out);
void patch_cache_destroy(PatchCache **cache);
unsigned patch_cache_buffer(const PatchCache *cache);
size_t patch_cache_capacity(const PatchCache *cache);

// One frame: begin, place all items, draw, end. A region is written again only once the last frame that drew it
// has left the GPU.
void patch_cache_begin_frame(PatchCache *cache);
// Where all `count` items lie, after uploading what is not there yet. BUDGET: they do not fit even alone; no place
// is valid, nothing was changed, and what was placed last may be drawn again. MEMORY: the tables cannot grow; no place
// is valid, and what was placed before may be gone.
MUST_USE Result patch_cache_place(PatchCache *cache, const LodItem *items, int32_t count, PatchPlace *places);
// After BUDGET: keeps what was placed last for one more frame.
void patch_cache_keep_last(PatchCache *cache);
// A number for what was placed last, another one after each placing: who placed something can tell whether it still is
// the last. 0: nothing that can be kept.
uint64_t patch_cache_last_placed(const PatchCache *cache);
void patch_cache_end_frame(PatchCache *cache);
// Between frames: drops everything, once the GPU is done with it.
void patch_cache_clear(PatchCache *cache);
PatchCacheStats patch_cache_stats(const PatchCache *cache);

// The bytes that `count` items need in the buffer, alone.
size_t patch_cache_bytes_needed(const LodItem *items, int32_t count);
