// The format of recorded flights: what is written is read back in few bytes, and what is damaged is found and told.
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "app/recording/recording_column.h"
#include "tests/heard.h"
#include "tests/recording_support.h"
#include "tests/recording_wrap.h"

#define HOUR (3600 * RECORDING_STEPS_PER_S)

// ---- codes ----

static void test_the_ends_the_middle_and_simple_shares_are_exact(void **state) {
    (void)state;
    static const double EXACT[] = {-1.0, -0.5, 0.0, 0.25, 0.5, 1.0};
    for (size_t i = 0; i < COUNT_OF(EXACT); i++) {
        double share = fabs(EXACT[i]);
        Controls flown = {EXACT[i], EXACT[i], EXACT[i], share, EXACT[i], share, share, share, i % 2};
        Controls back = recording_controls(recording_quantise(&flown));
        assert_memory_equal(&back.elevator, &flown.elevator, offsetof(Controls, gear_up));
        assert_int_equal(back.gear_up, flown.gear_up);
    }
    Controls third = {.flaps = 1.0 / 3.0, .brake_left = 2.0 / 5.0};
    Controls back = recording_controls(recording_quantise(&third));
    assert_true(back.flaps == third.flaps && back.brake_left == third.brake_left);
}

static void test_codes_are_near_and_stay_as_they_are(void **state) {
    (void)state;
    uint64_t random = 1;
    double worst = 0.0;
    for (int i = 0; i < 20000; i++) {
        double x = (double)(support_random(&random) >> 11) * 0x1p-52 - 1.0;
        Controls flown = {x, -x, x * x, fabs(x), x / 2, fabs(x), fabs(x), x * x, false};
        ControlsCode code = recording_quantise(&flown);
        Controls back = recording_controls(code);
        ControlsCode again = recording_quantise(&back);
        assert_memory_equal(&again, &code, sizeof code);
        worst = fmax(worst, fmax(fabs(back.elevator - flown.elevator), fabs(back.aileron - flown.aileron)));
        if (fabs(back.flaps - flown.flaps) > 0.5 / 240 + 1e-12)
            fail_msg("flaps %.17g, recorded %.17g", flown.flaps, back.flaps);
    }
    print_message("stick: at most %.3g of full deflection away\n", worst);
    assert_true(worst <= 0.5 / 4096);
}

static void test_what_is_no_deflection_becomes_one(void **state) {
    (void)state;
    Controls wild = {NAN, INFINITY, -INFINITY, -1.0, 1e300, 7.0, NAN, -0.1, true};
    Controls back = recording_controls(recording_quantise(&wild)), expected = {0, 1, -1, 0, 1, 1, 0, 0, true};
    assert_memory_equal(&back.elevator, &expected.elevator, offsetof(Controls, gear_up));
}

// ---- columns ----

typedef int16_t Shape(int i, uint64_t *random);
static int16_t shape_constant(int i, uint64_t *random) {
    return (void)i, (void)random, -7;
}
static int16_t shape_any(int i, uint64_t *random) {
    return (void)i, (int16_t)support_random(random);
}
static int16_t shape_ends(int i, uint64_t *random) {
    return (void)i, support_random(random) & 1 ? INT16_MAX : INT16_MIN;
}
static int16_t shape_line(int i, uint64_t *random) {
    return (void)random, (int16_t)(i * 31 - 9000);
}
static int16_t shape_coarse(int i, uint64_t *random) {
    return (int16_t)(33 * ((i / 4) % 20 + (int)(support_random(random) % 2)));
}
static int16_t shape_step(int i, uint64_t *random) {
    return (void)random, i < 41 ? 0 : 1;
}

static const struct {
    const char *name;
    Shape *shape;
    size_t bytes_max; // of 100 steps
} SHAPES[] = {{"constant", shape_constant, 3}, {"any", shape_any, 210},      {"ends", shape_ends, 30},
              {"line", shape_line, 22},        {"coarse", shape_coarse, 60}, {"step", shape_step, 16}};

