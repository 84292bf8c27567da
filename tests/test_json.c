// The reports' JSON: what a number that is none becomes, and what a document of every kind reads as.
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "app/json.h"

// The document without its white space.
static void expect_document(Json *json, const char *expected) {
    char text[1024] = "", bare[1024];
    FILE *file = fmemopen(text, sizeof text, "w");
    assert_non_null(file);
    assert_int_equal(json_write(json, file), RESULT_OK);
    assert_int_equal(fclose(file), 0);
    size_t kept = 0;
    for (const char *at = text; *at; at++)
        if (!strchr(" \t\n", *at))
            bare[kept++] = *at;
    bare[kept] = '\0';
    assert_string_equal(bare, expected);
    json_destroy(&json);
}

static void numbers_that_are_not_finite_are_null(void **state) {
    (void)state;
    const double values[] = {1.5, NAN, INFINITY};
    Json *json = json_create();
    json_add_number(json, "a", 0.25);
    json_add_number(json, "b", NAN);
    json_add_number(json, "c", INFINITY);
    json_add_number(json, "d", -INFINITY);
    json_add_numbers(json, "e", values, 3);
    expect_document(json, "{\"a\":0.25,\"b\":null,\"c\":null,\"d\":null,\"e\":[1.5,null,null]}");
}

static void integers_keep_all_their_digits(void **state) {
    (void)state;
    Json *json = json_create();
    json_add_integer(json, "most", INT64_MAX);
    json_add_integer(json, "least", INT64_MIN);
    expect_document(json, "{\"most\":9223372036854775807,\"least\":-9223372036854775808}");
}

static void no_text_is_null_and_text_is_escaped(void **state) {
    (void)state;
    Json *json = json_create(), *list = json_add_array(json, "list");
    json_add_text(json, "none", NULL);
    json_add_text(json, "some", "a\"b\\c");
    json_append_text(list, "x");
    json_add_bool(json_append_object(list), "yes", true);
    expect_document(json, "{\"list\":[\"x\",{\"yes\":true}],\"none\":null,\"some\":\"a\\\"b\\\\c\"}");
}

static void without_a_parent_nothing_is_added(void **state) {
    (void)state;
    assert_null(json_add_object(NULL, "a"));
    json_add_number(NULL, "a", NAN);
    json_append_number(NULL, 1.0);
    Json *json = json_create();
    expect_document(json, "{}");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_that_are_not_finite_are_null),
        cmocka_unit_test(integers_keep_all_their_digits),
        cmocka_unit_test(no_text_is_null_and_text_is_escaped),
        cmocka_unit_test(without_a_parent_nothing_is_added),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
