// Numbers with units as people type them. The expected values are the units' legal definitions.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>

#include "config/quantity.h"

typedef struct Case {
    QuantityKind kind;
    const char *text;
    double value;
} Case;

static void units_are_converted(void **state) {
    (void)state;
    static const Case cases[] = {
        {QUANTITY_LENGTH, "1500", 1500.0},    {QUANTITY_LENGTH, "1500m", 1500.0},
        {QUANTITY_LENGTH, "5000ft", 1524.0},  {QUANTITY_LENGTH, "2 nmi", 3704.0},
        {QUANTITY_LENGTH, "1mi", 1609.344},   {QUANTITY_LENGTH, " -1.5km ", -1500.0},
        {QUANTITY_SPEED, "120kt", 61.733333}, {QUANTITY_SPEED, "36km/h", 10.0},
        {QUANTITY_SPEED, "80", 80.0},         {QUANTITY_SPEED, "100mph", 44.704},
        {QUANTITY_SPEED, "10ft/s", 3.048},    {QUANTITY_SPEED, "7M/S", 7.0},
        {QUANTITY_ANGLE, "90", 90.0},         {QUANTITY_ANGLE, "1rad", 57.29578},
        {QUANTITY_ANGLE, "-12deg", -12.0},    {QUANTITY_BYTES, "512M", 536870912},
        {QUANTITY_BYTES, "1GiB", 1 << 30},    {QUANTITY_BYTES, "4096", 4096.0},
        {QUANTITY_PLAIN, "1e3", 1000.0},      {QUANTITY_PLAIN, ".5", 0.5},
        {QUANTITY_PLAIN, "+2", 2.0},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        double found = NAN;
        Result result = quantity_parse(cases[i].kind, cases[i].text, &found);
        if (result != RESULT_OK || fabs(found - cases[i].value) > 1e-5 * fmax(1.0, fabs(cases[i].value)))
            fail_msg("'%s': %s, %.9g; expected %.9g", cases[i].text, result_name(result), found, cases[i].value);
    }
}

static void other_texts_are_refused(void **state) {
    (void)state;
    static const Case cases[] = {
        {QUANTITY_LENGTH, "", 0},
        {QUANTITY_LENGTH, "m", 0},
        {QUANTITY_LENGTH, "10kt", 0},
        {QUANTITY_LENGTH, "0x10", 0},
        {QUANTITY_LENGTH, "inf", 0},
        {QUANTITY_LENGTH, "nan", 0},
        {QUANTITY_LENGTH, "1e999", 0},
        {QUANTITY_LENGTH, "5 5", 0},
        {QUANTITY_LENGTH, "5mm", 0},
        {QUANTITY_PLAIN, "1m", 0},
        {QUANTITY_PLAIN, "-", 0},
        {QUANTITY_PLAIN, "--1", 0},
        {QUANTITY_PLAIN, "1,2", 0},
        {QUANTITY_BYTES, "1T", 0},
        {QUANTITY_SPEED, "fast", 0},
        {QUANTITY_PLAIN, "11111111111111111111111111111111111111111111111111111111111111111111111111", 0},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        double found = NAN;
        Result result = quantity_parse(cases[i].kind, cases[i].text, &found);
        if (result != RESULT_USAGE)
            fail_msg("'%s': %s, %.9g; expected USAGE", cases[i].text, result_name(result), found);
    }
}

static void lists_have_exactly_their_length(void **state) {
    (void)state;
    static const QuantityKind kinds[3] = {QUANTITY_ANGLE, QUANTITY_ANGLE, QUANTITY_LENGTH};
    double found[3];
    assert_int_equal(quantity_parse_list(kinds, 3, "36.5,-84.2,5000ft", found), RESULT_OK);
    assert_true(found[0] == 36.5 && found[1] == -84.2 && fabs(found[2] - 1524.0) < 1e-9);
    static const char *const wrong[] = {"36.5,-84.2", "36.5,-84.2,1,2", "36.5,,1", ",,", "", "1,2,3,"};
    for (size_t i = 0; i < COUNT_OF(wrong); i++)
        if (quantity_parse_list(kinds, 3, wrong[i], found) != RESULT_USAGE)
            fail_msg("'%s' was taken for three quantities", wrong[i]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(units_are_converted),
        cmocka_unit_test(other_texts_are_refused),
        cmocka_unit_test(lists_have_exactly_their_length),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