static void test_columns_come_back_whatever_they_hold(void **state) {
    (void)state;
    static const int COUNTS[] = {0, 1, 2, 3, 100, RECORDING_COLUMN_STEPS_MAX};
    static uint8_t bytes[(RECORDING_COLUMN_HEAD_BITS + RECORDING_COLUMN_STEPS_MAX * RECORDING_COLUMN_STEP_BITS) / 8];
    int16_t values[RECORDING_COLUMN_STEPS_MAX], back[RECORDING_COLUMN_STEPS_MAX];
    uint64_t random = 3;
    for (size_t k = 0; k < COUNT_OF(SHAPES) * COUNT_OF(COUNTS); k++) {
        int count = COUNTS[k % COUNT_OF(COUNTS)];
        size_t shape = k / COUNT_OF(COUNTS);
        for (int i = 0; i < count; i++)
            values[i] = SHAPES[shape].shape(i, &random);
        memset(bytes, 0, sizeof bytes);
        RecordingBits to = {.bytes = bytes, .bits = 8 * sizeof bytes}, from = to;
        recording_column_write(&to, values, count);
        assert_false(to.over);
        assert_true(recording_column_read(&from, back, count));
        assert_int_equal(from.bit, to.bit);
        assert_memory_equal(back, values, sizeof values[0] * (size_t)count);
        if (count == 100)
            print_message("column %s: %zu bytes, at most %zu\n", SHAPES[shape].name, to.bit / 8 + 1,
                          SHAPES[shape].bytes_max);
        assert_true(count != 100 || to.bit / 8 + 1 <= SHAPES[shape].bytes_max);
    }
}

// ---- size ----

static size_t record_stick(const char *path, int bits, double noise, uint32_t steps) {
    RecordingHeader header = toy_header();
    Toy toy = toy_create(5);
    Pilot pilot = pilot_create(5, bits, noise);
    RecordingWriter *writer;
    assert_int_equal(recording_writer_create(&header, path, &toy, &writer), RESULT_OK);
    support_fly_and_wait(writer, &toy, &pilot, steps);
    assert_int_equal(recording_writer_close(&writer), RESULT_OK);
    size_t count;
    free(support_load(path, &count));
    return count;
}

static void test_an_hour_of_a_restless_stick_takes_less_than_2_MB(void **state) {
    (void)state;
    char path[128];
    support_path("hour", path);
    size_t bytes = record_stick(path, 12, 0.8, HOUR);
    print_message("an hour, four axes of 12 bits moved all the time, noise 0.8 steps: %zu bytes, limit 2000000\n",
                  bytes);
    assert_true(bytes < 2000000);
    RecordingReader *reader;
    assert_int_equal(recording_reader_open(path, &reader), RESULT_OK);
    assert_int_equal(recording_reader_first(reader), 0);
    assert_int_equal(recording_reader_end(reader), HOUR);
    Toy toy = toy_create(5);
    Pilot pilot = pilot_create(5, 12, 0.8);
    uint64_t hash = RECORDING_HASH_BEGIN;
    for (uint32_t i = 0; i < HOUR; i += 100) {
        RecordingStep steps[100];
        assert_int_equal(recording_reader_steps(reader, i, 100, steps), RESULT_OK);
        for (int k = 0; k < 100; k++) {
            Controls moved = pilot_move(&pilot);
            ControlsCode code = recording_quantise(&moved);
            Controls controls = recording_controls(code);
            toy_step(&toy, &controls);
            hash = recording_hash_next(hash, toy_hash(&toy));
            assert_true(steps[k].known && steps[k].hash == recording_hash_short(hash));
            assert_memory_equal(&steps[k].code, &code, sizeof code);
        }
    }
    recording_reader_close(&reader);
    unlink(path);
}

