// Recorded flights flown again: equal to the last bit, or the first difference is told; any moment, there and back.
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/clock.h"
#include "tests/heard.h"
#include "tests/recording_support.h"
#include "tests/recording_wrap.h"

static RecordingReader *record_and_open(const char *path, uint64_t seed, uint32_t steps) {
    RecordingReader *reader;
    support_record(path, seed, steps);
    assert_int_equal(recording_reader_open(path, &reader), RESULT_OK);
    return reader;
}

// ---- verification ----

static void test_a_replay_has_the_hash_of_the_flight(void **state) {
    (void)state;
    char path[128];
    support_path("replay", path);
    RecordingHeader header = toy_header();
    Toy toy = toy_create(6), other = toy_create(7);
    Pilot pilot = pilot_create(6, 12, 0.8);
    RecordingSim sim = toy_sim(&other);
    RecordingWriter *writer;
    RecordingReader *reader;
    RecordingVerdict verdict;
    assert_int_equal(recording_writer_create(&header, path, &toy, &writer), RESULT_OK);
    support_fly(writer, &toy, &pilot, 60 * RECORDING_STEPS_PER_S + 17);
    uint64_t hash = recording_writer_hash(writer);
    assert_int_equal(recording_writer_close(&writer), RESULT_OK);
    assert_int_equal(recording_reader_open(path, &reader), RESULT_OK);
    assert_int_equal(recording_verify(reader, &sim, &verdict), RESULT_OK);
    print_message("hash %016llx, expected %016llx, %.0f times as fast as flown\n", (unsigned long long)verdict.hash,
                  (unsigned long long)hash, verdict.realtime_factor);
    assert_true(verdict.equal && verdict.hash == hash && verdict.expected_hash == hash);
    assert_int_equal(verdict.steps, 60 * RECORDING_STEPS_PER_S + 17);
    assert_int_equal(verdict.steps_missing, 0);
    assert_int_equal(verdict.first_difference_step, -1);
    assert_true(verdict.realtime_factor > 0.0);
    assert_memory_equal(&other, &toy, sizeof toy);
    recording_reader_close(&reader);
    unlink(path);
}

// A simulation that once goes another way, by the least bit.
typedef struct Faulty {
    Toy toy; // first, so that the toy's callbacks serve
    uint64_t fault_step;
} Faulty;

static void step_faulty(void *user, const Controls *controls) {
    Faulty *faulty = user;
    bool now = faulty->toy.word[TOY_WORDS - 1] == faulty->fault_step;
    toy_step(&faulty->toy, controls);
    faulty->toy.word[20] ^= now;
}

static RecordingSim faulty_sim(Faulty *faulty) {
    RecordingSim sim = toy_sim(&faulty->toy);
    sim.user = faulty;
    sim.step = step_faulty;
    return sim;
}

static void test_the_first_difference_is_found_at_its_step(void **state) {
    (void)state;
    static const uint32_t AT[] = {0, 1, 57, 99, 100, 1199, 1200, 1201, 2500, 3009};
    char path[128];
    support_path("difference", path);
    RecordingReader *reader = record_and_open(path, 8, 3010);
    for (size_t i = 0; i < COUNT_OF(AT); i++) {
        Faulty faulty = {.fault_step = AT[i]};
        RecordingSim sim = faulty_sim(&faulty);
        RecordingVerdict verdict;
        assert_int_equal(recording_verify(reader, &sim, &verdict), RESULT_OK);
        if (verdict.equal || verdict.first_difference_step != AT[i] || verdict.hash == verdict.expected_hash)
            fail_msg("differs from step %u, found %lld", AT[i], (long long)verdict.first_difference_step);
    }
    recording_reader_close(&reader);
    unlink(path);
}

static void test_a_changed_input_is_found_too(void **state) {
    (void)state;
    RecordingVerdict verdict;
    RecordingReader *reader;
    char path[128];
    support_path("changed", path);
    RecordingHeader header = toy_header();
    Toy toy = toy_create(1);
    RecordingSim sim = toy_sim(&toy);
    RecordingWriter *writer;
    assert_int_equal(recording_writer_create(&header, path, &toy, &writer), RESULT_OK);
    for (int i = 0; i < 500; i++) {
        ControlsCode code = {.aileron = (int16_t)i};
        Controls flown = recording_controls(code);
        toy_step(&toy, &flown);
        code.aileron = (int16_t)(code.aileron + (i == 321));
        recording_writer_step(writer, code, toy_hash(&toy), &toy);
    }
    assert_int_equal(recording_writer_close(&writer), RESULT_OK);
    assert_int_equal(recording_reader_open(path, &reader), RESULT_OK);
    assert_int_equal(recording_verify(reader, &sim, &verdict), RESULT_OK);
    print_message("first difference at step %lld, expected 321\n", (long long)verdict.first_difference_step);
    assert_int_equal(verdict.first_difference_step, 321);
    recording_reader_close(&reader);
    unlink(path);
}

