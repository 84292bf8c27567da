#include "render/patch_cache.h"

#include "base/log.h"
#include "render/gl.h"
#include "render/patch_table.h"
#include "render/vram.h"

#include <stdlib.h>
#include <string.h>

#define FRAMES_IN_FLIGHT 3
#define BYTES_MIN ((size_t)4 << 20)
#define WAIT_NS 1000000000ull

// A region whose contents are stale, but which a frame in flight may still read.
typedef struct Retired {
    VramRegion region;
    uint64_t frame;
} Retired;

struct PatchCache {
    GLuint buffer;
    uint8_t *mapped;
    Vram *vram;
    PatchTable table;
    Retired *retired;
    int retired_count, retired_capacity;
    GLsync fences[FRAMES_IN_FLIGHT]; // of frame f at f % FRAMES_IN_FLIGHT
    uint64_t frame, completed;       // frames up to `completed` have left the GPU
    uint64_t last_placed;            // the frame whose items were all placed last
    PatchCacheStats stats;
};

static size_t page_bytes(const LodPage *page) {
    return (size_t)page->vertex_count * sizeof(LodVertex);
}

static size_t index_bytes(const LodItem *item) {
    return (size_t)item->index_count * sizeof(uint16_t);
}

size_t patch_cache_bytes_needed(const LodItem *items, int32_t count) {
    size_t bytes = 0;
    for (int32_t i = 0; i < count; i++)
        bytes += vram_round_up(page_bytes(items[i].page)) + vram_round_up(index_bytes(&items[i]));
    return bytes;
}

// --- frames in flight

static void wait_frame(PatchCache *cache, uint64_t frame) {
    while (cache->completed < frame) {
        uint64_t next = cache->completed + 1;
        GLsync *fence = &cache->fences[next % FRAMES_IN_FLIGHT];
        if (*fence) {
            while (glClientWaitSync(*fence, GL_SYNC_FLUSH_COMMANDS_BIT, WAIT_NS) == GL_TIMEOUT_EXPIRED)
                ;
            glDeleteSync(*fence);
            *fence = NULL;
        }
        cache->completed = next;
    }
}

static void poll_frames(PatchCache *cache) {
    while (cache->completed + 1 < cache->frame) {
        GLsync *fence = &cache->fences[(cache->completed + 1) % FRAMES_IN_FLIGHT];
        if (*fence && glClientWaitSync(*fence, 0, 0) == GL_TIMEOUT_EXPIRED)
            return;
        wait_frame(cache, cache->completed + 1);
    }
}

static void free_retired(PatchCache *cache) {
    int kept = 0;
    for (int i = 0; i < cache->retired_count; i++) {
        if (cache->retired[i].frame <= cache->completed)
            vram_free(cache->vram, cache->retired[i].region);
        else
            cache->retired[kept++] = cache->retired[i];
    }
    cache->retired_count = kept;
}

static bool reserve_retired(PatchCache *cache) {
    if (cache->retired_count < cache->retired_capacity)
        return true;
    int capacity = cache->retired_capacity ? cache->retired_capacity * 2 : 256;
    Retired *grown = realloc(cache->retired, (size_t)capacity * sizeof *grown);
    if (!grown)
        return false;
    cache->retired = grown;
    cache->retired_capacity = capacity;
    return true;
}

// The region becomes free once the GPU is done with it: now, later, or after waiting when there is no memory to
// remember it.
static void release_region(PatchCache *cache, VramRegion region, uint64_t used_frame) {
    if (used_frame > cache->completed && !reserve_retired(cache))
        wait_frame(cache, used_frame);
    if (used_frame <= cache->completed)
        vram_free(cache->vram, region);
    else
        cache->retired[cache->retired_count++] = (Retired){region, used_frame};
}

// --- making room

static void forget_entry(PatchCache *cache, uint32_t index) {
    PatchEntry *entry = &cache->table.entries[index];
    if (entry->key.kind == PATCH_INDICES) {
        uint32_t page = patch_table_find(&cache->table, (PatchKey){entry->key.page_id, 0, PATCH_PAGE});
        if (page != PATCH_NONE && cache->table.entries[page].latest == index)
            cache->table.entries[page].latest = PATCH_NONE;
    }
    if (entry->region != VRAM_NONE)
        release_region(cache, entry->region, entry->used_frame);
    patch_table_remove(&cache->table, index);
}

// Drops the entry that was drawn longest ago, unless this frame draws it.
static bool evict_oldest(PatchCache *cache) {
    uint32_t oldest = cache->table.oldest;
    if (oldest == PATCH_NONE || cache->table.entries[oldest].used_frame >= cache->frame)
        return false;
    wait_frame(cache, cache->table.entries[oldest].used_frame);
    forget_entry(cache, oldest);
    cache->stats.evictions++;
    return true;
}