static void test_other_sticks_take_about_as_much(void **state) {
    (void)state;
    static const struct {
        int bits;
        double noise;
    } STICKS[] = {{8, 0.3}, {10, 0.3}, {10, 1.0}, {12, 0.0}, {12, 1.5}, {14, 1.0}, {16, 8.0}, {16, 100.0}};
    char path[128];
    support_path("stick", path);
    for (size_t i = 0; i < COUNT_OF(STICKS); i++) {
        size_t bytes = record_stick(path, STICKS[i].bits, STICKS[i].noise, HOUR / 12) * 12;
        print_message("%d bits, noise %g steps: %.2f MB an hour\n", STICKS[i].bits, STICKS[i].noise,
                      1e-6 * (double)bytes);
        assert_true(bytes < 2700000);
    }
    unlink(path);
}

// ---- what a file says of itself ----

static Result open_heard(const char *path, RecordingReader **reader, Heard *heard) {
    *reader = NULL;
    heard_begin(heard);
    Result result = recording_reader_open(path, reader);
    heard_end();
    return result;
}

static void expect_refusal(const char *path, Result expected, const char *words) {
    RecordingReader *reader;
    Heard heard;
    Result result = open_heard(path, &reader, &heard);
    if (result != expected || heard.errors != 1 || !strstr(heard.text, path) || !strstr(heard.text, words))
        fail_msg("%s, said '%s'; expected %s with '%s'", result_name(result), heard.text, result_name(expected), words);
    assert_null(reader);
}

static void test_the_environment_is_read_back(void **state) {
    (void)state;
    char path[128], longest[3000];
    support_path("header", path);
    memset(longest, 'x', sizeof longest);
    longest[sizeof longest - 1] = '\0';
    RecordingHeader header = toy_header(), other;
    recording_header_set(&header, RECORDING_WEATHER, "wind 270 at 12\nformat=other");
    recording_header_set(&header, RECORDING_DEM, "%s", longest);
    recording_header_set(&header, RECORDING_BOUNDS, "%d", 42);
    Toy toy = toy_create(1);
    Pilot pilot = pilot_create(1, 12, 0.5);
    RecordingWriter *writer;
    RecordingReader *reader;
    assert_int_equal(recording_writer_create(&header, path, &toy, &writer), RESULT_OK);
    support_fly(writer, &toy, &pilot, 10);
    assert_int_equal(recording_writer_close(&writer), RESULT_OK);
    assert_int_equal(recording_reader_open(path, &reader), RESULT_OK);
    other = *recording_reader_header(reader);
    assert_int_equal(other.state_bytes, sizeof(Toy));
    assert_int_equal(recording_header_difference(&header, &other, (RecordingKey)0), RECORDING_KEY_COUNT);
    assert_string_equal(other.environment[RECORDING_WEATHER], "wind 270 at 12 format=other");
    assert_string_equal(other.environment[RECORDING_DEM] + RECORDING_VALUE_BYTES - 6, "xx...");
    recording_header_set(&other, RECORDING_BOUNDS, "43");
    assert_string_equal(recording_key_name(recording_header_difference(&header, &other, (RecordingKey)0)), "bounds");
    recording_reader_close(&reader);
    unlink(path);
}

static void replace_text(uint8_t *bytes, size_t count, const char *old, const char *new) {
    size_t length = strlen(old);
    for (size_t i = 0; i + length <= count; i++) {
        if (memcmp(bytes + i, old, length) != 0)
            continue;
        memcpy(bytes + i, new, length);
        wrap_correct(bytes, count);
        return;
    }
    fail_msg("'%s' is not in the file", old);
}

