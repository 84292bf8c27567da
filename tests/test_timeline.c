// Time along a recorded flight: faster, slower, backwards, to its ends, and as people write it.
#include "app/replay/timeline.h"
#include "input/action.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static void test_time_goes_as_fast_and_which_way_it_is_told(void **state) {
    (void)state;
    Timeline timeline = timeline_create(100.0);
    timeline_advance(&timeline, 2.0);
    assert_true(timeline.t_s == 2.0);
    for (int i = 0; i < 20; i++)
        timeline_change_rate(&timeline, 1);
    assert_true(timeline_rate(&timeline) == 64.0);
    timeline_advance(&timeline, 1.0);
    assert_true(timeline.t_s == 66.0);
    timeline_turn(&timeline);
    assert_true(timeline_rate(&timeline) == -64.0 && timeline_left_s(&timeline) == 66.0 / 64.0);
    for (int i = 0; i < 20; i++)
        timeline_change_rate(&timeline, -1);
    timeline_advance(&timeline, 8.0);
    assert_true(timeline.t_s == 65.0 && timeline_rate(&timeline) == -0.125);
    timeline_advance(&timeline, NAN);
    timeline_advance(&timeline, -3.0);
    assert_true(timeline.t_s == 65.0);
}

static void test_it_stays_at_its_ends_and_begins_again_from_the_other(void **state) {
    (void)state;
    Timeline timeline = timeline_create(10.0);
    timeline_advance(&timeline, 11.0);
    assert_true(timeline.t_s == 10.0 && timeline.paused && timeline_is_at_end(&timeline));
    timeline_play_or_pause(&timeline);
    assert_true(timeline.t_s == 0.0 && !timeline.paused);
    timeline_jump(&timeline, 1e9);
    assert_true(timeline.t_s == 10.0);
    timeline_turn(&timeline);
    timeline_advance(&timeline, 3.0);
    assert_true(timeline.t_s == 7.0 && !timeline.paused);
    timeline_advance(&timeline, 30.0);
    assert_true(timeline.t_s == 0.0 && timeline.paused);
    timeline_jump(&timeline, -4.0);
    timeline_jump(&timeline, NAN);
    assert_true(timeline.t_s == 0.0);
    Timeline nothing = timeline_create(-1.0);
    timeline_advance(&nothing, 1.0);
    assert_true(nothing.t_s == 0.0 && nothing.duration_s == 0.0 && timeline_is_at_end(&nothing));
}

// As films need it: frame i at i / fps, none after the end, whatever was rounded on the way.
static void test_frames_are_where_they_belong_and_none_too_many(void **state) {
    (void)state;
    static const double FPS[] = {24.0, 25.0, 30.0, 60.0, 1000.0}, SECONDS[] = {0.5, 1.0, 10.0, 61.7, 3600.0};
    for (size_t f = 0; f < COUNT_OF(FPS); f++)
        for (size_t s = 0; s < COUNT_OF(SECONDS); s++) {
            Timeline timeline = timeline_create(SECONDS[s]);
            int64_t frames = 0, expected = (int64_t)ceil(SECONDS[s] * FPS[f] - 1e-6);
            for (; !timeline_is_at_end(&timeline); frames++) {
                if (fabs(timeline.t_s - (double)frames / FPS[f]) > 1e-12 * SECONDS[s])
                    fail_msg("%g fps: frame %lld at %.17g s", FPS[f], (long long)frames, timeline.t_s);
                timeline_advance(&timeline, 1.0 / FPS[f]);
            }
            if (frames != expected)
                fail_msg("%g s, %g fps: %lld frames, expected %lld", SECONDS[s], FPS[f], (long long)frames,
                         (long long)expected);
        }
}

static void test_times_are_read_as_people_write_them(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double t_s;
    } GOOD[] = {{"0", 0.0},        {"90", 90.0},       {"12.5", 12.5},       {"1:30", 90.0},
                {"0:00.25", 0.25}, {"100:00", 6000.0}, {"1:02:03.5", 3723.5}};
    static const char *const BAD[] = {"",       "-1",      "1:",   ":1", "1:60", "1:2:3:4", "1e3", "nan",
                                      "1.5:30", "1:2.5:3", "0x10", " 1", "1 ",   "1..2",    ".5",  "1s"};
    double t_s;
    for (size_t i = 0; i < COUNT_OF(GOOD); i++) {
        t_s = NAN;
        if (!timeline_read(GOOD[i].text, &t_s) || t_s != GOOD[i].t_s)
            fail_msg("'%s': %g s, expected %g", GOOD[i].text, t_s, GOOD[i].t_s);
    }
    for (size_t i = 0; i < COUNT_OF(BAD); i++)
        if (timeline_read(BAD[i], &t_s))
            fail_msg("'%s' was read as %g s", BAD[i], t_s);
}

static void test_times_are_written_when_they_are_reached(void **state) {
    (void)state;
    char text[TIMELINE_TEXT_BYTES];
    timeline_write(3723.99, text);
    assert_string_equal(text, "1:02:03.9");
    timeline_write(0.3, text); // less than three tenths in binary
    assert_string_equal(text, "0:00:00.3");
    timeline_write(-5.0, text);
    assert_string_equal(text, "0:00:00.0");
    timeline_write(1e300, text);
    assert_true(text[0] != '\0');
}

static void test_keys_of_a_replay_are_those_of_its_table(void **state) {
    (void)state;
    assert_int_equal(action_of_replay_key(KEY_LEFT, 0), ACTION_REPLAY_BACK);
    assert_int_equal(action_of_replay_key(KEY_HOME, KEY_SHIFT), ACTION_REPLAY_START);
    assert_int_equal(action_of_replay_key(' ', 0), ACTION_REPLAY_PLAY);
    for (int key = '0'; key <= '9'; key++)
        assert_int_equal(action_of_replay_key(key, 0), ACTION_REPLAY_TENTH);
    assert_int_equal(action_of_replay_key('V', 0), ACTION_NONE);
    for (int action = ACTION_REPLAY_BACK; action < ACTION_COUNT; action++)
        assert_true(action_keys((Action)action)[0] && action_help((Action)action)[0]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_time_goes_as_fast_and_which_way_it_is_told),
        cmocka_unit_test(test_it_stays_at_its_ends_and_begins_again_from_the_other),
        cmocka_unit_test(test_frames_are_where_they_belong_and_none_too_many),
        cmocka_unit_test(test_times_are_read_as_people_write_them),
        cmocka_unit_test(test_times_are_written_when_they_are_reached),
        cmocka_unit_test(test_keys_of_a_replay_are_those_of_its_table),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
