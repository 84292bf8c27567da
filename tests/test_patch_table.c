// The table of what lies in the patch cache, beside a model: a plain list in order of use, searched from end to end.
#include <inttypes.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cut_support.h"
#include "render/patch_table.h"

#define SEED UINT64_C(99)
#define STEPS 60000
#define MODEL_MAX 3000 // the table has to grow twice

typedef struct Known {
    PatchKey key;
    uint64_t frame;
    uint32_t index;
} Known;

typedef struct Model {
    Known list[MODEL_MAX]; // the oldest first
    int count;
} Model;

// Few enough that pages and lists, and lists of one page, often differ in one member only.
static PatchKey random_key(uint64_t *random) {
    uint64_t page = support_random(random) % 900, revision = support_random(random) % 6;
    return (PatchKey){page << (page % 3 * 20), revision, revision ? PATCH_INDICES : PATCH_PAGE};
}

static bool is_key(PatchKey a, PatchKey b) {
    return a.page_id == b.page_id && a.revision == b.revision && a.kind == b.kind;
}

static int model_find(const Model *model, PatchKey key) {
    for (int i = 0; i < model->count; i++)
        if (is_key(model->list[i].key, key))
            return i;
    return -1;
}

static Known model_take(Model *model, int at) {
    Known taken = model->list[at];
    memmove(&model->list[at], &model->list[at + 1], (size_t)(model->count - at - 1) * sizeof taken);
    model->count--;
    return taken;
}

static void model_put(Model *model, Known known) {
    model->list[model->count++] = known;
}

// Both ways through the order of use.
static void assert_same_order(const PatchTable *table, const Model *model) {
    uint32_t up = table->oldest, down = table->newest;
    for (int i = 0; i < model->count; i++) {
        const Known *known = &model->list[i], *mirrored = &model->list[model->count - 1 - i];
        if (up != known->index || down != mirrored->index)
            fail_msg("place %d of %d: entries %u and %u, expected %u and %u", i, model->count, up, down, known->index,
                     mirrored->index);
        const PatchEntry *entry = &table->entries[up];
        assert_true(is_key(entry->key, known->key));
        assert_true(entry->used_frame == known->frame && entry->region == up); // the region given at first
        up = entry->newer;
        down = table->entries[down].older;
    }
    assert_true(up == PATCH_NONE && down == PATCH_NONE);
}

static void use_key(PatchTable *table, Model *model, PatchKey key, uint64_t frame) {
    int at = model_find(model, key);
    uint32_t index = patch_table_find(table, key);
    if ((at < 0) != (index == PATCH_NONE) || (at >= 0 && index != model->list[at].index))
        fail_msg("frame %" PRIu64 ": entry %u, place %d in the model", frame, index, at);
    if (at >= 0) {
        patch_table_touch(table, index, frame);
        model_take(model, at);
    } else {
        index = patch_table_add(table, key, frame);
        assert_int_not_equal(index, PATCH_NONE);
        assert_true(table->entries[index].region == VRAM_NONE && table->entries[index].latest == PATCH_NONE);
        table->entries[index].region = index;
    }
    model_put(model, (Known){key, frame, index});
}

static void remove_one(PatchTable *table, Model *model, int at) {
    Known taken = model_take(model, at);
    patch_table_remove(table, taken.index);
    assert_int_equal(patch_table_find(table, taken.key), PATCH_NONE);
}

static void keys_are_found_and_stay_in_order_of_use(void **state) {
    (void)state;
    uint64_t random = SEED;
    PatchTable table;
    Model *model = calloc(1, sizeof *model);
    int most = 0;
    print_message("seed %" PRIu64 "\n", SEED);
    assert_non_null(model);
    assert_int_equal(patch_table_create(&table), RESULT_OK);
    for (int step = 0; step < STEPS; step++) {
        uint64_t percent = step / 10000 % 2 ? 60 : 10; // now filling, now draining
        if (model->count == MODEL_MAX || (model->count && support_random(&random) % 100 < percent))
            remove_one(&table, model,
                       support_random(&random) % 2 ? 0 : (int)(support_random(&random) % (uint64_t)model->count));
        else
            use_key(&table, model, random_key(&random), (uint64_t)step + 1);
        most = model->count > most ? model->count : most;
        if (step % 500 == 0)
            assert_same_order(&table, model);
    }
    print_message("%d steps, up to %d entries in %u\n", STEPS, most, table.capacity);
    assert_true(most > 2048); // or it never grew
    assert_true(table.count <= (uint32_t)most);
    while (model->count)
        remove_one(&table, model, model->count - 1);
    assert_same_order(&table, model);
    free(model);
    patch_table_destroy(&table);
    patch_table_destroy(&table);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keys_are_found_and_stay_in_order_of_use),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