static void test_what_cannot_be_read_is_refused_with_the_reason(void **state) {
    (void)state;
    static const struct {
        const char *old, *new, *words;
        Result result;
    } CASES[] = {
        {"OFR\r\n", "OFR\n\n", "byte 0: not a recording", RESULT_FORMAT},
        {"column=trim i16 1/8192", "column=trim i16 1/9999", "column 5 is 'trim i16 1/9999'", RESULT_UNSUPPORTED},
        {"column=bits", "colour=bits", "column 9 is 'missing'", RESULT_UNSUPPORTED},
        {"steps_per_s=120", "steps_per_s=000", "steps_per_s is '000', expected 1 to 1000", RESULT_FORMAT},
        {"chunk_steps=100", "chunk_steps=-10", "chunk_steps is '-10', expected 1 to 1024", RESULT_FORMAT},
        {"state_bytes=512", "state-bytes=512", "does not say 'state_bytes'", RESULT_FORMAT},
    };
    char path[128];
    size_t count;
    support_path("refused", path);
    support_record(path, 1, 150);
    uint8_t *bytes = support_load(path, &count), *changed = malloc(count);
    assert_non_null(changed);
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        memcpy(changed, bytes, count);
        replace_text(changed, count, CASES[i].old, CASES[i].new);
        support_store(path, changed, count);
        expect_refusal(path, CASES[i].result, CASES[i].words);
    }
    memcpy(changed, bytes, count);
    changed[8] = 2;
    support_store(path, changed, count);
    expect_refusal(path, RESULT_UNSUPPORTED, "version 2 of the format, this program reads version 1");
    memcpy(changed, bytes, count);
    changed[40] ^= 1;
    support_store(path, changed, count);
    expect_refusal(path, RESULT_FORMAT, "nothing after it can be read: use another copy of the file");
    free(changed);
    free(bytes);
    unlink(path);
    expect_refusal("no-such.ofr", RESULT_NOT_FOUND, "cannot be opened");
    expect_refusal(".", RESULT_UNSUPPORTED, "a folder");
}

// ---- damage ----

static Result verify_toy(RecordingReader *reader, RecordingVerdict *verdict) {
    Toy toy = toy_create(99);
    RecordingSim sim = toy_sim(&toy);
    return recording_verify(reader, &sim, verdict);
}

// Where the chunks of a sound file begin, and how many steps are whole before each; -1 in the end.
typedef struct Places {
    size_t at[64], end[64];
    uint32_t first[64], count[64];
    int chunks;
} Places;

static Places find_places(const uint8_t *bytes, size_t count) {
    Places places = {.chunks = 0};
    size_t at = WRAP_TEXT_AT + recording_get32(bytes + 12) + 4;
    while (at < count && places.chunks < 64) {
        int i = places.chunks;
        assert_int_equal(recording_get32(bytes + at), RECORDING_SYNC);
        places.at[i] = at;
        places.count[i] = recording_get16(bytes + at + 6);
        places.first[i] = recording_get32(bytes + at + 8);
        at = places.end[i] = at + RECORDING_CHUNK_HEADER_BYTES + recording_get32(bytes + at + 12);
        places.chunks += bytes[places.at[i] + 4] == RECORDING_CHUNK_FLIGHT;
    }
    return places;
}

static void test_a_file_cut_off_at_any_byte_keeps_all_whole_chunks(void **state) {
    (void)state;
    char path[128];
    size_t count;
    support_path("cut", path);
    support_record(path, 2, 330);
    uint8_t *bytes = support_load(path, &count);
    Places places = find_places(bytes, count);
    assert_int_equal(places.chunks, 4);
    for (size_t length = 0; length < count; length++) {
        RecordingReader *reader;
        Heard heard;
        uint32_t expected = 0;
        support_store(path, bytes, length);
        for (int i = 0; i < places.chunks; i++)
            expected = places.end[i] <= length ? places.first[i] + places.count[i] : expected;
        Result result = open_heard(path, &reader, &heard);
        if (result != (expected > 0 ? RESULT_OK : RESULT_FORMAT))
            fail_msg("%zu of %zu bytes: %s", length, count, result_name(result));
        if (expected == 0)
            continue;
        RecordingVerdict verdict;
        const RecordingDamage *damages;
        bool at_border =
            length == places.end[0] || length == places.end[1] || length == places.end[2] || length == places.end[3];
        assert_int_equal(recording_reader_end(reader), expected);
        assert_false(recording_reader_was_closed(reader));
        assert_non_null(strstr(heard.text, "not closed in good order"));
        assert_int_equal(recording_reader_damages(reader, &damages), at_border ? 0 : 1);
        assert_true(at_border || damages[0].kind == RECORDING_CUT_OFF);
        assert_int_equal(verify_toy(reader, &verdict), RESULT_OK);
        assert_true(verdict.equal && verdict.steps == expected && verdict.hash == verdict.expected_hash);
        recording_reader_close(&reader);
    }
    free(bytes);
    unlink(path);
}

