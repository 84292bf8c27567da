// Options: types, ranges, precedence of sources, and messages that name what was meant.
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

#include "config/options.h"
#include "config/suggest.h"
#include "tests/heard.h"

#define ARGS(...) (char *[]){__VA_ARGS__}, (int)(sizeof((char *[]){__VA_ARGS__}) / sizeof(char *))

static Options *create(CommandId command) {
    Options *options = NULL;
    assert_int_equal(options_create(command, &options), RESULT_OK);
    return options;
}

static Result read_arguments(Options *options, char **argv, int argc) {
    return options_read_arguments(options, argc, argv);
}

static void every_row_is_whole(void **state) {
    (void)state;
    for (int i = 0; i < OPTION_COUNT; i++) {
        const OptionSpec *spec = option_spec((OptionId)i);
        assert_non_null(spec->name);
        assert_non_null(spec->help);
        assert_true(spec->commands != 0 && (spec->commands & ~(unsigned)COMMANDS_ALL) == 0);
        assert_true((spec->type == OPTION_TYPE_CHOICE) == (spec->choices != NULL));
        assert_true(spec->type != OPTION_TYPE_FLAG || spec->default_text);
        for (int j = 0; j < i; j++) {
            const OptionSpec *other = option_spec((OptionId)j);
            bool together = spec->commands & other->commands;
            if (together && (strcmp(spec->name, other->name) == 0 || (spec->letter && spec->letter == other->letter)))
                fail_msg("--%s and --%s cannot be told apart", spec->name, other->name);
        }
    }
}

static void the_program_has_the_name_it_was_called_by(void **state) {
    (void)state;
    Options *options = create(COMMAND_FLY);
    assert_string_equal(options_program(options), "overfly");
    options_name_program(options, "build/release/overfly");
    assert_string_equal(options_program(options), "build/release/overfly");
    options_destroy(&options);
}

static void command_line_forms_mean_the_same(void **state) {
    (void)state;
    static const struct {
        char *argv[3];
        int argc;
    } forms[] = {
        {{"--tau", "2.5"}, 2}, {{"--tau=2.5"}, 1}, {{"-t", "2.5"}, 2}, {{"-t2.5"}, 1}, {{"-wt2.5"}, 1},
    };
    for (size_t i = 0; i < COUNT_OF(forms); i++) {
        Options *options = create(COMMAND_FLY);
        assert_int_equal(options_read_arguments(options, forms[i].argc, forms[i].argv), RESULT_OK);
        assert_true(options_number(options, OPTION_TAU) == 2.5);
        assert_int_equal(options_source(options, OPTION_TAU), SOURCE_COMMAND_LINE);
        options_destroy(&options);
    }
}

static void flags_are_turned_on_and_off(void **state) {
    (void)state;
    Options *options = create(COMMAND_FLY);
    assert_true(options_flag(options, OPTION_WINDOW));
    assert_false(options_flag(options, OPTION_DEMO));
    assert_int_equal(read_arguments(options, ARGS("--no-window", "--demo", "--hud=no")), RESULT_OK);
    assert_false(options_flag(options, OPTION_WINDOW));
    assert_true(options_flag(options, OPTION_DEMO));
    assert_false(options_flag(options, OPTION_HUD));
    options_destroy(&options);
}

static void a_choice_may_take_a_number(void **state) {
    (void)state;
    static const struct {
        char *text;
        int choice, number;
    } GOOD[] = {{"midpoint", 0, 0}, {"total", 1, 0}, {"TOTAL", 1, 0}, {"total:1", 2, 1}, {"total:1024", 2, 1024}};
    for (size_t i = 0; i < COUNT_OF(GOOD); i++) {
        Options *options = create(COMMAND_MESH);
        assert_int_equal(read_arguments(options, ARGS("--error", GOOD[i].text)), RESULT_OK);
        assert_int_equal(options_choice(options, OPTION_ERROR), GOOD[i].choice);
        assert_int_equal(options_choice_number(options, OPTION_ERROR), GOOD[i].number);
        assert_string_equal(options_text(options, OPTION_ERROR), GOOD[i].text);
        options_destroy(&options);
    }
    static char *const BAD[] = {"total:",   "total:0",  "total:3",  "total:2048", "total:-4",
                                "total: 4", "total:4x", "total:N",  "midpoint:4", "total:4:4",
                                "tot",      "totally",  "total:+4", "total:1e1",  "total:99999999999999999999"};
    for (size_t i = 0; i < COUNT_OF(BAD); i++) {
        Options *options = create(COMMAND_MESH);
        Heard heard;
        heard_begin(&heard);
        Result result = read_arguments(options, ARGS("--error", BAD[i]));
        heard_end();
        if (result != RESULT_USAGE ||
            !strstr(heard.text, "midpoint, total, total:N with N a power of two from 1 to 1024"))
            fail_msg("'%s': %s, said '%s'", BAD[i], result_name(result), heard.text);
        options_destroy(&options);
    }
}

