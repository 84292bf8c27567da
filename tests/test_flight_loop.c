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
#define WIDTH 64
#define HEIGHT 48

static Context *context;

// A flight in lockstep, made once, and flown on by each test.
typedef struct Fixture {
    Options *options;
    World world;
    FlightSession session;
    FlightLoop loop;
} Fixture;

static Result make_flight(Fixture *fixture) {
    FlightLoop *loop = &fixture->loop;
    Result result = world_load(fixture->options, &fixture->world);
    if (result == RESULT_OK)
        result = session_create(&fixture->world, fixture->options, &fixture->session);
    *loop = (FlightLoop){.session = &fixture->session, .context = context, .frames = FRAMES, .fps = 60.0};
    loop->lockstep = true;
    loop->width = WIDTH;
    loop->height = HEIGHT;
    context_release_current(context);
    if (result == RESULT_OK)
        result =
            flight_pipeline_create(fixture->options, &fixture->world, loop->session, context, NULL, &loop->pipeline);
    const MonitorOptions monitor = {scene_lod_options(fixture->options), fixture->world.terrain, loop->pipeline};
    return result == RESULT_OK ? monitor_create(&monitor, &loop->monitor) : result;
}

static int set_up(void **state) {
    static Fixture fixture;
    char words[][16] = {"fly", "--lockstep", "--size", "64x48", "--tau", "16"};
    char *argv[COUNT_OF(words)];
    for (size_t i = 0; i < COUNT_OF(words); i++)
        argv[i] = words[i];
    *state = &fixture;
    return options_create(COMMAND_FLY, &fixture.options) != RESULT_OK ||
           options_read_arguments(fixture.options, COUNT_OF(words) - 1, argv + 1) != RESULT_OK ||
           make_flight(&fixture) != RESULT_OK;
}

static int tear_down(void **state) {
    Fixture *fixture = *state;
    monitor_destroy(&fixture->loop.monitor);
    pipeline_destroy(&fixture->loop.pipeline);
    session_end(&fixture->session);
    world_unload(&fixture->world);
    options_destroy(&fixture->options);
    return 0;
}

// Some frames, the first of which is asked for by a key; what the display says afterwards.
static const char *fly(Fixture *fixture, const char *folder, Heard *heard) {
    int64_t before = pipeline_stats(fixture->loop.pipeline).frames;
    assert_int_equal(setenv("XDG_PICTURES_DIR", folder, 1), 0);
    fixture->session.screenshot_wanted = true;
    heard_begin(heard);
    assert_int_equal(flight_loop_run(&fixture->loop), RESULT_OK);
    heard_end();
    assert_int_equal(pipeline_stats(fixture->loop.pipeline).frames - before, FRAMES);
    return fixture->session.message;
}

static void a_picture_is_told_when_it_is_written(void **state) {
    char folder[] = "/tmp/overfly-XXXXXX";
    Heard heard;
    assert_non_null(mkdtemp(folder));
    const char *message = fly(*state, folder, &heard), *path = message + strlen("picture: ");
    assert_int_equal(strncmp(message, "picture: ", strlen("picture: ")), 0);
    assert_int_equal(strncmp(path, folder, strlen(folder)), 0);
    assert_true(files_exists(path));
    assert_non_null(strstr(heard.text, message));
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

// No file can be made there, by whomever.
static void a_picture_that_cannot_be_written_is_told(void **state) {
    Heard heard;
    const char *message = fly(*state, "/proc", &heard);
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
    if (!gl_support_begin(WIDTH, HEIGHT, &context))
        return GL_SKIP_STATUS;
    int failed = cmocka_run_group_tests(tests, set_up, tear_down);
    context_destroy(&context);
    return failed;
}
