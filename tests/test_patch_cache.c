// Pages and index lists in the patch cache: what lies in the buffer is what was asked for, nothing is sent twice, and
// memory that runs out is said and survived.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "render/gl.h"
#include "render/patch_cache.h"
#include "render/vram.h"
#include "tests/gl_support.h"

#define CACHE_BYTES ((size_t)4 << 20)
#define PAGES 400
#define DRAWN_MAX 120
#define FRAMES 300

// A page whose vertices, and index lists whose entries, follow from their names.
typedef struct Source {
    LodPage page;
    LodVertex *vertices;
    uint16_t *indices;
    LodItem item;
} Source;

static uint64_t next_random(uint64_t *state) {
    *state = *state * 6364136223846793005ull + 1442695040888963407ull;
    return *state >> 33;
}

static void fill_indices(Source *source, uint64_t revision, int count) {
    source->indices = realloc(source->indices, (size_t)count * sizeof *source->indices);
    assert_non_null(source->indices);
    for (int i = 0; i < count; i++)
        source->indices[i] = (uint16_t)(revision * 31 + (uint64_t)i);
    source->item = (LodItem){
        .page = &source->page, .revision = revision, .indices = source->indices, .index_count = count, .level = 3};
}

static void make_source(Source *source, uint64_t id, int vertex_count, int index_count) {
    memset(source, 0, sizeof *source);
    source->vertices = malloc((size_t)vertex_count * sizeof *source->vertices);
    assert_non_null(source->vertices);
    for (int i = 0; i < vertex_count; i++)
        source->vertices[i] = (LodVertex){(int32_t)id, i, -i, (uint16_t)(i % 33), (uint16_t)(i / 33)};
    source->page = (LodPage){.id = id, .vertex_count = vertex_count, .vertices = source->vertices};
    fill_indices(source, 1, index_count);
}

static void free_source(Source *source) {
    free(source->vertices);
    free(source->indices);
}

static bool same_bytes(const PatchCache *cache, size_t offset, const void *expected, size_t bytes) {
    void *found = malloc(bytes);
    assert_non_null(found);
    glGetNamedBufferSubData(patch_cache_buffer(cache), (GLintptr)offset, (GLsizeiptr)bytes, found);
    bool same = memcmp(found, expected, bytes) == 0;
    free(found);
    return same;
}

static bool in_place(const PatchCache *cache, const LodItem *item, const PatchPlace *place) {
    return same_bytes(cache, (size_t)place->base_vertex * sizeof(LodVertex), item->page->vertices,
                      (size_t)item->page->vertex_count * sizeof(LodVertex)) &&
           same_bytes(cache, (size_t)place->first_index * sizeof(uint16_t), item->indices,
                      (size_t)item->index_count * sizeof(uint16_t));
}

static void place_frame(PatchCache *cache, const LodItem *items, int count, PatchPlace *places) {
    patch_cache_begin_frame(cache);
    assert_int_equal(patch_cache_place(cache, items, count, places), RESULT_OK);
    patch_cache_end_frame(cache);
}

static void what_is_drawn_is_what_was_given(void **state) {
    (void)state;
    uint64_t seed = 7;
    print_message("seed %llu\n", (unsigned long long)seed);
    PatchCache *cache = NULL;
    assert_int_equal(patch_cache_create(CACHE_BYTES, &cache), RESULT_OK);
    Source *sources = calloc(PAGES, sizeof *sources);
    assert_non_null(sources);
    for (int i = 0; i < PAGES; i++)
        make_source(&sources[i], (uint64_t)i + 1, 200 + (int)(next_random(&seed) % 2000), 600);
    LodItem items[DRAWN_MAX];
    PatchPlace places[DRAWN_MAX];
    int64_t evictions = 0;
    for (int frame = 0; frame < FRAMES; frame++) {
        int first = (int)(next_random(&seed) % (PAGES - DRAWN_MAX)), count = 0;
        first = frame % 5 ? first / 8 : first; // mostly near the last one
        for (int i = 0; i < DRAWN_MAX && patch_cache_bytes_needed(items, count) < CACHE_BYTES * 9 / 10; i++) {
            Source *source = &sources[first + i];
            if (next_random(&seed) % 6 == 0)
                fill_indices(source, source->item.revision + 1, 3 + (int)(next_random(&seed) % 4000));
            items[count++] = source->item;
        }
        count -= patch_cache_bytes_needed(items, count) > CACHE_BYTES;
        place_frame(cache, items, count, places);
        evictions += patch_cache_stats(cache).evictions;
        for (int i = 0; i < count; i++)
            if (!in_place(cache, &items[i], &places[i]))
                fail_msg("frame %d, item %d: the buffer holds something else", frame, i);
    }
    print_message("%d frames, %lld evictions\n", FRAMES, (long long)evictions);
    assert_true(evictions > 100);
    for (int i = 0; i < PAGES; i++)
        free_source(&sources[i]);
    free(sources);
    patch_cache_destroy(&cache);
}