static VramRegion alloc_region(PatchCache *cache, size_t bytes) {
    VramRegion region = vram_alloc(cache->vram, bytes);
    if (region == VRAM_NONE && cache->retired_count) {
        wait_frame(cache, cache->frame - 1);
        free_retired(cache);
        region = vram_alloc(cache->vram, bytes);
    }
    while (region == VRAM_NONE && evict_oldest(cache))
        region = vram_alloc(cache->vram, bytes);
    return region;
}

// `frame`: the last one that has ended.
static void forget_everything(PatchCache *cache, uint64_t frame) {
    wait_frame(cache, frame);
    while (cache->table.oldest != PATCH_NONE) {
        cache->table.entries[cache->table.oldest].used_frame = 0;
        forget_entry(cache, cache->table.oldest);
        cache->stats.evictions++;
    }
    free_retired(cache);
}

// --- uploading

static uint32_t upload(PatchCache *cache, PatchKey key, const void *data, size_t bytes) {
    VramRegion region = alloc_region(cache, bytes);
    if (region == VRAM_NONE)
        return PATCH_NONE;
    uint32_t index = patch_table_add(&cache->table, key, cache->frame);
    if (index == PATCH_NONE) {
        vram_free(cache->vram, region);
        return PATCH_NONE;
    }
    memcpy(cache->mapped + vram_offset(cache->vram, region), data, bytes);
    cache->table.entries[index].region = region;
    cache->stats.upload_bytes += (int64_t)bytes;
    return index;
}

static void measure_page(PatchEntry *entry, const LodPage *page) {
    for (int32_t i = 0; i < page->vertex_count; i++) {
        entry->cols = page->vertices[i].col > entry->cols ? page->vertices[i].col : entry->cols;
        entry->rows = page->vertices[i].row > entry->rows ? page->vertices[i].row : entry->rows;
    }
}

static uint32_t upload_page(PatchCache *cache, PatchKey key, const LodPage *page) {
    uint32_t index = upload(cache, key, page->vertices, page_bytes(page));
    if (index != PATCH_NONE)
        measure_page(&cache->table.entries[index], page);
    return index;
}

static uint32_t place_page(PatchCache *cache, const LodPage *page, bool *uploaded) {
    PatchKey key = {page->id, 0, PATCH_PAGE};
    uint32_t index = patch_table_find(&cache->table, key);
    *uploaded = index == PATCH_NONE;
    if (*uploaded)
        return upload_page(cache, key, page);
    patch_table_touch(&cache->table, index, cache->frame);
    return index;
}

// A page has one current index list; the one before is of no more use, unless this frame draws it too.
static void supersede(PatchCache *cache, uint32_t page, uint32_t indices) {
    uint32_t former = cache->table.entries[page].latest;
    if (former != PATCH_NONE && former != indices && cache->table.entries[former].used_frame < cache->frame)
        forget_entry(cache, former);
    cache->table.entries[page].latest = indices;
}

static uint32_t place_indices(PatchCache *cache, const LodItem *item) {
    PatchKey key = {item->page->id, item->revision, PATCH_INDICES};
    uint32_t index = patch_table_find(&cache->table, key);
    if (index == PATCH_NONE)
        return upload(cache, key, item->indices, index_bytes(item));
    patch_table_touch(&cache->table, index, cache->frame);
    return index;
}

static bool place_item(PatchCache *cache, const LodItem *item, PatchPlace *place) {
    *place = (PatchPlace){0};
    if (item->index_count == 0)
        return true;
    uint32_t page = place_page(cache, item->page, &place->page_uploaded);
    uint32_t indices = page == PATCH_NONE ? PATCH_NONE : place_indices(cache, item);
    if (indices == PATCH_NONE)
        return false;
    supersede(cache, page, indices);
    const PatchEntry *entries = cache->table.entries;
    place->base_vertex = (int32_t)(vram_offset(cache->vram, entries[page].region) / sizeof(LodVertex));
    place->cols = entries[page].cols;
    place->rows = entries[page].rows;
    place->first_index = (uint32_t)(vram_offset(cache->vram, entries[indices].region) / sizeof(uint16_t));
    return true;
}

static bool place_all(PatchCache *cache, const LodItem *items, int32_t count, PatchPlace *places) {
    for (int32_t i = 0; i < count; i++)
        if (!place_item(cache, &items[i], &places[i]))
            return false;
    return true;
}

