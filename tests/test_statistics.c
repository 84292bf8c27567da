// Order statistics against tables and against counting.
#include "base/statistics.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static void test_percentiles_are_of_the_nearest_rank(void **state) {
    (void)state;
    const double values[] = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0};
    assert_true(statistics_percentile(values, 10, 0.5) == 5.0);
    assert_true(statistics_percentile(values, 10, 0.95) == 10.0);
    assert_true(statistics_percentile(values, 10, 0.9) == 9.0);
    assert_true(statistics_percentile(values, 10, 0.0) == 1.0);
    assert_true(statistics_percentile(values, 0, 0.5) == 0.0);
}

// Ranks of the two-sided 95 % bounds of a median, as tables of the sign test have them (W. J. Conover, Practical
// Nonparametric Statistics, table A3: binomial with p = 1/2).
static void test_bounds_of_a_median_are_those_of_the_sign_test(void **state) {
    (void)state;
    static const struct {
        int count, low, high;
    } TABLE[] = {{6, 1, 6},   {8, 1, 8},   {9, 2, 8},    {10, 2, 9},   {12, 3, 10},
                 {16, 4, 13}, {20, 6, 15}, {30, 10, 21}, {50, 18, 33}, {100, 40, 61}};
    double ranks[100], low, high;
    for (int i = 0; i < 100; i++)
        ranks[i] = i + 1.0;
    for (size_t i = 0; i < COUNT_OF(TABLE); i++) {
        statistics_median_bounds(ranks, TABLE[i].count, &low, &high);
        if (low != TABLE[i].low || high != TABLE[i].high)
            fail_msg("%d values: ranks %g to %g, expected %d to %d", TABLE[i].count, low, high, TABLE[i].low,
                     TABLE[i].high);
    }
    statistics_median_bounds(ranks, 3, &low, &high);
    assert_true(low == 1.0 && high == 3.0);
    statistics_median_bounds(ranks, 0, &low, &high);
    assert_true(low == 0.0 && high == 0.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_percentiles_are_of_the_nearest_rank),
        cmocka_unit_test(test_bounds_of_a_median_are_those_of_the_sign_test),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
