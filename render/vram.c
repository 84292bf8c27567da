#include "render/vram.h"

#include "base/log.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

// Free runs are kept in lists by size class: 8 classes per power of two ("TLSF: a new dynamic memory allocator for
// real-time systems", Masmano et al. 2004). Allocation looks only in classes whose every run is long enough.
#define SUB_BITS 3
#define SUBS (1 << SUB_BITS)
#define POWERS 32

typedef struct Block {
    uint32_t begin, length;        // granules
    uint32_t before, after;        // neighbours in the buffer
    uint32_t list_prev, list_next; // neighbours in the list of the size class, while free; list_next of unused blocks
    bool used;
} Block;

struct Vram {
    Block *blocks;
    uint32_t block_count, block_capacity, spare; // spare: head of the list of unused entries
    uint32_t heads[POWERS][SUBS];
    uint32_t powers_present;
    uint32_t subs_present[POWERS];
    size_t capacity, used; // granules
};

typedef struct SizeClass {
    int power, sub;
} SizeClass;

static int highest_bit(uint32_t value) {
    return 31 - __builtin_clz(value);
}

// The class a run of this length is listed in.
static SizeClass class_of(uint32_t length) {
    int power = highest_bit(length);
    if (power < SUB_BITS)
        return (SizeClass){0, (int)length}; // lengths 1 .. 7 have a class each
    return (SizeClass){power - SUB_BITS + 1, (int)(length >> (power - SUB_BITS)) - SUBS};
}

// The first class in which every run is at least this long.
static SizeClass class_above(uint32_t length) {
    int power = highest_bit(length);
    if (power < SUB_BITS)
        return class_of(length);
    uint32_t step = 1u << (power - SUB_BITS);
    return class_of((uint32_t)((length + step - 1) & ~(step - 1)));
}

static void list_remove(Vram *vram, uint32_t index) {
    Block *block = &vram->blocks[index];
    SizeClass c = class_of(block->length);
    if (block->list_prev != VRAM_NONE)
        vram->blocks[block->list_prev].list_next = block->list_next;
    else
        vram->heads[c.power][c.sub] = block->list_next;
    if (block->list_next != VRAM_NONE)
        vram->blocks[block->list_next].list_prev = block->list_prev;
    if (vram->heads[c.power][c.sub] == VRAM_NONE)
        vram->subs_present[c.power] &= ~(1u << c.sub);
    if (!vram->subs_present[c.power])
        vram->powers_present &= ~(1u << c.power);
}

static void list_insert(Vram *vram, uint32_t index) {
    Block *block = &vram->blocks[index];
    SizeClass c = class_of(block->length);
    block->list_prev = VRAM_NONE;
    block->list_next = vram->heads[c.power][c.sub];
    if (block->list_next != VRAM_NONE)
        vram->blocks[block->list_next].list_prev = index;
    vram->heads[c.power][c.sub] = index;
    vram->subs_present[c.power] |= 1u << c.sub;
    vram->powers_present |= 1u << c.power;
}

// Runs of the request's own class may be long enough too; looked at only when nothing above is left.
static uint32_t find_tight_run(const Vram *vram, uint32_t length) {
    SizeClass c = class_of(length);
    uint32_t index = vram->heads[c.power][c.sub];
    while (index != VRAM_NONE && vram->blocks[index].length < length)
        index = vram->blocks[index].list_next;
    return index;
}

static uint32_t find_run(const Vram *vram, uint32_t length) {
    SizeClass c = class_above(length);
    uint32_t subs = vram->subs_present[c.power] & (~0u << c.sub);
    if (!subs) {
        uint32_t powers = c.power + 1 < POWERS ? vram->powers_present & (~0u << (c.power + 1)) : 0;
        if (!powers)
            return find_tight_run(vram, length);
        c.power = __builtin_ctz(powers);
        subs = vram->subs_present[c.power];
    }
    return vram->heads[c.power][__builtin_ctz(subs)];
}

static bool grow_blocks(Vram *vram) {
    uint32_t capacity = vram->block_capacity ? vram->block_capacity * 2 : 1024;
    Block *grown = realloc(vram->blocks, capacity * sizeof *grown);
    if (!grown)
        return false;
    vram->blocks = grown;
    vram->block_capacity = capacity;
    return true;
}

