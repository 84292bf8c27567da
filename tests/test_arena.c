// Arenas: aligned, disjoint, and silent towards the system once warm.
#include "base/arena.h"

#include <inttypes.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define PIECES 500
#define BLOCK 4096

static uint64_t random_next(uint64_t *state) { // splitmix64
    uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

static Arena *create(void) {
    Arena *arena = NULL;
    assert_int_equal(arena_create(BLOCK, &arena), RESULT_OK);
    return arena;
}

// Fills every piece with its number and looks at all of them afterwards.
static void fill_pieces(Arena *arena, uint64_t seed, size_t largest) {
    unsigned char *pieces[PIECES];
    size_t sizes[PIECES];
    for (int i = 0; i < PIECES; i++) {
        sizes[i] = (size_t)(random_next(&seed) % largest) + 1;
        pieces[i] = arena_alloc(arena, sizes[i]);
        assert_non_null(pieces[i]);
        assert_int_equal((uintptr_t)pieces[i] % 64, 0);
        memset(pieces[i], i & 0xff, sizes[i]);
    }
    for (int i = 0; i < PIECES; i++)
        for (size_t k = 0; k < sizes[i]; k++)
            assert_int_equal(pieces[i][k], i & 0xff);
}

static void test_pieces_are_aligned_and_apart(void **state) {
    (void)state;
    Arena *arena = create();
    fill_pieces(arena, 5, 300);
    fill_pieces(arena, 6, 3 * BLOCK); // larger than a block, too
    arena_destroy(&arena);
    assert_null(arena);
}

static void test_a_warm_arena_asks_the_system_for_nothing(void **state) {
    (void)state;
    Arena *arena = create();
    for (int frame = 0; frame < 3; frame++) {
        fill_pieces(arena, 7, 2 * BLOCK);
        arena_reset(arena);
    }
    size_t warm = arena_system_allocations(arena), capacity = arena_capacity(arena);
    for (int frame = 0; frame < 100; frame++) {
        fill_pieces(arena, 7, 2 * BLOCK);
        arena_reset(arena);
    }
    print_message("allocations when warm %zu, after 100 frames %zu; capacity %zu and %zu bytes\n", warm,
                  arena_system_allocations(arena), capacity, arena_capacity(arena));
    assert_int_equal(arena_system_allocations(arena), warm);
    assert_int_equal(arena_capacity(arena), capacity);
    arena_destroy(&arena);
}

// Frames of other sizes: never more memory than a few times the largest frame.
static void test_frames_of_changing_size_do_not_pile_up(void **state) {
    (void)state;
    Arena *arena = create();
    uint64_t seed = 8;
    size_t frame_max = 0;
    for (int frame = 0; frame < 2000; frame++) {
        size_t total = 0;
        for (uint64_t pieces = random_next(&seed) % 30; pieces; pieces--) {
            size_t bytes = (size_t)(random_next(&seed) % (4 * BLOCK)) + 1;
            assert_non_null(arena_alloc(arena, bytes));
            total += bytes;
        }
        frame_max = total > frame_max ? total : frame_max;
        arena_reset(arena);
    }
    print_message("largest frame %zu bytes, capacity %zu\n", frame_max, arena_capacity(arena));
    assert_true(arena_capacity(arena) <= 8 * frame_max);
    arena_destroy(&arena);
}

static void test_no_bytes_and_too_many(void **state) {
    (void)state;
    Arena *arena = create();
    void *first = arena_alloc(arena, 0), *second = arena_alloc(arena, 1);
    assert_non_null(second);
    (void)first;
    assert_null(arena_alloc(arena, SIZE_MAX));
    assert_null(arena_alloc(arena, SIZE_MAX - 100));
    assert_non_null(arena_alloc(arena, 100));
    arena_destroy(&arena);
    arena_destroy(&arena);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pieces_are_aligned_and_apart),
        cmocka_unit_test(test_a_warm_arena_asks_the_system_for_nothing),
        cmocka_unit_test(test_frames_of_changing_size_do_not_pile_up),
        cmocka_unit_test(test_no_bytes_and_too_many),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