static void test_a_damaged_chunk_is_a_gap_until_the_next_keyframe(void **state) {
    (void)state;
    char path[128];
    size_t count;
    support_path("damage", path);
    support_record(path, 3, 3000);
    uint8_t *bytes = support_load(path, &count);
    Places places = find_places(bytes, count);
    bytes[places.at[4] + RECORDING_CHUNK_HEADER_BYTES + 30] ^= 0x10;
    support_store(path, bytes, count);
    RecordingReader *reader;
    RecordingVerdict verdict;
    const RecordingDamage *damages;
    Heard heard;
    assert_int_equal(open_heard(path, &reader, &heard), RESULT_OK);
    assert_int_equal(heard.warnings, 2);
    assert_non_null(strstr(heard.text, "steps 400 to 499 (0:00:03 to 0:00:04) are damaged"));
    assert_non_null(strstr(heard.text, "steps 500 to 1199"));
    assert_int_equal(recording_reader_damages(reader, &damages), 2);
    assert_int_equal(damages[0].kind, RECORDING_DAMAGED);
    assert_int_equal(damages[0].offset, places.at[4]);
    assert_int_equal(damages[0].bytes, places.end[4] - places.at[4]);
    assert_int_equal(damages[1].kind, RECORDING_STATELESS);
    RecordingStep steps[3];
    assert_int_equal(recording_reader_steps(reader, 498, 3, steps), RESULT_OK);
    assert_true(!steps[0].known && !steps[1].known && steps[2].known);
    assert_int_equal(verify_toy(reader, &verdict), RESULT_OK);
    print_message("one bit in one chunk: %u of 3000 steps cannot be replayed, the others are equal: %d\n",
                  verdict.steps_missing, verdict.equal);
    assert_int_equal(verdict.steps_missing, 800);
    assert_true(verdict.equal && verdict.hash == verdict.expected_hash);
    recording_reader_close(&reader);
    free(bytes);
    unlink(path);
}

static void test_a_chunk_that_lost_a_byte_does_not_take_the_next_one_along(void **state) {
    (void)state;
    char path[128];
    size_t count;
    support_path("lost", path);
    support_record(path, 3, 1000);
    uint8_t *bytes = support_load(path, &count);
    Places places = find_places(bytes, count);
    size_t hole = places.at[2] + 50;
    memmove(bytes + hole, bytes + hole + 1, count - hole - 1);
    support_store(path, bytes, count - 1);
    RecordingReader *reader;
    const RecordingDamage *damages;
    Heard heard;
    assert_int_equal(open_heard(path, &reader, &heard), RESULT_OK);
    assert_int_equal(recording_reader_damages(reader, &damages), 2);
    assert_int_equal(damages[0].first_step, 200);
    assert_int_equal(damages[0].steps, 100);
    assert_int_equal(recording_reader_end(reader), 1000);
    assert_true(recording_reader_was_closed(reader));
    recording_reader_close(&reader);
    free(bytes);
    unlink(path);
}

// ---- mutations ----

