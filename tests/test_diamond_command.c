// `overfly mesh --select` from outside: what it implies, what it reports, and how it refuses.
#define _POSIX_C_SOURCE 200809L
#include "base/base.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include <cmocka.h>

typedef struct Run {
    int status;
    char text[16384]; // stdout, or stdout and stderr
} Run;

static Run run(const char *arguments, const char *errors) {
    char command[1024];
    Run r = {0};
    snprintf(command, sizeof command, "%s mesh %s 2>%s", OVERFLY_PROGRAM, arguments, errors);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    r.text[fread(r.text, 1, sizeof r.text - 1, pipe)] = 0;
    int status = pclose(pipe);
    r.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    print_message("overfly mesh %s: %d\n", arguments, r.status);
    return r;
}

static void expect_text(const Run *r, const char *text) {
    if (!strstr(r->text, text))
        fail_msg("no '%s' in %s", text, r->text);
}

static double number(const Run *r, const char *name) {
    char key[64];
    snprintf(key, sizeof key, "\"%s\":", name);
    expect_text(r, key);
    return strtod(strstr(r->text, key) + strlen(key), NULL);
}

static void test_a_selection_makes_the_method_diamond_and_is_reported(void **state) {
    (void)state;
    Run r = run("--json --select 'error > 5 || within(36.6, -84.2, 2000)'", "/dev/null");
    assert_int_equal(r.status, 0);
    expect_text(&r, "\"method\":\t\"diamond\"");
    expect_text(&r, "\"select\":\t\"error > 5 || within(36.6, -84.2, 2000)\"");
    expect_text(&r, "\"promised\":\tfalse");
    assert_true(number(&r, "chosen") > 0.0 && number(&r, "closed") > number(&r, "chosen"));
    assert_true(number(&r, "holes") == 0.0 && number(&r, "t_junctions") == 0.0 && number(&r, "overlaps") == 0.0);
}

static void test_a_selection_with_the_tolerance_in_it_keeps_tau(void **state) {
    (void)state;
    Run alone = run("--json --tau 3 --method diamond", "/dev/null");
    Run more =
        run("--json --tau 3 --method diamond --select 'tolerance || box(-84.3, 36.5, -84.2, 36.6)'", "/dev/null");
    assert_int_equal(alone.status, 0);
    assert_int_equal(more.status, 0);
    expect_text(&more, "\"promised\":\ttrue");
    assert_true(number(&more, "max_px") <= 3.0);
    assert_true(number(&more, "triangles") > number(&alone, "triangles"));
}

static void test_what_is_in_view_is_fine_and_the_rest_is_coarse(void **state) {
    (void)state;
    Run whole = run("--json --look 0,-10 --select 'tolerance'", "/dev/null");
    Run seen = run("--json --look 0,-10 --select 'tolerance && inview'", "/dev/null");
    Run culled = run("--json --look 0,-10 --cull --select 'tolerance && inview'", "/dev/null");
    assert_int_equal(seen.status, 0);
    assert_true(number(&seen, "triangles") < 0.9 * number(&whole, "triangles"));
    assert_true(number(&culled, "triangles") > 0.5 * number(&seen, "triangles"));
}

static void check_refusal(const char *arguments, int status, const char *named) {
    Run r = run(arguments, "&1");
    if (r.status != status)
        fail_msg("%s: status %d, expected %d", arguments, r.status, status);
    expect_text(&r, named);
}

static void test_refusals_have_a_status_and_a_remedy(void **state) {
    (void)state;
    check_refusal("--json --method hybrid --select 'error > 5'", 2, "--method diamond");
    check_refusal("--json --select 'errr > 5'", 2, "character 1: expected");
    check_refusal("--json --select 'error > 5 ||'", 2, "character 13");
    check_refusal("--json --select ''", 2, "--select");
    check_refusal("--json --max-triangles 5000 --select 'step >= 1'", 1, "--max-triangles");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_selection_makes_the_method_diamond_and_is_reported),
        cmocka_unit_test(test_a_selection_with_the_tolerance_in_it_keeps_tau),
        cmocka_unit_test(test_what_is_in_view_is_fine_and_the_rest_is_coarse),
        cmocka_unit_test(test_refusals_have_a_status_and_a_remedy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