static void positionals_and_negative_values_pass(void **state) {
    (void)state;
    Options *options = create(COMMAND_SNAPSHOT);
    assert_int_equal(read_arguments(options, ARGS("a.tif", "--eye", "-36.5,-84.2,5000ft", "-", "--", "--tau")),
                     RESULT_OK);
    assert_int_equal(options_positional_count(options), 3);
    assert_string_equal(options_positionals(options)[0], "a.tif");
    assert_string_equal(options_positionals(options)[1], "-");
    assert_string_equal(options_positionals(options)[2], "--tau");
    const double *eye = options_numbers(options, OPTION_EYE);
    assert_true(eye[0] == -36.5 && eye[1] == -84.2 && eye[2] > 1523.999 && eye[2] < 1524.001);
    options_destroy(&options);
}

typedef struct Wrong {
    char *argv[3];
    int argc;
    const char *said; // part of the message
} Wrong;

static void wrong_options_are_named_with_what_was_expected(void **state) {
    (void)state;
    static const Wrong wrongs[] = {
        {{"--tua", "1"}, 2, "did you mean '--tau'"},
        {{"--no-widnow"}, 1, "--no-widnow"},
        {{"--record", "--no-window"}, 2, "--record: a value is missing"},
        {{"--record", "--x", "--demo"}, 3, "for a file of that name: ./--x"},
        {{"--tau", "--demo"}, 2, "--tau: a value is missing"},
        {{"--metod", "brute"}, 2, "did you mean '--method'"},
        {{"--method", "hybird"}, 2, "did you mean 'hybrid'"},
        {{"--method", "best"}, 2, "one of hybrid, patch, roam, roam-parallel, geomipmap, geomipmap-ye, diamond, brute"},
        {{"--tau", "0"}, 2, "from 0.01 to 1000"},
        {{"--tau", "1e9"}, 2, "from 0.01 to 1000"},
        {{"--tau"}, 1, "a value is missing"},
        {{"--tau", "nan"}, 2, "found 'nan'"},
        {{"--frames", "1.5"}, 2, "a whole number"},
        {{"--size", "800"}, 2, "WIDTHxHEIGHT"},
        {{"--size", "0x800"}, 2, "WIDTHxHEIGHT"},
        {{"--eye", "91,0,0"}, 2, "LATITUDE,LONGITUDE,ALTITUDE"},
        {{"--bounds", "5,1,4,2"}, 2, "WEST,SOUTH,EAST,NORTH"},
        {{"--cull"}, 1, "not to this subcommand"},
        {{"-Z"}, 1, "unknown option '-Z'"},
        {{"--wireframe=maybe"}, 1, "yes or no"},
        {{"--no-tau"}, 1, "unknown option '--no-tau'"},
        {{"--image", ""}, 2, "a file name"},
    };
    for (size_t i = 0; i < COUNT_OF(wrongs); i++) {
        Options *options = create(COMMAND_FLY);
        Heard heard;
        heard_begin(&heard);
        Result result = options_read_arguments(options, wrongs[i].argc, wrongs[i].argv);
        heard_end();
        if (result != RESULT_USAGE || heard.errors != 1 || !strstr(heard.text, wrongs[i].said))
            fail_msg("%s: %s, %d messages: %s; expected one with \"%s\"", wrongs[i].argv[0], result_name(result),
                     heard.errors, heard.text, wrongs[i].said);
        options_destroy(&options);
    }
}

static void the_command_line_wins_over_environment_over_file_over_default(void **state) {
    (void)state;
    char path[] = "/tmp/overfly-options-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    static const char text[] = "tau = 3\nmethod = brute\npartitions = 5\n[mesh]\ntau = 9\n[fly]\nfps = 25\n";
    assert_int_equal(write(file, text, sizeof text - 1), sizeof text - 1);
    close(file);
    char *environment[] = {"OVERFLY_TAU=4", "OVERFLY_METHOD=hybrid", "HOME=/nowhere", NULL};
    Options *options = create(COMMAND_FLY);
    assert_int_equal(read_arguments(options, ARGS("--tau", "5")), RESULT_OK); // read first: order does not matter
    assert_int_equal(options_read_file(options, path), RESULT_OK);
    assert_int_equal(options_read_environment(options, environment), RESULT_OK);
    assert_true(options_number(options, OPTION_TAU) == 5.0);
    assert_int_equal(options_source(options, OPTION_TAU), SOURCE_COMMAND_LINE);
    assert_int_equal(options_choice(options, OPTION_METHOD), 0);
    assert_int_equal(options_source(options, OPTION_METHOD), SOURCE_ENVIRONMENT);
    assert_int_equal(options_integer(options, OPTION_PARTITIONS), 5);
    assert_int_equal(options_source(options, OPTION_PARTITIONS), SOURCE_FILE);
    assert_non_null(strstr(options_where(options, OPTION_PARTITIONS), ":3"));
    assert_true(options_number(options, OPTION_FPS) == 25.0);
    assert_int_equal(options_source(options, OPTION_FOV), SOURCE_DEFAULT);
    options_destroy(&options);
    unlink(path);
}

