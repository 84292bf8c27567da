// What people are told of folders that cannot be made or written to.
#define _DEFAULT_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "config/files.h"
#include "config/named_files.h"
#include "tests/heard.h"

#define SOMEBODY 65534 // no user of this number owns anything

typedef struct Place {
    char folder[PATHS_BYTES_MAX], file[PATHS_BYTES_MAX], inner[PATHS_BYTES_MAX];
} Place;

static Place make_place(void) {
    Place place = {.folder = "/tmp/overfly-XXXXXX"};
    assert_non_null(mkdtemp(place.folder));
    snprintf(place.file, sizeof place.file, "%.200s/file", place.folder);
    snprintf(place.inner, sizeof place.inner, "%.200s/inner", place.folder);
    FILE *file = fopen(place.file, "w");
    assert_non_null(file);
    fclose(file);
    return place;
}

static void remove_place(const Place *place) {
    unlink(place->file);
    rmdir(place->inner);
    rmdir(place->folder);
}

static void check_refused(Result (*ask)(const char *), const char *path, Result wanted, const char *said) {
    Heard heard;
    heard_begin(&heard);
    Result result = ask(path);
    heard_end();
    print_message("%s: %s: %s", path, result_text(result), heard.text);
    assert_int_equal(result, wanted);
    assert_int_equal(heard.errors, 1);
    assert_non_null(strstr(heard.text, said));
}

static void a_file_is_told_from_a_folder(void **state) {
    (void)state;
    Place place = make_place();
    check_refused(files_make_folder, place.file, RESULT_IO, "/file: is a file, not a folder");
    check_refused(files_check_folder, place.file, RESULT_IO, "/file: is a file, not a folder");
    check_refused(files_check_folder, place.inner, RESULT_NOT_FOUND, "mkdir -p");
    assert_int_equal(files_make_folder(place.inner), RESULT_OK);
    assert_int_equal(files_make_folder(place.inner), RESULT_OK);
    assert_int_equal(files_check_folder(place.inner), RESULT_OK);
    remove_place(&place);
}

static void a_file_to_be_made_is_asked_for_by_its_folder(void **state) {
    (void)state;
    Place place = make_place();
    char deep[PATHS_BYTES_MAX], below_file[PATHS_BYTES_MAX];
    snprintf(deep, sizeof deep, "%.200s/x.png", place.inner);
    snprintf(below_file, sizeof below_file, "%.200s/x.png", place.file);
    check_refused(files_check_folder_of, deep, RESULT_NOT_FOUND, "/inner: not a folder");
    check_refused(files_check_folder_of, below_file, RESULT_IO, "/file: is a file, not a folder");
    assert_int_equal(files_check_folder_of(place.inner), RESULT_OK);
    assert_int_equal(files_check_folder_of("x.png"), RESULT_OK);
    check_refused(files_check_folder_of, "/proc/x.png", RESULT_IO, "/proc: no file");
    remove_place(&place);
}

// As somebody who may not write there, which root always may. 0: all was said as it should be.
static int ask_as_somebody(const Place *place) {
    Heard heard;
    if (geteuid() == 0 && setuid(SOMEBODY) != 0)
        return 1;
    heard_begin(&heard);
    bool refused = files_make_folder(place->inner) == RESULT_IO && files_check_folder(place->folder) == RESULT_IO;
    heard_end();
    print_message("%s", heard.text);
    return refused && heard.errors == 2 && strstr(heard.text, "/inner: the folder cannot be made: Permission denied") &&
                   strstr(heard.text, "no file can be made in it: Permission denied")
               ? 0
               : 2;
}

static void the_true_cause_is_told(void **state) {
    (void)state;
    Place place = make_place();
    assert_int_equal(chmod(place.folder, 0555), 0);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0)
        _exit(ask_as_somebody(&place));
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    assert_int_equal(chmod(place.folder, 0755), 0);
    remove_place(&place);
}

static void make_file(const char *folder, const char *name) {
    char path[PATHS_BYTES_MAX];
    snprintf(path, sizeof path, "%.200s/%s", folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fclose(file);
}

// Those of the kind alone, in order, and no more than there is room for.
static void files_are_listed_by_name(void **state) {
    (void)state;
    static const NamedFileKind kind = {"aircraft", ".aircraft", "an aircraft"};
    static const char *const others[] = {".hidden.aircraft", ".aircraft", "c.aircraft~", "d.demo"};
    Place place = make_place();
    NamedFiles *files = calloc(1, sizeof *files);
    Heard heard;
    char name[64];
    assert_non_null(files);
    assert_int_equal(files_make_folder(place.inner), RESULT_OK);
    for (size_t i = 0; i < COUNT_OF(others); i++)
        make_file(place.inner, others[i]);
    make_file(place.inner, "b.c.aircraft");
    make_file(place.inner, "a.aircraft");
    assert_int_equal(named_files_list(&kind, place.inner, files), RESULT_OK);
    assert_int_equal(files->count, 2);
    assert_string_equal(files->names[0], "a");
    assert_string_equal(files->names[1], "b.c");
    for (int i = 0; i < NAMED_FILES_MAX; i++) {
        snprintf(name, sizeof name, "%03d.aircraft", i);
        make_file(place.inner, name);
    }
    heard_begin(&heard);
    assert_int_equal(named_files_list(&kind, place.inner, files), RESULT_OK);
    assert_int_equal(named_files_list(&kind, place.file, files), RESULT_IO);
    heard_end();
    assert_non_null(strstr(heard.text, "/inner: more than 256 files (.aircraft); the others are left out"));
    assert_non_null(strstr(heard.text, "/file: the folder cannot be read: Not a directory"));
    free(files);
    snprintf(name, sizeof name, "rm -r %.40s", place.inner);
    assert_int_equal(system(name), 0);
    remove_place(&place);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_is_told_from_a_folder),
        cmocka_unit_test(a_file_to_be_made_is_asked_for_by_its_folder),
        cmocka_unit_test(the_true_cause_is_told),
        cmocka_unit_test(files_are_listed_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
