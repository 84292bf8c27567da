// The main thread's part of a flight: what a person is told of the picture that a key asked for.
#define _DEFAULT_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "app/flight/flight_loop.h"
#include "app/flight/flight_pipeline.h"
#include "config/files.h"
#include "tests/gl_support.h"
#include "tests/heard.h"

#define FRAMES 3

static Context *context;

typedef struct Land {
    Options *options;
    World world;
} Land;

static int load_land(void **state) {
    static Land land;
    char words[][16] = {"fly", "--lockstep", "--size", "64x48", "--tau", "16"};
    char *argv[COUNT_OF(words)];
    for (size_t i = 0; i < COUNT_OF(words); i++)
        argv[i] = words[i];
    *state = &land;
    return options_create(COMMAND_FLY, &land.options) != RESULT_OK ||
           options_read_arguments(land.options, COUNT_OF(words) - 1, argv + 1) != RESULT_OK ||
           world_load(land.options, &land.world) != RESULT_OK;
}

static int unload_land(void **state) {
    Land *land = *state;
    world_unload(&land->world);
    options_destroy(&land->options);
    return 0;
}

// A flight whose first frame is asked for by a key, with a folder for pictures.
static void fly(const Land *land, const char *folder, char message[PIPELINE_MESSAGE_BYTES], Heard *heard) {
    FlightSession *session = calloc(1, sizeof *session);
    FlightLoop loop = {.session = session, .context = context, .frames = FRAMES, .fps = 60.0, .lockstep = true};
    loop.width = 64;
    loop.height = 48;
    assert_non_null(session);
    assert_int_equal(setenv("XDG_PICTURES_DIR", folder, 1), 0);
    context_release_current(context);
    assert_int_equal(session_create(&land->world, land->options, session), RESULT_OK);
    assert_int_equal(flight_pipeline_create(land->options, &land->world, session, context, NULL, &loop.pipeline),
                     RESULT_OK);
    const MonitorOptions monitor = {scene_lod_options(land->options), land->world.terrain, loop.pipeline};
    assert_int_equal(monitor_create(&monitor, &loop.monitor), RESULT_OK);
    session->screenshot_wanted = true;
    heard_begin(heard);
    assert_int_equal(flight_loop_run(&loop), RESULT_OK);
    heard_end();
    assert_int_equal(pipeline_stats(loop.pipeline).frames, FRAMES);
    monitor_destroy(&loop.monitor);
    pipeline_destroy(&loop.pipeline);
    snprintf(message, PIPELINE_MESSAGE_BYTES, "%s", session->message);
    session_end(session);
    free(session);
}

static void a_picture_is_told_when_it_is_written(void **state) {
    char folder[] = "/tmp/overfly-XXXXXX", message[PIPELINE_MESSAGE_BYTES];
    Heard heard;
    assert_non_null(mkdtemp(folder));
    fly(*state, folder, message, &heard);
    const char *path = message + strlen("picture: ");
    assert_int_equal(strncmp(message, "picture: ", strlen("picture: ")), 0);
    assert_int_equal(strncmp(path, folder, strlen(folder)), 0);
    assert_true(files_exists(path));
    assert_non_null(strstr(heard.text, message));
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

// No file can be made there, by whomever.
static void a_picture_that_cannot_be_written_is_told(void **state) {
    char message[PIPELINE_MESSAGE_BYTES];
    Heard heard;
    fly(*state, "/proc", message, &heard);
    print_message("%s\n%s", message, heard.text);
    assert_int_equal(strncmp(message, "no picture: /proc/overfly-", strlen("no picture: /proc/overfly-")), 0);
    assert_non_null(strstr(message, ".png cannot be written"));
    assert_null(strstr(heard.text, "\npicture: "));
    assert_int_equal(heard.errors, 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_picture_is_told_when_it_is_written),
        cmocka_unit_test(a_picture_that_cannot_be_written_is_told),
    };
    if (!gl_support_begin(64, 48, &context))
        return GL_SKIP_STATUS;
    int failed = cmocka_run_group_tests(tests, load_land, unload_land);
    context_destroy(&context);
    return failed;
}