static void test_another_flight_model_is_refused(void **state) {
    (void)state;
    char path[128];
    support_path("model", path);
    RecordingReader *reader = record_and_open(path, 9, 300);
    Toy toy = toy_create(1);
    for (int i = 0; i < 2; i++) {
        RecordingSim sim = toy_sim(&toy);
        RecordingVerdict verdict;
        RecordingPlayer *player;
        Heard heard;
        sim.state_layout += i == 0;
        sim.state_bytes += i == 1;
        heard_begin(&heard);
        assert_int_equal(recording_verify(reader, &sim, &verdict), RESULT_UNSUPPORTED);
        assert_int_equal(recording_player_create(reader, &sim, &player), RESULT_UNSUPPORTED);
        heard_end();
        assert_int_equal(heard.errors, 2);
        assert_non_null(strstr(heard.text, "another flight model recorded it ('toy 1')"));
    }
    recording_reader_close(&reader);
    unlink(path);
}

// ---- events and restarts ----

static void blow(RecordingWriter *writer, Toy *toy, double wind) {
    RecordingSim sim = toy_sim(toy);
    RecordingEvent event = {.kind = TOY_EVENT_WIND, .bytes = sizeof wind};
    memcpy(event.data, &wind, sizeof wind);
    sim.event(toy, &event);
    recording_writer_event(writer, TOY_EVENT_WIND, &wind, sizeof wind);
}

// Winds at all sorts of steps, also many at one; new starts, two of them at one step.
static void fly_eventfully(RecordingWriter *writer, Toy *toy, Pilot *pilot) {
    blow(writer, toy, 0.5);
    support_fly(writer, toy, pilot, 250);
    recording_writer_event(writer, RECORDING_EVENT_PAUSE, NULL, 0);
    for (int i = 0; i < 200; i++)
        blow(writer, toy, 0.01 * i);
    recording_writer_event(writer, RECORDING_EVENT_RESUME, NULL, 0);
    for (int i = 0; i < 300; i++) {
        blow(writer, toy, 0.1 * (i % 7));
        support_fly(writer, toy, pilot, 1);
    }
    *toy = toy_create(70);
    recording_writer_restart(writer, RECORDING_EVENT_RESET, toy);
    *toy = toy_create(71);
    recording_writer_restart(writer, RECORDING_EVENT_RESET, toy);
    support_fly(writer, toy, pilot, 1300);
    blow(writer, toy, -2.0);
    *toy = toy_create(72);
    recording_writer_restart(writer, RECORDING_EVENT_TAKE_OVER, toy);
    support_fly(writer, toy, pilot, 777);
    recording_writer_event(writer, RECORDING_EVENT_DEMO_OFF, NULL, 0);
}

static void record_events(const char *path, Toy *toy) {
    RecordingHeader header = toy_header();
    Pilot pilot = pilot_create(10, 12, 0.8);
    RecordingWriter *writer;
    *toy = toy_create(10);
    assert_int_equal(recording_writer_create(&header, path, toy, &writer), RESULT_OK);
    fly_eventfully(writer, toy, &pilot);
    assert_int_equal(recording_writer_close(&writer), RESULT_OK);
}

static void test_winds_and_new_starts_are_flown_again(void **state) {
    (void)state;
    char path[128];
    Toy toy, other = toy_create(1);
    RecordingSim sim = toy_sim(&other);
    RecordingReader *reader;
    RecordingVerdict verdict;
    const RecordingDamage *damages;
    support_path("events", path);
    record_events(path, &toy);
    assert_int_equal(recording_reader_open(path, &reader), RESULT_OK);
    assert_int_equal(recording_reader_damages(reader, &damages), 0);
    assert_int_equal(recording_verify(reader, &sim, &verdict), RESULT_OK);
    print_message("%u steps, expected 2627, first difference %lld\n", verdict.steps,
                  (long long)verdict.first_difference_step);
    assert_int_equal(verdict.steps, 250 + 300 + 1300 + 777);
    assert_true(verdict.equal && verdict.hash == verdict.expected_hash);
    assert_memory_equal(&other, &toy, sizeof toy);
    sim.event = NULL; // then the winds are missing
    assert_int_equal(recording_verify(reader, &sim, &verdict), RESULT_OK);
    assert_int_equal(verdict.first_difference_step, 0);
    recording_reader_close(&reader);
    unlink(path);
}

