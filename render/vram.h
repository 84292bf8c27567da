// render/vram.h: which bytes of one big buffer are whose. No GL: only the bookkeeping.
// Bytes, in granules of VRAM_GRANULE.
// A Vram owns its tables, not the buffer. One thread at a time.
#pragma once
#include "base/base.h"

#define VRAM_GRANULE 64 // bytes; every region begins at a multiple
#define VRAM_NONE UINT32_MAX

typedef struct Vram Vram;
typedef uint32_t VramRegion; // VRAM_NONE: no region

// `bytes` is rounded down to granules; 1 granule .. 2^31 granules.
MUST_USE Result vram_create(size_t bytes, Vram **out);
void vram_destroy(Vram **vram);

// Two-level segregated fit: constant time while memory is plentiful; free neighbours are one run. VRAM_NONE only
// when no free run is long enough. bytes > 0.
VramRegion vram_alloc(Vram *vram, size_t bytes);
void vram_free(Vram *vram, VramRegion region);
size_t vram_offset(const Vram *vram, VramRegion region); // bytes from the buffer's begin
size_t vram_size(const Vram *vram, VramRegion region);   // bytes, rounded up to granules

size_t vram_capacity(const Vram *vram);
size_t vram_used(const Vram *vram);
// What an allocation of `bytes` takes.
size_t vram_round_up(size_t bytes);
