// render/patch_table.h: which page or index list has which region; found by key, ordered by last use. No GL.
// Frames count up.
// A PatchTable owns its entries. One thread at a time.
#pragma once
#include "render/vram.h"

#define PATCH_NONE UINT32_MAX

typedef enum PatchKind { PATCH_PAGE, PATCH_INDICES } PatchKind;

typedef struct PatchKey {
    uint64_t page_id;
    uint64_t revision; // of PATCH_INDICES; 0 for PATCH_PAGE
    PatchKind kind;
} PatchKey;

typedef struct PatchEntry {
    PatchKey key;
    VramRegion region;
    uint64_t used_frame;   // the last frame that drew it
    uint16_t cols, rows;   // of PATCH_PAGE: samples it spans, from its first
    uint32_t latest;       // of PATCH_PAGE: the index list placed last, or PATCH_NONE
    uint32_t bucket_next;  // in the hash bucket, or in the list of spare entries
    uint32_t newer, older; // by last use
} PatchEntry;

typedef struct PatchTable {
    PatchEntry *entries;
    uint32_t *buckets; // [bucket_count], a power of two
    uint32_t count, capacity, spare, bucket_count;
    uint32_t newest, oldest;
} PatchTable;

MUST_USE Result patch_table_create(PatchTable *table);
void patch_table_destroy(PatchTable *table);

// An index into `entries`, or PATCH_NONE. Indices stay valid until the entry is removed; pointers until the next add.
uint32_t patch_table_find(const PatchTable *table, PatchKey key);
// As the newest, without a region. PATCH_NONE: no memory.
uint32_t patch_table_add(PatchTable *table, PatchKey key, uint64_t frame);
void patch_table_touch(PatchTable *table, uint32_t index, uint64_t frame); // becomes the newest
void patch_table_remove(PatchTable *table, uint32_t index);
