#include "render/patch_table.h"

#include "base/log.h"

#include <stdlib.h>
#include <string.h>

#define FIRST_CAPACITY 1024u // entries; a power of two

static uint64_t mix(uint64_t x) { // the finaliser of MurmurHash3: every bit of the key reaches every bit of the hash
    x ^= x >> 33;
    x *= 0xff51afd7ed558ccdull;
    x ^= x >> 33;
    x *= 0xc4ceb9fe1a85ec53ull;
    return x ^ x >> 33;
}

static uint32_t bucket_of(const PatchTable *table, PatchKey key) {
    return (uint32_t)mix(key.page_id + mix(key.revision * 2 + (uint64_t)key.kind)) & (table->bucket_count - 1);
}

static bool same_key(PatchKey a, PatchKey b) {
    return a.page_id == b.page_id && a.revision == b.revision && a.kind == b.kind;
}

static void link_bucket(PatchTable *table, uint32_t index) {
    uint32_t bucket = bucket_of(table, table->entries[index].key);
    table->entries[index].bucket_next = table->buckets[bucket];
    table->buckets[bucket] = index;
}

static void link_newest(PatchTable *table, uint32_t index) {
    PatchEntry *entry = &table->entries[index];
    entry->newer = PATCH_NONE;
    entry->older = table->newest;
    if (table->newest != PATCH_NONE)
        table->entries[table->newest].newer = index;
    else
        table->oldest = index;
    table->newest = index;
}

static void unlink_use(PatchTable *table, uint32_t index) {
    PatchEntry *entry = &table->entries[index];
    if (entry->newer != PATCH_NONE)
        table->entries[entry->newer].older = entry->older;
    else
        table->newest = entry->older;
    if (entry->older != PATCH_NONE)
        table->entries[entry->older].newer = entry->newer;
    else
        table->oldest = entry->newer;
}

Result patch_table_create(PatchTable *table) {
    *table = (PatchTable){.spare = PATCH_NONE, .newest = PATCH_NONE, .oldest = PATCH_NONE};
    table->entries = malloc(FIRST_CAPACITY * sizeof *table->entries);
    table->buckets = malloc(FIRST_CAPACITY * sizeof *table->buckets);
    if (!table->entries || !table->buckets) {
        log_error("out of memory for the tables of the patch cache");
        patch_table_destroy(table);
        return RESULT_MEMORY;
    }
    table->capacity = table->bucket_count = FIRST_CAPACITY;
    memset(table->buckets, 0xff, FIRST_CAPACITY * sizeof *table->buckets); // PATCH_NONE
    return RESULT_OK;
}

void patch_table_destroy(PatchTable *table) {
    free(table->entries);
    free(table->buckets);
    *table = (PatchTable){.spare = PATCH_NONE, .newest = PATCH_NONE, .oldest = PATCH_NONE};
}

static void rehash(PatchTable *table) {
    memset(table->buckets, 0xff, table->bucket_count * sizeof *table->buckets);
    for (uint32_t i = table->newest; i != PATCH_NONE; i = table->entries[i].older)
        link_bucket(table, i);
}

static bool grow(PatchTable *table) {
    uint32_t capacity = table->capacity * 2;
    PatchEntry *entries = realloc(table->entries, capacity * sizeof *entries);
    if (!entries)
        return false;
    table->entries = entries;
    uint32_t *buckets = realloc(table->buckets, capacity * sizeof *buckets);
    if (!buckets)
        return false;
    table->buckets = buckets;
    table->capacity = table->bucket_count = capacity;
    rehash(table);
    return true;
}

uint32_t patch_table_find(const PatchTable *table, PatchKey key) {
    uint32_t index = table->buckets[bucket_of(table, key)];
    while (index != PATCH_NONE && !same_key(table->entries[index].key, key))
        index = table->entries[index].bucket_next;
    return index;
}

uint32_t patch_table_add(PatchTable *table, PatchKey key, uint64_t frame) {
    uint32_t index = table->spare;
    if (index != PATCH_NONE)
        table->spare = table->entries[index].bucket_next;
    else if (table->count < table->capacity || grow(table))
        index = table->count++;
    else
        return PATCH_NONE;
    table->entries[index] = (PatchEntry){.key = key, .region = VRAM_NONE, .used_frame = frame, .latest = PATCH_NONE};
    link_bucket(table, index);
    link_newest(table, index);
    return index;
}

void patch_table_touch(PatchTable *table, uint32_t index, uint64_t frame) {
    unlink_use(table, index);
    link_newest(table, index);
    table->entries[index].used_frame = frame;
}

void patch_table_remove(PatchTable *table, uint32_t index) {
    uint32_t *link = &table->buckets[bucket_of(table, table->entries[index].key)];
    while (*link != index)
        link = &table->entries[*link].bucket_next;
    *link = table->entries[index].bucket_next;
    unlink_use(table, index);
    table->entries[index].bucket_next = table->spare;
    table->spare = index;
}