static size_t mutate(uint8_t *bytes, size_t count, size_t room, uint64_t *random) {
    int changes = 1 + (int)(support_random(random) % 4);
    for (int i = 0; i < changes; i++) {
        size_t at = support_random(random) % count, length = 1 + support_random(random) % 40;
        length = length < count - at ? length : count - at;
        switch (support_random(random) % 4) {
        case 0:
            bytes[at] ^= (uint8_t)(1u << support_random(random) % 8);
            break;
        case 1: // a piece is lost
            if (count - length < 8)
                break;
            memmove(bytes + at, bytes + at + length, count - at - length);
            count -= length;
            break;
        case 2: // a piece is there twice
            if (count + length > room)
                break;
            memmove(bytes + at + length, bytes + at, count - at);
            count += length;
            break;
        default:
            memset(bytes + at, (int)(support_random(random) % 3) * 127, length);
        }
    }
    return count;
}

// What a mutated file still gives is what was recorded: checksums let nothing else through.
static void check_known_steps(RecordingReader *reader, const RecordingStep *original, uint32_t count) {
    static RecordingStep steps[1000];
    assert_int_equal(recording_reader_steps(reader, 0, count, steps), RESULT_OK);
    for (uint32_t i = 0; i < count; i++)
        if (steps[i].known && memcmp(&steps[i], &original[i], sizeof steps[i]) != 0)
            fail_msg("step %u is another one", i);
}

static void test_mutated_files_are_read_rightly_or_refused(void **state) {
    (void)state;
    static RecordingStep original[1000];
    char path[128];
    size_t count, room;
    uint64_t random = 20;
    int opened = 0, rounds = 1500;
    support_path("mutated", path);
    support_record(path, 4, 1000);
    RecordingReader *reader;
    assert_int_equal(recording_reader_open(path, &reader), RESULT_OK);
    assert_int_equal(recording_reader_steps(reader, 0, 1000, original), RESULT_OK);
    recording_reader_close(&reader);
    uint8_t *bytes = support_load(path, &count), *changed = malloc(room = count + 200);
    assert_non_null(changed);
    for (int i = 0; i < rounds; i++) {
        Heard heard;
        RecordingVerdict verdict;
        memcpy(changed, bytes, count);
        support_store(path, changed, mutate(changed, count, room, &random));
        if (open_heard(path, &reader, &heard) != RESULT_OK) {
            assert_int_equal(heard.errors, 1);
            continue;
        }
        opened++;
        check_known_steps(reader, original, 1000);
        assert_int_equal(verify_toy(reader, &verdict), RESULT_OK);
        assert_true(verdict.equal);
        recording_reader_close(&reader);
    }
    print_message("seed 20: %d of %d mutated files open\n", opened, rounds);
    assert_true(opened > rounds / 10 && opened < rounds);
    free(changed);
    free(bytes);
    unlink(path);
}

// The sound file again, with changed contents in its chunks behind right checksums, as of someone who means harm.
static size_t wrap_mutated(RecordingZstd *zstd, const uint8_t *bytes, size_t count, uint8_t *out, uint64_t *random) {
    static uint8_t content[8000];
    Places places = find_places(bytes, count);
    size_t used = places.at[0];
    memcpy(out, bytes, used);
    uint32_t crc = recording_get32(out + used - 4);
    for (int i = 0; i < places.chunks; i++) {
        const uint8_t *head = bytes + places.at[i];
        size_t length;
        assert_true(recording_zstd_decompress(zstd, head + RECORDING_CHUNK_HEADER_BYTES, recording_get32(head + 12),
                                              content, sizeof content, &length));
        RecordingChunkHeader header = {head[4], head[5], recording_get16(head + 6), recording_get32(head + 8), 0};
        for (int k = (int)(support_random(random) % 3); k > 0; k--)
            length = mutate(content, length, sizeof content, random);
        if (support_random(random) % 8 == 0)
            header.first += (uint32_t)(support_random(random) % 3 * 50);
        if (support_random(random) % 8 == 0)
            header.flags = (uint8_t)(support_random(random) % 4);
        used += wrap_chunk(zstd, crc, header, content, length, out + used, 20000 - used);
    }
    return used;
}