static uint32_t take_entry(Vram *vram) {
    if (vram->spare != VRAM_NONE) {
        uint32_t index = vram->spare;
        vram->spare = vram->blocks[index].list_next;
        return index;
    }
    if (vram->block_count == vram->block_capacity && !grow_blocks(vram))
        return VRAM_NONE;
    return vram->block_count++;
}

static void give_entry(Vram *vram, uint32_t index) {
    vram->blocks[index].list_next = vram->spare;
    vram->blocks[index].length = 0;
    vram->spare = index;
}

// Cuts what `index` does not need into a free block of its own; keeps the whole when the tables cannot grow.
static void split(Vram *vram, uint32_t index, uint32_t length) {
    if (vram->blocks[index].length == length)
        return;
    uint32_t rest = take_entry(vram);
    if (rest == VRAM_NONE)
        return;
    Block *block = &vram->blocks[index];
    vram->blocks[rest] = (Block){
        .begin = block->begin + length, .length = block->length - length, .before = index, .after = block->after};
    if (block->after != VRAM_NONE)
        vram->blocks[block->after].before = rest;
    block->after = rest;
    block->length = length;
    list_insert(vram, rest);
}

// `right` directly follows `left` and is in no list; its entry is given back.
static void merge(Vram *vram, uint32_t left, uint32_t right) {
    Block *a = &vram->blocks[left], *b = &vram->blocks[right];
    a->length += b->length;
    a->after = b->after;
    if (b->after != VRAM_NONE)
        vram->blocks[b->after].before = left;
    give_entry(vram, right);
}

Result vram_create(size_t bytes, Vram **out) {
    size_t granules = bytes / VRAM_GRANULE;
    Vram *vram = calloc(1, sizeof *vram);
    if (!vram || granules < 1 || granules > (size_t)1 << 31) {
        log_error("a patch cache of %zu bytes: out of memory or of range", bytes);
        free(vram);
        return vram ? RESULT_RANGE : RESULT_MEMORY;
    }
    vram->spare = VRAM_NONE;
    vram->capacity = granules;
    memset(vram->heads, 0xff, sizeof vram->heads); // VRAM_NONE
    uint32_t whole = take_entry(vram);
    if (whole == VRAM_NONE) {
        log_error("out of memory for the tables of the patch cache");
        vram_destroy(&vram);
        return RESULT_MEMORY;
    }
    vram->blocks[whole] = (Block){.length = (uint32_t)granules, .before = VRAM_NONE, .after = VRAM_NONE};
    list_insert(vram, whole);
    *out = vram;
    return RESULT_OK;
}

void vram_destroy(Vram **vram) {
    if (*vram)
        free((*vram)->blocks);
    free(*vram);
    *vram = NULL;
}

VramRegion vram_alloc(Vram *vram, size_t bytes) {
    size_t granules = vram_round_up(bytes) / VRAM_GRANULE;
    if (granules == 0 || granules > vram->capacity)
        return VRAM_NONE;
    uint32_t index = find_run(vram, (uint32_t)granules);
    if (index == VRAM_NONE)
        return VRAM_NONE;
    list_remove(vram, index);
    split(vram, index, (uint32_t)granules);
    vram->blocks[index].used = true;
    vram->used += vram->blocks[index].length;
    return index;
}

void vram_free(Vram *vram, VramRegion region) {
    assert(region < vram->block_count && vram->blocks[region].used);
    uint32_t index = region, before = vram->blocks[index].before, after = vram->blocks[index].after;
    vram->used -= vram->blocks[index].length;
    vram->blocks[index].used = false;
    if (after != VRAM_NONE && !vram->blocks[after].used) {
        list_remove(vram, after);
        merge(vram, index, after);
    }
    if (before != VRAM_NONE && !vram->blocks[before].used) {
        list_remove(vram, before);
        merge(vram, before, index);
        index = before;
    }
    list_insert(vram, index);
}

size_t vram_offset(const Vram *vram, VramRegion region) {
    return (size_t)vram->blocks[region].begin * VRAM_GRANULE;
}

size_t vram_size(const Vram *vram, VramRegion region) {
    return (size_t)vram->blocks[region].length * VRAM_GRANULE;
}

size_t vram_capacity(const Vram *vram) {
    return vram->capacity * VRAM_GRANULE;
}

size_t vram_used(const Vram *vram) {
    return vram->used * VRAM_GRANULE;
}

size_t vram_round_up(size_t bytes) {
    return (bytes + VRAM_GRANULE - 1) / VRAM_GRANULE * VRAM_GRANULE;
}