// ---- any moment ----

// All states of a flight, by seeking forwards; the caller's.
static Toy *play_forwards(RecordingPlayer *player, const Toy *held, uint32_t count) {
    Toy *states = malloc(sizeof *states * (count + 1));
    assert_non_null(states);
    for (uint32_t i = 0; i <= count; i++) {
        assert_int_equal(recording_player_seek(player, i), RESULT_OK);
        assert_int_equal(recording_player_position(player), i);
        states[i] = *held;
    }
    return states;
}

static void check_all_ways(RecordingPlayer *player, const Toy *held, const Toy *states, uint32_t count) {
    uint64_t random = 11;
    for (uint32_t i = count + 1; i-- > 0;) {
        assert_int_equal(recording_player_seek(player, i), RESULT_OK);
        if (memcmp(held, &states[i], sizeof *held) != 0)
            fail_msg("position %u is another one backwards", i);
    }
    for (int i = 0; i < 300; i++) {
        uint32_t at = (uint32_t)(support_random(&random) % (count + 1));
        assert_int_equal(recording_player_seek(player, at), RESULT_OK);
        if (memcmp(held, &states[at], sizeof *held) != 0)
            fail_msg("position %u is another one after a leap", at);
    }
}

static void test_reverse_play_and_leaps_show_the_states_of_the_flight(void **state) {
    (void)state;
    char path[128];
    Toy flown, held = toy_create(1);
    RecordingSim sim = toy_sim(&held);
    RecordingReader *reader;
    RecordingPlayer *player;
    support_path("player", path);
    record_events(path, &flown);
    assert_int_equal(recording_reader_open(path, &reader), RESULT_OK);
    uint32_t count = recording_reader_end(reader);
    assert_int_equal(recording_player_create(reader, &sim, &player), RESULT_OK);
    Toy *states = play_forwards(player, &held, count);
    assert_memory_equal(&states[count], &flown, sizeof flown);
    assert_int_equal(recording_player_first_difference(player), -1);
    check_all_ways(player, &held, states, count);
    assert_int_equal(recording_player_seek(player, -5), RESULT_OK);
    assert_int_equal(recording_player_position(player), 0);
    assert_int_equal(recording_player_seek(player, INT64_MAX), RESULT_OK);
    assert_int_equal(recording_player_position(player), count);
    assert_false(recording_player_is_in_gap(player));
    free(states);
    recording_player_destroy(&player);
    recording_reader_close(&reader);
    unlink(path);
}

static void test_the_player_remembers_the_first_difference(void **state) {
    (void)state;
    static const uint32_t AT[] = {1700, 2399, 3599}; // the last steps before a keyframe are compared as well
    char path[128];
    support_path("remembers", path);
    RecordingReader *reader = record_and_open(path, 12, 5000);
    for (size_t i = 0; i < COUNT_OF(AT); i++) {
        Faulty faulty = {.fault_step = AT[i]};
        RecordingSim sim = faulty_sim(&faulty);
        RecordingPlayer *player;
        assert_int_equal(recording_player_create(reader, &sim, &player), RESULT_OK);
        for (int step = 4000; step <= 5000; step += 7)
            assert_int_equal(recording_player_seek(player, step), RESULT_OK);
        assert_int_equal(recording_player_first_difference(player), -1);
        for (int step = 0; step <= 4000; step += 7)
            assert_int_equal(recording_player_seek(player, step), RESULT_OK);
        if (recording_player_first_difference(player) != AT[i])
            fail_msg("differs from step %u, found %lld", AT[i], (long long)recording_player_first_difference(player));
        recording_player_destroy(&player);
    }
    recording_reader_close(&reader);
    unlink(path);
}