typedef struct BrokenFile {
    const char *text;
    const char *said;
} BrokenFile;

static void broken_files_are_named_with_line_and_expectation(void **state) {
    (void)state;
    static const BrokenFile files[] = {
        {"# fine\ntau = 1\nthis is no entry\n", ":3: expected 'name = value'"},
        {"\ntau = much\n", ":2: tau: expected a number"},
        {"tua = 1\n", ":1: expected the name of an option; found 'tua'; did you mean 'tau'"},
        {"[flyy]\ntau = 1\n", ":2: in section [flyy]"},
        {"[mesh]\ntau = -1\n", ":2: tau: expected a number"},
        {"help = yes\n", ":1: expected the name of an option"},
        {"tau = 1\n[fly\n", ":2: expected"},
    };
    for (size_t i = 0; i < COUNT_OF(files); i++) {
        char path[] = "/tmp/overfly-options-XXXXXX";
        int file = mkstemp(path);
        assert_true(file >= 0);
        assert_int_equal(write(file, files[i].text, strlen(files[i].text)), strlen(files[i].text));
        close(file);
        Options *options = create(COMMAND_FLY);
        Heard heard;
        heard_begin(&heard);
        Result result = options_read_file(options, path);
        heard_end();
        if (result != RESULT_USAGE || heard.errors != 1 || !strstr(heard.text, files[i].said) ||
            !strstr(heard.text, path))
            fail_msg("%s: %s, %d messages: %s; expected one with \"%s\"", files[i].text, result_name(result),
                     heard.errors, heard.text, files[i].said);
        options_destroy(&options);
        unlink(path);
    }
}

static void long_and_binary_lines_are_refused(void **state) {
    (void)state;
    char path[] = "/tmp/overfly-options-XXXXXX", noise[5000];
    int file = mkstemp(path);
    assert_true(file >= 0);
    for (size_t i = 0; i < sizeof noise; i++)
        noise[i] = (char)(i * 2654435761u >> 13);
    assert_int_equal(write(file, noise, sizeof noise), sizeof noise);
    close(file);
    Options *options = create(COMMAND_FLY);
    Heard heard;
    heard_begin(&heard);
    assert_int_equal(options_read_file(options, path), RESULT_USAGE);
    heard_end();
    assert_int_equal(heard.errors, 1);
    options_destroy(&options);
    unlink(path);
}

static void a_missing_file_is_silent(void **state) {
    (void)state;
    Options *options = create(COMMAND_FLY);
    Heard heard;
    heard_begin(&heard);
    assert_int_equal(options_read_file(options, "/nowhere/overfly.conf"), RESULT_NOT_FOUND);
    heard_end();
    assert_int_equal(heard.errors, 0);
    options_destroy(&options);
}

static void unknown_environment_names_are_a_warning(void **state) {
    (void)state;
    char *environment[] = {"OVERFLY_TUA=4", "OVERFLY_DATA_DIR=/x", "OVERFLYING=1", NULL};
    Options *options = create(COMMAND_FLY);
    Heard heard;
    heard_begin(&heard);
    assert_int_equal(options_read_environment(options, environment), RESULT_OK);
    heard_end();
    assert_int_equal(heard.errors, 0);
    assert_int_equal(heard.warnings, 1);
    assert_non_null(strstr(heard.text, "OVERFLY_TAU"));
    options_destroy(&options);
}

static void distances_count_edits(void **state) {
    (void)state;
    static const struct {
        const char *a, *b;
        int distance;
    } pairs[] = {{"tau", "tau", 0}, {"tua", "tau", 1},       {"", "abc", 3},    {"kitten", "sitting", 3},
                 {"a", "b", 1},     {"hybird", "hybrid", 1}, {"TAU", "tau", 0}, {"meth", "method", 2}};
    for (size_t i = 0; i < COUNT_OF(pairs); i++) {
        int found = suggest_distance(pairs[i].a, pairs[i].b), back = suggest_distance(pairs[i].b, pairs[i].a);
        if (found != pairs[i].distance || back != found)
            fail_msg("%s, %s: %d and %d; expected %d", pairs[i].a, pairs[i].b, found, back, pairs[i].distance);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_row_is_whole),
        cmocka_unit_test(the_program_has_the_name_it_was_called_by),
        cmocka_unit_test(command_line_forms_mean_the_same),
        cmocka_unit_test(flags_are_turned_on_and_off),
        cmocka_unit_test(a_choice_may_take_a_number),
        cmocka_unit_test(positionals_and_negative_values_pass),
        cmocka_unit_test(wrong_options_are_named_with_what_was_expected),
        cmocka_unit_test(the_command_line_wins_over_environment_over_file_over_default),
        cmocka_unit_test(broken_files_are_named_with_line_and_expectation),
        cmocka_unit_test(long_and_binary_lines_are_refused),
        cmocka_unit_test(a_missing_file_is_silent),
        cmocka_unit_test(unknown_environment_names_are_a_warning),
        cmocka_unit_test(distances_count_edits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