static void only_what_changed_is_sent(void **state) {
    (void)state;
    PatchCache *cache = NULL;
    Source a, b;
    assert_int_equal(patch_cache_create(CACHE_BYTES, &cache), RESULT_OK);
    make_source(&a, 1, 1000, 300);
    make_source(&b, 2, 500, 90);
    LodItem items[2] = {a.item, b.item};
    PatchPlace places[2];
    place_frame(cache, items, 2, places);
    assert_int_equal(patch_cache_stats(cache).upload_bytes, 1500 * 16 + 390 * 2);
    assert_true(places[0].page_uploaded && places[1].page_uploaded);
    place_frame(cache, items, 2, places);
    assert_int_equal(patch_cache_stats(cache).upload_bytes, 0);
    assert_false(places[0].page_uploaded);
    fill_indices(&b, 2, 120);
    items[1] = b.item;
    place_frame(cache, items, 2, places);
    assert_int_equal(patch_cache_stats(cache).upload_bytes, 240);
    place_frame(cache, items, 1, places); // b is out of sight, and comes back
    place_frame(cache, items, 2, places);
    assert_int_equal(patch_cache_stats(cache).upload_bytes, 0);
    assert_true(in_place(cache, &items[1], &places[1]));
    free_source(&a);
    free_source(&b);
    patch_cache_destroy(&cache);
}

// 10^4 retriangulations of one patch: the lists that went out of use give their memory back.
static void former_index_lists_are_forgotten(void **state) {
    (void)state;
    PatchCache *cache = NULL;
    Source source;
    PatchPlace place;
    assert_int_equal(patch_cache_create(CACHE_BYTES, &cache), RESULT_OK);
    make_source(&source, 1, 1000, 3000);
    int64_t evictions = 0;
    for (uint64_t revision = 2; revision < 10000; revision++) {
        fill_indices(&source, revision, 3000);
        place_frame(cache, &source.item, 1, &place);
        evictions += patch_cache_stats(cache).evictions;
    }
    int64_t used = patch_cache_stats(cache).used_bytes;
    print_message("%lld bytes in use, %lld evictions\n", (long long)used, (long long)evictions);
    assert_int_equal(evictions, 0);
    assert_true(used < 16000 + 10 * 6016);
    free_source(&source);
    patch_cache_destroy(&cache);
}

static void too_much_is_refused_and_the_last_stays(void **state) {
    (void)state;
    PatchCache *cache = NULL;
    Source small, large[6];
    LodItem items[6];
    PatchPlace place, places[6];
    assert_int_equal(patch_cache_create(CACHE_BYTES, &cache), RESULT_OK);
    make_source(&small, 1, 1000, 300);
    for (int i = 0; i < 6; i++) {
        make_source(&large[i], (uint64_t)i + 2, 65536, 3);
        items[i] = large[i].item;
    }
    place_frame(cache, &small.item, 1, &place);
    for (int frame = 0; frame < 10; frame++) {
        patch_cache_begin_frame(cache);
        assert_int_equal(patch_cache_place(cache, items, 6, places), RESULT_BUDGET);
        patch_cache_keep_last(cache);
        patch_cache_end_frame(cache);
    }
    assert_true(in_place(cache, &small.item, &place));
    // What fits alone, though not beside what was there, is placed.
    place_frame(cache, items, 3, places);
    for (int i = 0; i < 3; i++)
        assert_true(in_place(cache, &items[i], &places[i]));
    free_source(&small);
    for (int i = 0; i < 6; i++)
        free_source(&large[i]);
    patch_cache_destroy(&cache);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_drawn_is_what_was_given),
        cmocka_unit_test(only_what_changed_is_sent),
        cmocka_unit_test(former_index_lists_are_forgotten),
        cmocka_unit_test(too_much_is_refused_and_the_last_stays),
    };
    Context *context = NULL;
    if (!gl_support_begin(16, 16, &context))
        return GL_SKIP_STATUS;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    context_destroy(&context);
    return failed;
}