static void test_a_gap_is_shown_as_one(void **state) {
    (void)state;
    char path[128];
    size_t count;
    support_path("gap", path);
    support_record(path, 13, 3000);
    uint8_t *bytes = support_load(path, &count);
    size_t at = WRAP_TEXT_AT + recording_get32(bytes + 12) + 4;
    for (int i = 0; i < 5; i++)
        at += RECORDING_CHUNK_HEADER_BYTES + recording_get32(bytes + at + 12);
    bytes[at] ^= 1;
    support_store(path, bytes, count);
    free(bytes);
    Toy held = toy_create(1);
    RecordingSim sim = toy_sim(&held);
    RecordingReader *reader;
    RecordingPlayer *player;
    Heard heard;
    heard_begin(&heard);
    assert_int_equal(recording_reader_open(path, &reader), RESULT_OK);
    heard_end();
    assert_int_equal(recording_player_create(reader, &sim, &player), RESULT_OK);
    static const struct {
        uint32_t position, shown;
        bool gap;
    } CASES[] = {{499, 499, false}, {500, 500, false},   {501, 500, true},    {1199, 500, true},
                 {900, 500, true},  {1200, 1200, false}, {1201, 1201, false}, {700, 500, true}};
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        assert_int_equal(recording_player_seek(player, CASES[i].position), RESULT_OK);
        assert_int_equal(recording_player_position(player), CASES[i].position);
        assert_int_equal(held.word[TOY_WORDS - 1], CASES[i].shown);
        assert_int_equal(recording_player_is_in_gap(player), CASES[i].gap);
    }
    recording_player_destroy(&player);
    recording_reader_close(&reader);
    unlink(path);
}

static double ms_since(int64_t begin_ns) {
    return (double)(clock_now_ns() - begin_ns) * 1e-6;
}

typedef struct Counted {
    Toy toy;
    uint32_t steps; // that it was flown
} Counted;

static void count_step(void *user, const Controls *controls) {
    Counted *counted = user;
    toy_step(&counted->toy, controls);
    counted->steps++;
}

static void test_a_seek_in_three_hours_flies_from_the_nearest_keyframe(void **state) {
    (void)state;
    char path[128];
    uint32_t steps = 3 * 3600 * RECORDING_STEPS_PER_S;
    uint64_t random = 14;
    double worst_ms = 0.0, total_ms = 0.0;
    uint32_t most_steps = 0;
    RecordingReader *reader;
    RecordingPlayer *player;
    support_path("long", path);
    support_record(path, 14, steps);
    Counted held = {.toy = toy_create(1)};
    RecordingSim sim = toy_sim(&held.toy);
    sim.step = count_step;
    int64_t begin_ns = clock_now_ns();
    assert_int_equal(recording_reader_open(path, &reader), RESULT_OK);
    double open_ms = ms_since(begin_ns);
    assert_int_equal(recording_reader_end(reader), steps);
    assert_int_equal(recording_player_create(reader, &sim, &player), RESULT_OK);
    for (int i = 0; i < 100; i++) {
        uint32_t at = (uint32_t)(support_random(&random) % steps);
        begin_ns = clock_now_ns();
        held.steps = 0;
        assert_int_equal(recording_player_seek(player, at), RESULT_OK);
        most_steps = held.steps > most_steps ? held.steps : most_steps;
        double ms = ms_since(begin_ns);
        total_ms += ms;
        worst_ms = ms > worst_ms ? ms : worst_ms;
        assert_int_equal(held.toy.word[TOY_WORDS - 1], at);
    }
    print_message("3 h: opened and checked in %.1f ms; seeks: mean %.2f ms, longest %.2f ms, %u steps flown at most\n",
                  open_ms, total_ms / 100, worst_ms, most_steps);
    assert_true(most_steps > 0 && most_steps <= RECORDING_KEYFRAME_STEPS);
    recording_player_destroy(&player);
    recording_reader_close(&reader);
    unlink(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_replay_has_the_hash_of_the_flight),
        cmocka_unit_test(test_the_first_difference_is_found_at_its_step),
        cmocka_unit_test(test_a_changed_input_is_found_too),
        cmocka_unit_test(test_another_flight_model_is_refused),
        cmocka_unit_test(test_winds_and_new_starts_are_flown_again),
        cmocka_unit_test(test_reverse_play_and_leaps_show_the_states_of_the_flight),
        cmocka_unit_test(test_the_player_remembers_the_first_difference),
        cmocka_unit_test(test_a_gap_is_shown_as_one),
        cmocka_unit_test(test_a_seek_in_three_hours_flies_from_the_nearest_keyframe),
    };
    return cmocka_run_group_tests_name("test_recording_replay", tests, NULL, NULL);
}
