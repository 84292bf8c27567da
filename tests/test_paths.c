// The search order of base/paths.h, seen from folders that the test makes.
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/log.h"
#include "base/paths.h"

typedef struct Heard {
    char text[8192];
} Heard;

static void hear(void *user, LogLevel level, const char *message) {
    Heard *heard = user;
    if (level == LOG_ERROR)
        snprintf(heard->text, sizeof heard->text, "%s", message);
}

static void write_file(const char *path) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("x\n", file);
    assert_int_equal(fclose(file), 0);
}

static void chosen_folder_wins(void **state) {
    (void)state;
    char folder[] = "/tmp/overfly-paths-XXXXXX", file[64], found[PATHS_BYTES_MAX];
    assert_non_null(mkdtemp(folder));
    snprintf(file, sizeof file, "%s/probe.txt", folder);
    write_file(file);
    setenv("OVERFLY_DATA_DIR", folder, 1);
    assert_int_equal(paths_find_data("probe.txt", found), RESULT_OK);
    assert_string_equal(found, file);
    unsetenv("OVERFLY_DATA_DIR");
    unlink(file);
    rmdir(folder);
}

// Data of a folder that was chosen is never mixed with data of the installation.
static void chosen_folder_is_the_only_one(void **state) {
    (void)state;
    char found[PATHS_BYTES_MAX];
    Heard heard = {""};
    log_set_sink(hear, &heard);
    setenv("OVERFLY_DATA_DIR", "/nowhere/at/all", 1);
    assert_int_equal(paths_find_data("scenes", found), RESULT_NOT_FOUND);
    unsetenv("OVERFLY_DATA_DIR");
    log_set_sink(NULL, NULL);
    assert_non_null(strstr(heard.text, "scenes: not found in /nowhere/at/all;"));
}

static void build_tree_finds_its_data(void **state) {
    (void)state;
    char found[PATHS_BYTES_MAX];
    assert_int_equal(paths_find_data("dem/jacksboro_fault.tif", found), RESULT_OK);
    assert_int_equal(access(found, R_OK), 0);
}

static void missing_file_is_named_with_every_place(void **state) {
    (void)state;
    char found[PATHS_BYTES_MAX];
    Heard heard = {""};
    log_set_sink(hear, &heard);
    assert_int_equal(paths_find_data("no-such-file", found), RESULT_NOT_FOUND);
    assert_non_null(strstr(heard.text, "no-such-file: not found in "));
    assert_non_null(strstr(heard.text, "OVERFLY_DATA_DIR"));
    assert_int_equal(paths_find_module("no-such-module.so", found), RESULT_NOT_FOUND);
    log_set_sink(NULL, NULL);
    assert_non_null(strstr(heard.text, "/lib"));
}

static void overlong_names_are_not_found(void **state) {
    (void)state;
    static char name[2 * PATHS_BYTES_MAX], found[PATHS_BYTES_MAX];
    memset(name, 'a', sizeof name - 1);
    Heard heard = {""};
    log_set_sink(hear, &heard);
    assert_int_equal(paths_find_data(name, found), RESULT_NOT_FOUND);
    log_set_sink(NULL, NULL);
}

static void chosen_module_folder_wins(void **state) {
    (void)state;
    char folder[] = "/tmp/overfly-paths-XXXXXX", file[64], found[PATHS_BYTES_MAX];
    assert_non_null(mkdtemp(folder));
    snprintf(file, sizeof file, "%s/probe.so", folder);
    write_file(file);
    setenv("OVERFLY_MODULE_DIR", folder, 1);
    assert_int_equal(paths_find_module("probe.so", found), RESULT_OK);
    assert_string_equal(found, file);
    unsetenv("OVERFLY_MODULE_DIR");
    unlink(file);
    rmdir(folder);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chosen_folder_wins),           cmocka_unit_test(chosen_folder_is_the_only_one),
        cmocka_unit_test(build_tree_finds_its_data),    cmocka_unit_test(missing_file_is_named_with_every_place),
        cmocka_unit_test(overlong_names_are_not_found), cmocka_unit_test(chosen_module_folder_wins),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
