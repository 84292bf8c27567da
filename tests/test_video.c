// Films through a real ffmpeg: as many frames as were added, at their times; and what happens when it is not there or
// will not.
#define _POSIX_C_SOURCE 200809L
#include "app/pipeline/video.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#define WIDTH 65 // odd, as a window may be
#define HEIGHT 48
#define FRAMES 25

static char folder[64];

static void fill(uint8_t rgb[WIDTH * HEIGHT * 3], int frame) {
    for (int i = 0; i < WIDTH * HEIGHT * 3; i++)
        rgb[i] = (uint8_t)(frame * 9 + i / 3 % WIDTH);
}

static Result film(const char *path, int fps, int frames) {
    static uint8_t rgb[WIDTH * HEIGHT * 3];
    const VideoOptions options = {path, WIDTH, HEIGHT, fps};
    Video *video = NULL;
    Result result = video_create(&options, &video);
    for (int i = 0; i < frames && result == RESULT_OK; i++) {
        fill(rgb, i);
        result = video_add(video, rgb);
    }
    Result ended = video_end(&video);
    return result != RESULT_OK ? result : ended;
}

static bool has_tools(void) {
    return system("ffmpeg -version >/dev/null 2>&1 && ffprobe -version >/dev/null 2>&1") == 0;
}

static void test_frames_are_at_their_times(void **state) {
    (void)state;
    static const int RATES[] = {24, 25, 60};
    char path[128], command[400];
    if (!has_tools()) {
        print_message("skipped: no ffmpeg\n");
        skip();
    }
    for (size_t i = 0; i < COUNT_OF(RATES); i++) {
        snprintf(path, sizeof path, "%s/a film: %d.mp4", folder, RATES[i]);
        assert_int_equal(film(path, RATES[i], FRAMES), RESULT_OK);
        snprintf(command, sizeof command,
                 "ffprobe -v error -select_streams v -show_entries frame=pts_time -of default=nk=1:nw=1 'file:%s'",
                 path);
        FILE *times = popen(command, "r");
        assert_non_null(times);
        double time_s;
        int count = 0;
        for (char line[64]; fgets(line, sizeof line, times) && sscanf(line, "%lf", &time_s) == 1; count++)
            if (time_s < (double)count / RATES[i] - 1e-4 || time_s > (double)count / RATES[i] + 1e-4)
                fail_msg("%d a second: frame %d at %.6f s", RATES[i], count, time_s);
        pclose(times);
        assert_int_equal(count, FRAMES);
    }
}

static void test_no_ffmpeg_is_said(void **state) {
    (void)state;
    char *path = strdup(getenv("PATH"));
    assert_int_equal(setenv("PATH", folder, 1), 0);
    Result result = film("film.mp4", 60, 1);
    assert_int_equal(setenv("PATH", path, 1), 0);
    free(path);
    assert_int_equal(result, RESULT_NOT_FOUND);
}

// One that reads a little and goes: whoever writes to it must not die of it.
static void test_an_ffmpeg_that_dies_ends_the_film_and_not_the_program(void **state) {
    (void)state;
    char path[128], before[4096];
    snprintf(path, sizeof path, "%s/ffmpeg", folder);
    FILE *script = fopen(path, "w");
    assert_non_null(script);
    fputs("#!/bin/sh\necho 'it does not like the film' >&2\nexit 3\n", script);
    fclose(script);
    assert_int_equal(chmod(path, 0755), 0);
    snprintf(before, sizeof before, "%s", getenv("PATH"));
    char after[5000];
    snprintf(after, sizeof after, "%s:%s", folder, before);
    assert_int_equal(setenv("PATH", after, 1), 0);
    assert_int_equal(film("film.mp4", 60, 400), RESULT_IO);
    assert_int_equal(film("film.mp4", 60, 0), RESULT_IO);
    assert_int_equal(setenv("PATH", before, 1), 0);
    unlink(path);
}

static void test_endings_that_are_no_film_are_refused(void **state) {
    (void)state;
    assert_int_equal(video_check_name("a.mp4", "--video"), RESULT_OK);
    assert_int_equal(video_check_name("a.b.WEBM", "--video"), RESULT_OK);
    assert_int_equal(video_check_name("mp4", "--video"), RESULT_USAGE);
    assert_int_equal(video_check_name("a.png", "--video"), RESULT_USAGE);
}

static int make_folder(void **state) {
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/overfly-video-XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state) {
    (void)state;
    char command[128];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    return system(command);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_frames_are_at_their_times),
        cmocka_unit_test(test_no_ffmpeg_is_said),
        cmocka_unit_test(test_an_ffmpeg_that_dies_ends_the_film_and_not_the_program),
        cmocka_unit_test(test_endings_that_are_no_film_are_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
