// Films through a real ffmpeg: as many frames as were added, at their times; and what happens when it is not there or
// will not.
#define _POSIX_C_SOURCE 200809L
#include "app/pipeline/video.h"
#include "heard.h"

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

// Films `frames` to `path` with an ffmpeg that is this script; what is said.
static Result film_by(const char *script, const char *path, int frames, Heard *heard) {
    char program[128], before[4096], after[5000];
    snprintf(program, sizeof program, "%s/ffmpeg", folder);
    FILE *file = fopen(program, "w");
    assert_non_null(file);
    fprintf(file, "#!/bin/sh\n%s\n", script);
    fclose(file);
    assert_int_equal(chmod(program, 0755), 0);
    snprintf(before, sizeof before, "%s", getenv("PATH"));
    snprintf(after, sizeof after, "%s:%s", folder, before);
    assert_int_equal(setenv("PATH", after, 1), 0);
    heard_begin(heard);
    Result result = film(path, 60, frames);
    heard_end();
    assert_int_equal(setenv("PATH", before, 1), 0);
    unlink(program);
    return result;
}

// One that reads a little and goes: whoever writes to it must not die of it.
static void test_an_ffmpeg_that_dies_ends_the_film_and_not_the_program(void **state) {
    (void)state;
    static const int FRAMES_OF[] = {400, 0};
    Heard heard;
    for (size_t i = 0; i < COUNT_OF(FRAMES_OF); i++) {
        const char *script = "echo 'it does not like the film' >&2\nexit 3";
        assert_int_equal(film_by(script, "film.mp4", FRAMES_OF[i], &heard), RESULT_IO);
        assert_non_null(
            strstr(heard.text, "film.mp4: ffmpeg has failed, no film is written: it does not like the film"));
    }
}

static int files_of_films(void) {
    char command[128];
    int count = -1;
    snprintf(command, sizeof command, "find '%s' -name 'killed*' | wc -l", folder);
    FILE *counted = popen(command, "r");
    assert_non_null(counted);
    assert_int_equal(fscanf(counted, "%d", &count), 1);
    pclose(counted);
    return count;
}

// Its file, the last argument, is begun; the program's is there only when it is whole.
static void test_a_killed_ffmpeg_leaves_no_file_and_its_signal_is_named(void **state) {
    (void)state;
    char path[128];
    Heard heard;
    snprintf(path, sizeof path, "%s/killed.mp4", folder);
    const char *begin = "for last; do :; done\nfile=${last#file:}\necho half >\"$file\"\ncat >/dev/null";
    char killed[256];
    snprintf(killed, sizeof killed, "%s\nkill -KILL $$", begin);
    assert_int_equal(film_by(killed, path, 1, &heard), RESULT_IO);
    assert_non_null(strstr(heard.text, "killed.mp4: ffmpeg was ended by signal 9 (Killed)"));
    assert_int_equal(files_of_films(), 0);
    assert_int_equal(film_by(begin, path, 1, &heard), RESULT_OK);
    assert_int_equal(access(path, R_OK), 0);
    assert_int_equal(film_by(killed, path, 1, &heard), RESULT_IO); // that one stays
    assert_int_equal(access(path, R_OK), 0);
    assert_int_equal(files_of_films(), 1);
}

static void test_an_odd_size_is_warned_of(void **state) {
    (void)state;
    char path[128];
    Heard heard;
    snprintf(path, sizeof path, "%s/odd.mp4", folder);
    assert_int_equal(film_by("for last; do :; done\n: >\"${last#file:}\"\ncat >/dev/null", path, 1, &heard), RESULT_OK);
    assert_int_equal(heard.warnings, 1);
    assert_non_null(strstr(heard.text, "of 65x48 the last column or row is left out, 64x48 are kept"));
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
        cmocka_unit_test(test_a_killed_ffmpeg_leaves_no_file_and_its_signal_is_named),
        cmocka_unit_test(test_an_odd_size_is_warned_of),
        cmocka_unit_test(test_endings_that_are_no_film_are_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
