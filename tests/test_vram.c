// The bookkeeping of the patch cache's buffer, beside a model that keeps a plain map of who has which byte.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "render/vram.h"

#define GRANULES 1000 // no power of two
#define STEPS 200000
#define REGIONS_MAX 400

typedef struct Model {
    uint16_t owner[GRANULES]; // 0: free
    VramRegion regions[REGIONS_MAX];
    uint16_t names[REGIONS_MAX];
    size_t lengths[REGIONS_MAX]; // granules asked for
    int count;
    uint16_t next_name;
} Model;

static uint64_t next_random(uint64_t *state) {
    *state += 0x9e3779b97f4a7c15ull;
    uint64_t x = *state;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ x >> 27) * 0x94d049bb133111ebull;
    return x ^ x >> 31;
}

static size_t longest_free_run(const Model *model) {
    size_t longest = 0, run = 0;
    for (int i = 0; i < GRANULES; i++) {
        run = model->owner[i] ? 0 : run + 1;
        longest = run > longest ? run : longest;
    }
    return longest;
}

static size_t count_used(const Model *model) {
    size_t used = 0;
    for (int i = 0; i < GRANULES; i++)
        used += model->owner[i] != 0;
    return used;
}

// The region lies inside the buffer, is as long as asked, and belongs to nobody else.
static void claim(Model *model, const Vram *vram, VramRegion region, size_t bytes) {
    size_t offset = vram_offset(vram, region), length = (bytes + VRAM_GRANULE - 1) / VRAM_GRANULE;
    assert_int_equal(offset % VRAM_GRANULE, 0);
    assert_int_equal(vram_size(vram, region), length * VRAM_GRANULE);
    assert_true(offset / VRAM_GRANULE + length <= GRANULES);
    model->next_name = model->next_name == UINT16_MAX ? 1 : model->next_name + 1;
    for (size_t i = 0; i < length; i++) {
        assert_int_equal(model->owner[offset / VRAM_GRANULE + i], 0);
        model->owner[offset / VRAM_GRANULE + i] = model->next_name;
    }
    model->regions[model->count] = region;
    model->names[model->count] = model->next_name;
    model->lengths[model->count] = length;
    model->count++;
}

static void release(Model *model, Vram *vram, int index) {
    size_t begin = vram_offset(vram, model->regions[index]) / VRAM_GRANULE;
    for (size_t i = 0; i < model->lengths[index]; i++) {
        assert_int_equal(model->owner[begin + i], model->names[index]);
        model->owner[begin + i] = 0;
    }
    vram_free(vram, model->regions[index]);
    model->count--;
    model->regions[index] = model->regions[model->count];
    model->names[index] = model->names[model->count];
    model->lengths[index] = model->lengths[model->count];
}

static size_t random_bytes(uint64_t *seed) {
    uint64_t kind = next_random(seed) % 8;
    size_t granules = kind < 5 ? next_random(seed) % 12 : kind < 7 ? next_random(seed) % 100 : next_random(seed) % 700;
    return granules * VRAM_GRANULE + 1 + next_random(seed) % VRAM_GRANULE;
}

static void try_alloc(Model *model, Vram *vram, uint64_t *seed, int *refused) {
    size_t bytes = random_bytes(seed), length = (bytes + VRAM_GRANULE - 1) / VRAM_GRANULE;
    VramRegion region = vram_alloc(vram, bytes);
    if (region != VRAM_NONE) {
        claim(model, vram, region, bytes);
        return;
    }
    (*refused)++;
    size_t longest = longest_free_run(model);
    if (longest >= length)
        fail_msg("refused %zu granules with %zu free in a row", length, longest);
}

static void regions_never_overlap_and_fill_every_gap(void **state) {
    (void)state;
    uint64_t seed = 20260101;
    print_message("seed %llu\n", (unsigned long long)seed);
    Vram *vram = NULL;
    Model *model = calloc(1, sizeof *model);
    assert_non_null(model);
    assert_int_equal(vram_create(GRANULES * VRAM_GRANULE, &vram), RESULT_OK);
    int refused = 0;
    for (int step = 0; step < STEPS; step++) {
        // Waves: now filling, now draining.
        bool filling = next_random(&seed) % 100 < (step / 2000 % 2 ? 40u : 60u);
        if (model->count < REGIONS_MAX && (filling || model->count == 0))
            try_alloc(model, vram, &seed, &refused);
        else
            release(model, vram, (int)(next_random(&seed) % (uint64_t)model->count));
        if (step % 64 == 0)
            assert_int_equal(vram_used(vram), count_used(model) * VRAM_GRANULE);
    }
    print_message("%d steps, %d refusals, all of them for want of a run\n", STEPS, refused);
    assert_true(refused > 100);
    while (model->count)
        release(model, vram, 0);
    assert_int_equal(vram_used(vram), 0);
    VramRegion whole = vram_alloc(vram, GRANULES * VRAM_GRANULE);
    assert_int_not_equal(whole, VRAM_NONE);
    vram_destroy(&vram);
    free(model);
}

static void sizes_at_the_limits(void **state) {
    (void)state;
    Vram *vram = NULL;
    assert_int_equal(vram_create(VRAM_GRANULE - 1, &vram), RESULT_RANGE);
    assert_int_equal(vram_create(VRAM_GRANULE * 3 + 5, &vram), RESULT_OK);
    assert_int_equal(vram_capacity(vram), VRAM_GRANULE * 3);
    assert_int_equal(vram_alloc(vram, VRAM_GRANULE * 3 + 1), VRAM_NONE);
    VramRegion whole = vram_alloc(vram, VRAM_GRANULE * 3);
    assert_int_not_equal(whole, VRAM_NONE);
    assert_int_equal(vram_alloc(vram, 1), VRAM_NONE);
    vram_free(vram, whole);
    assert_int_not_equal(vram_alloc(vram, 1), VRAM_NONE);
    vram_destroy(&vram);
    assert_null(vram);
    vram_destroy(&vram);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(regions_never_overlap_and_fill_every_gap),
        cmocka_unit_test(sizes_at_the_limits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