Result patch_cache_place(PatchCache *cache, const LodItem *items, int32_t count, PatchPlace *places) {
    if (patch_cache_bytes_needed(items, count) > vram_capacity(cache->vram))
        return RESULT_BUDGET;
    if (!place_all(cache, items, count, places)) {
        // Enough memory, in pieces too small: begin again with one piece.
        forget_everything(cache, cache->frame - 1);
        cache->last_placed = 0;
        if (!place_all(cache, items, count, places)) {
            log_error("out of memory for the tables of the patch cache");
            return RESULT_MEMORY;
        }
    }
    cache->last_placed = cache->frame;
    return RESULT_OK;
}

void patch_cache_keep_last(PatchCache *cache) {
    uint32_t index = cache->table.newest;
    while (index != PATCH_NONE && cache->table.entries[index].used_frame >= cache->last_placed) {
        cache->table.entries[index].used_frame = cache->frame;
        index = cache->table.entries[index].older;
    }
    cache->last_placed = cache->frame;
}

uint64_t patch_cache_last_placed(const PatchCache *cache) {
    return cache->last_placed;
}

// --- lifetime and frames

static void create_buffer(PatchCache *cache, size_t bytes) {
    const GLbitfield flags = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    gl_take_error();
    glCreateBuffers(1, &cache->buffer);
    glNamedBufferStorage(cache->buffer, (GLsizeiptr)bytes, NULL, flags);
    if (gl_take_error() == GL_NO_ERROR)
        cache->mapped = glMapNamedBufferRange(cache->buffer, 0, (GLsizeiptr)bytes, flags);
    if (!cache->mapped)
        glDeleteBuffers(1, &cache->buffer);
}

static Result create_largest_buffer(PatchCache *cache, size_t *bytes) {
    size_t asked = *bytes;
    for (; *bytes >= BYTES_MIN; *bytes /= 2) {
        create_buffer(cache, *bytes);
        if (cache->mapped)
            break;
    }
    if (!cache->mapped) {
        log_error("the driver refuses a patch cache of %zu MiB and smaller ones; close other programs that use the GPU",
                  asked >> 20);
        return RESULT_DEVICE;
    }
    if (*bytes < asked)
        log_warn("the driver refuses a patch cache of %zu MiB; it has %zu MiB", asked >> 20, *bytes >> 20);
    return RESULT_OK;
}

Result patch_cache_create(size_t bytes, PatchCache **out) {
    Result result = RESULT_MEMORY;
    PatchCache *cache = calloc(1, sizeof *cache);
    if (!cache) {
        log_error("out of memory for the patch cache");
        return RESULT_MEMORY;
    }
    bytes = bytes < BYTES_MIN ? BYTES_MIN : bytes;
    if ((result = create_largest_buffer(cache, &bytes)) != RESULT_OK)
        goto fail;
    if ((result = vram_create(bytes, &cache->vram)) != RESULT_OK)
        goto fail;
    if ((result = patch_table_create(&cache->table)) != RESULT_OK)
        goto fail;
    *out = cache;
    return RESULT_OK;
fail:
    patch_cache_destroy(&cache);
    return result;
}

void patch_cache_destroy(PatchCache **cache) {
    PatchCache *self = *cache;
    if (!self)
        return;
    for (int i = 0; i < FRAMES_IN_FLIGHT; i++)
        if (self->fences[i])
            glDeleteSync(self->fences[i]);
    if (self->mapped)
        glUnmapNamedBuffer(self->buffer);
    glDeleteBuffers(1, &self->buffer);
    patch_table_destroy(&self->table);
    vram_destroy(&self->vram);
    free(self->retired);
    free(self);
    *cache = NULL;
}

unsigned patch_cache_buffer(const PatchCache *cache) {
    return cache->buffer;
}

size_t patch_cache_capacity(const PatchCache *cache) {
    return vram_capacity(cache->vram);
}

void patch_cache_begin_frame(PatchCache *cache) {
    cache->frame++;
    cache->stats.upload_bytes = cache->stats.evictions = 0;
    if (cache->frame > FRAMES_IN_FLIGHT)
        wait_frame(cache, cache->frame - FRAMES_IN_FLIGHT); // its fence's slot is needed
    poll_frames(cache);
    free_retired(cache);
}

void patch_cache_end_frame(PatchCache *cache) {
    cache->fences[cache->frame % FRAMES_IN_FLIGHT] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    cache->stats.used_bytes = (int64_t)vram_used(cache->vram);
}

void patch_cache_clear(PatchCache *cache) {
    forget_everything(cache, cache->frame);
    cache->last_placed = 0;
    cache->stats = (PatchCacheStats){.used_bytes = (int64_t)vram_used(cache->vram)};
}

PatchCacheStats patch_cache_stats(const PatchCache *cache) {
    return cache->stats;
}
