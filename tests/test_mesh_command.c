// `overfly mesh` from outside: its JSON, its files, its exit status.
#define _POSIX_C_SOURCE 200809L
#include "base/base.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#define OUTPUT_BYTES 16384

typedef struct Run {
    int status;
    char out[OUTPUT_BYTES]; // stdout
    char err[OUTPUT_BYTES];
} Run;

static void read_text(FILE *file, char *to) {
    size_t length = fread(to, 1, OUTPUT_BYTES - 1, file);
    to[length] = 0;
}

static Run run(const char *arguments) {
    static const char ERRORS[] = "mesh_command_errors.txt";
    char command[2048];
    Run r;
    snprintf(command, sizeof command, "%s %s 2> %s", OVERFLY_PROGRAM, arguments, ERRORS);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    read_text(pipe, r.out);
    int status = pclose(pipe);
    r.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    FILE *errors = fopen(ERRORS, "r");
    assert_non_null(errors);
    read_text(errors, r.err);
    fclose(errors);
    unlink(ERRORS);
    print_message("overfly %s: %d\n%s", arguments, r.status, r.err);
    return r;
}

static double number(const char *json, const char *name) {
    char key[64];
    snprintf(key, sizeof key, "\"%s\":", name);
    const char *at = strstr(json, key);
    if (!at)
        fail_msg("no %s in %s", key, json);
    return strtod(at + strlen(key), NULL);
}

static bool has_text(const char *path, const char *text) {
    char bytes[1024];
    FILE *file = fopen(path, "rb");
    if (!file)
        return false;
    size_t length = fread(bytes, 1, sizeof bytes - 1, file);
    bytes[length] = 0;
    fclose(file);
    return strstr(bytes, text) != NULL;
}

static void assert_one_document(const Run *r) {
    size_t length = strlen(r->out);
    assert_int_equal(r->status, 0);
    assert_true(length > 2 && r->out[0] == '{' && strcmp(r->out + length - 2, "}\n") == 0);
}

static void test_json_has_the_contract_fields_and_agrees_with_the_file(void **state) {
    (void)state;
    static const char *const FIELDS[] = {"tau_px",    "triangles", "vertices",        "patches",
                                         "refine_ms", "max_px",    "p999_px",         "p99_px",
                                         "rms_px",    "holes",     "above_tau_share", "t_junctions"};
    Run r = run("mesh --eye 36.58,-84.25,900 --tau 2 --json -o mesh_command.ply");
    assert_one_document(&r);
    for (size_t i = 0; i < COUNT_OF(FIELDS); i++)
        assert_true(number(r.out, FIELDS[i]) >= 0.0);
    assert_non_null(strstr(r.out, "\"method\":\t\"hybrid\""));
    assert_true(number(r.out, "tau_px") == 2.0 && number(r.out, "reached_px") == 2.0);
    assert_true(number(r.out, "max_px") <= 2.0 && number(r.out, "max_px") > 0.0);
    assert_true(number(r.out, "holes") == 0.0 && number(r.out, "t_junctions") == 0.0);
    char expected[64];
    snprintf(expected, sizeof expected, "element vertex %.0f\n", number(r.out, "vertices"));
    assert_true(has_text("mesh_command.ply", expected));
    snprintf(expected, sizeof expected, "element face %.0f\n", number(r.out, "triangles"));
    assert_true(has_text("mesh_command.ply", expected));
    unlink("mesh_command.ply");
}

static void test_a_finer_tolerance_takes_more_triangles_and_brute_takes_all(void **state) {
    (void)state;
    Run coarse = run("mesh --tau 4 --json"), fine = run("mesh --tau 0.5 --json"), all = run("mesh -m brute --json");
    assert_one_document(&coarse);
    assert_one_document(&fine);
    assert_one_document(&all);
    assert_true(number(coarse.out, "triangles") < number(fine.out, "triangles"));
    assert_true(number(fine.out, "triangles") < number(all.out, "triangles"));
    assert_true(number(all.out, "triangles") == 2.0 * (344 - 1) * (403 - 1)); // the default scene's samples
    assert_true(number(all.out, "max_px") < 0.01);
}

static void test_culling_leaves_what_is_in_view(void **state) {
    (void)state;
    Run whole = run("mesh --eye 36.5,-84.2,1500 --look 0,-10 --json");
    Run culled = run("mesh --eye 36.5,-84.2,1500 --look 0,-10 --cull --json -o mesh_command.glb");
    assert_one_document(&whole);
    assert_one_document(&culled);
    assert_true(number(culled.out, "triangles") < number(whole.out, "triangles"));
    assert_true(number(culled.out, "triangles") > 0.0);
    assert_true(has_text("mesh_command.glb", "glTF"));
    unlink("mesh_command.glb");
    Run away = run("mesh --eye 36.0,-84.2,1500 --look 180,0 --cull --json -o mesh_command.obj");
    assert_true(number(away.out, "triangles") == 0.0);
    assert_true(has_text("mesh_command.obj", "# 0 vertices"));
    unlink("mesh_command.obj");
}

static void check_failure(const char *arguments, int status, const char *named) {
    Run r = run(arguments);
    assert_int_equal(r.status, status);
    assert_string_equal(r.out, "");
    assert_non_null(strstr(r.err, named));
}

static void test_failures_have_a_status_and_a_cause(void **state) {
    (void)state;
    check_failure("mesh -o mesh_command.stl --json", 2, "mesh_command.stl");
    check_failure("mesh --method hybrd --json", 2, "hybrid");
    check_failure("mesh --tau nan --json", 2, "tau");
    check_failure("mesh --tau -1 --json", 2, "tau");
    check_failure("mesh --eye 36.5 --json", 2, "eye");
    check_failure("mesh no-such-file.tif --json", 1, "no-such-file.tif");
    check_failure("mesh --json -o no-such-folder/a.ply", 1, "no-such-folder/a.ply");
    if (access("/dev/full", W_OK) == 0 && symlink("/dev/full", "mesh_command_full.ply") == 0) {
        check_failure("mesh --json -o mesh_command_full.ply", 1, "mesh_command_full.ply");
        unlink("mesh_command_full.ply");
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_json_has_the_contract_fields_and_agrees_with_the_file),
        cmocka_unit_test(test_a_finer_tolerance_takes_more_triangles_and_brute_takes_all),
        cmocka_unit_test(test_culling_leaves_what_is_in_view),
        cmocka_unit_test(test_failures_have_a_status_and_a_cause),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