static void test_nonsense_behind_right_checksums_does_no_harm(void **state) {
    (void)state;
    static uint8_t changed[20000];
    RecordingZstd *zstd;
    char path[128];
    size_t count;
    uint64_t random = 21;
    int opened = 0, differ = 0, rounds = 1500;
    support_path("nonsense", path);
    support_record(path, 4, 1000);
    uint8_t *bytes = support_load(path, &count);
    assert_int_equal(recording_zstd_create(8000, &zstd), RESULT_OK);
    for (int round = 0; round < rounds; round++) {
        RecordingReader *reader;
        RecordingVerdict verdict = {.equal = true};
        Heard heard;
        support_store(path, changed, wrap_mutated(zstd, bytes, count, changed, &random));
        if (open_heard(path, &reader, &heard) != RESULT_OK)
            continue;
        opened++;
        heard_begin(&heard);
        Result result = verify_toy(reader, &verdict);
        heard_end();
        assert_true(result == RESULT_OK || result == RESULT_FORMAT); // a state that the toy refuses
        differ += !verdict.equal;
        recording_reader_close(&reader);
    }
    print_message("seed 21: %d of %d files open, %d differ\n", opened, rounds, differ);
    assert_true(opened > rounds / 10 && differ > 0);
    recording_zstd_destroy(&zstd);
    free(bytes);
    unlink(path);
}

static void test_a_frame_that_claims_gigabytes_is_damage(void **state) {
    (void)state;
    char path[128];
    size_t count;
    support_path("claims", path);
    support_record(path, 3, 250);
    uint8_t *bytes = support_load(path, &count);
    Places places = find_places(bytes, count);
    uint8_t *frame = bytes + places.at[1] + RECORDING_CHUNK_HEADER_BYTES;
    frame[4] = 0xE4; // content size of 8 bytes, one segment, checksum (RFC 8878 3.1.1.1.1)
    memset(frame + 5, 0x7F, 8);
    support_store(path, bytes, count);
    RecordingReader *reader;
    const RecordingDamage *damages;
    Heard heard;
    assert_int_equal(open_heard(path, &reader, &heard), RESULT_OK);
    assert_int_equal(recording_reader_damages(reader, &damages), 2);
    assert_int_equal(damages[0].first_step, 100);
    recording_reader_close(&reader);
    free(bytes);
    unlink(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_ends_the_middle_and_simple_shares_are_exact),
        cmocka_unit_test(test_codes_are_near_and_stay_as_they_are),
        cmocka_unit_test(test_what_is_no_deflection_becomes_one),
        cmocka_unit_test(test_columns_come_back_whatever_they_hold),
        cmocka_unit_test(test_an_hour_of_a_restless_stick_takes_less_than_2_MB),
        cmocka_unit_test(test_other_sticks_take_about_as_much),
        cmocka_unit_test(test_the_environment_is_read_back),
        cmocka_unit_test(test_what_cannot_be_read_is_refused_with_the_reason),
        cmocka_unit_test(test_a_file_cut_off_at_any_byte_keeps_all_whole_chunks),
        cmocka_unit_test(test_a_damaged_chunk_is_a_gap_until_the_next_keyframe),
        cmocka_unit_test(test_a_chunk_that_lost_a_byte_does_not_take_the_next_one_along),
        cmocka_unit_test(test_mutated_files_are_read_rightly_or_refused),
        cmocka_unit_test(test_nonsense_behind_right_checksums_does_no_harm),
        cmocka_unit_test(test_a_frame_that_claims_gigabytes_is_damage),
    };
    return cmocka_run_group_tests_name("test_recording", tests, NULL, NULL);
}
