// A GL context without a window: what it is, and what is said where there is none that will do. Each case has a process
// of its own, because the driver reads its environment once.
#define _POSIX_C_SOURCE 200809L
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "render/context/context.h"
#include "render/gl.h"
#include "tests/heard.h"

#define SKIP_STATUS 77

static const ContextOptions OPTIONS = {.width = 64, .height = 48, .title = "test"};

// In a child with NAME=VALUE: creates a context and sends back the result and what was logged.
static Result create_in_child(const char *name, const char *value, bool window, char *said, size_t size) {
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    pid_t child = fork();
    if (child == 0) {
        Heard heard;
        Context *context = NULL;
        setenv(name, value, 1);
        heard_begin(&heard);
        Result result =
            window ? context_create_window(&OPTIONS, &context) : context_create_offscreen(&OPTIONS, &context);
        heard_end();
        context_destroy(&context);
        ssize_t sent = write(ends[1], heard.text, strlen(heard.text));
        _exit(sent < 0 ? 125 : (int)result);
    }
    close(ends[1]);
    size_t used = 0;
    for (ssize_t got; (got = read(ends[0], said + used, size - 1 - used)) > 0;)
        used += (size_t)got;
    said[used] = '\0';
    close(ends[0]);
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    return (Result)WEXITSTATUS(status);
}

static void assert_says(const char *said, const char *part) {
    if (!strstr(said, part))
        fail_msg("expected '%s' in: %s", part, said);
}

static void an_old_version_is_named(void **state) {
    (void)state;
    char said[2048];
    Result result = create_in_child("MESA_GL_VERSION_OVERRIDE", "4.1", false, said, sizeof said);
    if (result == RESULT_OK) {
        print_message("skipped: this driver is not Mesa\n");
        skip();
    }
    print_message("%s", said);
    assert_int_equal(result, RESULT_DEVICE);
    assert_says(said, "4.1");
    assert_says(said, "4.5");
}

static void a_missing_clip_control_is_named(void **state) {
    (void)state;
    char said[2048];
    Result result = create_in_child("MESA_EXTENSION_OVERRIDE", "-GL_ARB_clip_control", false, said, sizeof said);
    if (result == RESULT_OK) {
        print_message("skipped: this driver is not Mesa\n");
        skip();
    }
    print_message("%s", said);
    assert_int_equal(result, RESULT_DEVICE);
    assert_says(said, "without clip control");
}

static void a_missing_display_is_named(void **state) {
    (void)state;
    char said[2048];
    unsetenv("WAYLAND_DISPLAY");
    Result result = create_in_child("DISPLAY", ":4711", true, said, sizeof said);
    print_message("%s", said);
    assert_int_equal(result, RESULT_DEVICE);
    assert_says(said, "display");
    assert_says(said, "--no-window");
}

static void *draw_on_thread(void *argument) {
    Context *context = argument;
    uint8_t *pixel = calloc(1, 4);
    if (!pixel || context_make_current(context) != RESULT_OK)
        return pixel;
    glClearColor(1.0f, 0.0f, 1.0f, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    glReadPixels(63, 47, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel);
    context_release_current(context);
    return pixel;
}

static void it_draws_on_another_thread_than_it_was_made_on(void **state) {
    (void)state;
    Context *context = NULL;
    pthread_t thread;
    void *pixel = NULL;
    const uint8_t magenta[4] = {255, 0, 255, 255};
    assert_int_equal(context_create_offscreen(&OPTIONS, &context), RESULT_OK);
    assert_true(context_framebuffer(context) != 0);
    assert_non_null(strstr(context_renderer_name(context), "OpenGL 4."));
    assert_int_equal(pthread_create(&thread, NULL, draw_on_thread, context), 0);
    assert_int_equal(pthread_join(thread, &pixel), 0);
    assert_memory_equal(pixel, magenta, 4);
    free(pixel);
    context_destroy(&context);
    assert_null(context);
}

static bool has_gl(void) {
    char said[2048];
    return create_in_child("OVERFLY_UNUSED", "1", false, said, sizeof said) == RESULT_OK;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_old_version_is_named),
        cmocka_unit_test(a_missing_clip_control_is_named),
        cmocka_unit_test(a_missing_display_is_named),
        cmocka_unit_test(it_draws_on_another_thread_than_it_was_made_on),
    };
    if (!has_gl()) {
        printf("skipped: no OpenGL 4.5 without a window\n");
        return SKIP_STATUS;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
