// Recording while a flight goes on: killed programs, full and stuck disks, the last ten minutes.
#define _GNU_SOURCE // pipe sizes
#include <fcntl.h>
#include <malloc.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/clock.h"
#include "tests/heard.h"
#include "tests/recording_support.h"

#define MINUTE (60 * RECORDING_STEPS_PER_S)
#define STUCK_STEPS (40 * MINUTE)
#define STEP_NS (1000000000 / RECORDING_STEPS_PER_S)

static RecordingWriter *begin(const char *path, Toy *toy, uint64_t seed) {
    RecordingHeader header = toy_header();
    RecordingWriter *writer;
    *toy = toy_create(seed);
    assert_int_equal(recording_writer_create(&header, path, toy, &writer), RESULT_OK);
    return writer;
}

static RecordingVerdict open_and_verify(const char *path, RecordingReader **reader) {
    Toy toy = toy_create(99);
    RecordingSim sim = toy_sim(&toy);
    RecordingVerdict verdict;
    assert_int_equal(recording_reader_open(path, reader), RESULT_OK);
    assert_int_equal(recording_verify(*reader, &sim, &verdict), RESULT_OK);
    assert_true(verdict.equal);
    return verdict;
}

static void sleep_ms(int ms) {
    clock_sleep_until_ns(clock_now_ns() + ms * INT64_C(1000000));
}

static void wait_for_saving(RecordingWriter *writer, RecordingSaving expected) {
    for (int i = 0; i < 5000 && recording_writer_saving(writer) == RECORDING_SAVING_GOES_ON; i++)
        sleep_ms(2);
    assert_int_equal(recording_writer_saving(writer), expected);
}

// ---- killed ----

// Flies in real time and says how far it has come, until it is killed.
static void fly_for_ever(const char *path, uint64_t seed, atomic_uint *flown) {
    RecordingHeader header = toy_header();
    Toy toy = toy_create(seed);
    Pilot pilot = pilot_create(seed, 12, 0.8);
    RecordingWriter *writer;
    if (recording_writer_create(&header, path, &toy, &writer) != RESULT_OK)
        _exit(1);
    int64_t begin_ns = clock_now_ns();
    for (int i = 1;; i++) {
        support_fly(writer, &toy, &pilot, 1);
        atomic_store(flown, (unsigned)i);
        clock_sleep_until_ns(begin_ns + (int64_t)i * STEP_NS);
    }
}

static void check_killed(const char *path, uint32_t flown) {
    RecordingReader *reader;
    RecordingVerdict verdict = open_and_verify(path, &reader);
    uint32_t lost = flown - recording_reader_end(reader);
    print_message("killed after %u steps: %u lost, at most %d\n", flown, lost, RECORDING_STEPS_PER_S);
    assert_true(lost <= RECORDING_STEPS_PER_S);
    assert_false(recording_reader_was_closed(reader));
    assert_int_equal(verdict.steps, recording_reader_end(reader));
    recording_reader_close(&reader);
}

static void test_a_killed_program_loses_at_most_a_second(void **state) {
    (void)state;
    enum { PROGRAMS = 4 };
    static const uint32_t KILL_AT[PROGRAMS] = {199, 201, 270, 305};
    atomic_uint *flown =
        mmap(NULL, PROGRAMS * sizeof *flown, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    char paths[PROGRAMS][128], name[24];
    pid_t children[PROGRAMS];
    assert_true(flown != MAP_FAILED);
    for (int i = 0; i < PROGRAMS; i++) {
        snprintf(name, sizeof name, "killed%d", i);
        support_path(name, paths[i]);
        children[i] = fork();
        assert_true(children[i] >= 0);
        if (children[i] == 0)
            fly_for_ever(paths[i], (uint64_t)i, &flown[i]);
    }
    for (int i = 0; i < PROGRAMS; i++) {
        int status;
        for (int k = 0; k < 20000 && atomic_load(&flown[i]) < KILL_AT[i]; k++)
            sleep_ms(1);
        kill(children[i], SIGKILL);
        assert_int_equal(waitpid(children[i], &status, 0), children[i]);
        assert_true(WIFSIGNALED(status));
        check_killed(paths[i], atomic_load(&flown[i]));
        unlink(paths[i]);
    }
    munmap(flown, PROGRAMS * sizeof *flown);
}

// ---- full ----

static void limit_files(rlim_t bytes) {
    struct rlimit limit;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    limit.rlim_cur = bytes < limit.rlim_max ? bytes : limit.rlim_max;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

// Flies until the disk is full, at most two minutes, at ten times the speed of time.
static void fly_until_full(RecordingWriter *writer, Toy *toy, Pilot *pilot) {
    for (int i = 0; i < 1200 && !recording_writer_failed(writer); i++) {
        support_fly(writer, toy, pilot, RECORDING_STEPS_PER_S / 10);
        sleep_ms(1);
    }
    assert_true(recording_writer_failed(writer));
}

static void test_a_full_disk_is_told_once_and_the_flight_goes_on(void **state) {
    (void)state;
    char path[128];
    Toy toy;
    Heard heard;
    RecordingReader *reader;
    Pilot pilot = pilot_create(31, 12, 0.8);
    support_path("full", path);
    RecordingWriter *writer = begin(path, &toy, 31);
    limit_files(10000);
    heard_begin(&heard);
    fly_until_full(writer, &toy, &pilot);
    support_fly(writer, &toy, &pilot, 10 * RECORDING_STEPS_PER_S);
    uint32_t steps = recording_writer_steps(writer);
    Result result = recording_writer_close(&writer);
    heard_end();
    limit_files(RLIM_INFINITY);
    print_message("%s", heard.text);
    assert_int_equal(result, RESULT_IO);
    assert_int_equal(heard.errors, 2); // when it was full, and what is missing in the end
    assert_non_null(strstr(heard.text, path));
    assert_non_null(strstr(heard.text, "cannot be written: File too large"));
    assert_non_null(strstr(heard.text, "steps are missing in it"));
    RecordingVerdict verdict = open_and_verify(path, &reader);
    assert_true(verdict.steps > 0 && verdict.steps < steps);
    recording_reader_close(&reader);
    unlink(path);
}

static void test_a_file_catches_up_when_there_is_room_again(void **state) {
    (void)state;
    char path[128];
    Toy toy;
    Heard heard;
    RecordingReader *reader;
    Pilot pilot = pilot_create(32, 12, 0.8);
    support_path("room", path);
    RecordingWriter *writer = begin(path, &toy, 32);
    limit_files(10000);
    heard_begin(&heard);
    fly_until_full(writer, &toy, &pilot);
    support_fly(writer, &toy, &pilot, 5 * MINUTE);
    limit_files(RLIM_INFINITY);
    for (int i = 0; i < 1000 && recording_writer_failed(writer); i++) {
        support_fly(writer, &toy, &pilot, RECORDING_STEPS_PER_S);
        sleep_ms(5);
    }
    assert_false(recording_writer_failed(writer));
    uint32_t steps = recording_writer_steps(writer);
    uint64_t hash = recording_writer_hash(writer);
    Result result = recording_writer_close(&writer);
    heard_end();
    assert_int_equal(result, RESULT_OK);
    assert_int_equal(heard.errors, 1);
    RecordingVerdict verdict = open_and_verify(path, &reader);
    print_message("%u of %u steps are in the file\n", verdict.steps, steps);
    assert_true(verdict.steps == steps && verdict.hash == hash && recording_reader_was_closed(reader));
    recording_reader_close(&reader);
    unlink(path);
}

static void expect_no_writer(const char *path, Result expected, const char *words) {
    RecordingHeader header = toy_header();
    Toy toy = toy_create(1);
    RecordingWriter *writer = NULL;
    Heard heard;
    heard_begin(&heard);
    Result result = recording_writer_create(&header, path, &toy, &writer);
    heard_end();
    if (result != expected || heard.errors != 1 || !strstr(heard.text, words))
        fail_msg("%s: %s, said '%s'; expected %s with '%s'", path, result_name(result), heard.text,
                 result_name(expected), words);
    assert_null(writer);
}

static void test_a_place_that_cannot_be_written_is_told_at_once(void **state) {
    (void)state;
    expect_no_writer("no-such-folder/flight.ofr", RESULT_NOT_FOUND, "no-such-folder/flight.ofr: cannot be created");
    expect_no_writer(".", RESULT_IO, "cannot be created");
    if (access("/dev/full", W_OK) == 0)
        expect_no_writer("/dev/full", RESULT_IO, "/dev/full: byte 0: cannot be written: No space left on device");
}

// ---- stuck ----

typedef struct Drain {
    int pipe;
    uint8_t *bytes;
    size_t count, room;
} Drain;

static void *drain(void *user) {
    Drain *self = user;
    ssize_t got;
    while (self->count < self->room &&
           (got = read(self->pipe, self->bytes + self->count, self->room - self->count)) > 0)
        self->count += (size_t)got;
    return NULL;
}

// A pipe that nobody empties takes no more, as a disk that hangs: 40 minutes are flown meanwhile.
static void test_a_stuck_disk_holds_up_nobody(void **state) {
    (void)state;
    char fifo[128], path[128];
    Toy toy;
    Heard heard;
    RecordingReader *reader;
    Pilot pilot = pilot_create(33, 12, 0.8);
    Drain self = {.room = 4 << 20};
    pthread_t thread;
    support_path("stuck-pipe", fifo);
    support_path("stuck", path);
    assert_int_equal(mkfifo(fifo, 0600), 0);
    self.pipe = open(fifo, O_RDONLY | O_NONBLOCK);
    self.bytes = malloc(self.room);
    assert_true(self.pipe >= 0 && self.bytes);
    RecordingWriter *writer = begin(fifo, &toy, 33);
    heard_begin(&heard);
    int64_t begin_ns = clock_now_ns();
    support_fly(writer, &toy, &pilot, STUCK_STEPS);
    print_message("40 minutes flown in %.2f s, %llu bytes written\n", (double)(clock_now_ns() - begin_ns) * 1e-9,
                  (unsigned long long)recording_writer_file_bytes(writer));
    assert_true(recording_writer_file_bytes(writer) < 100000);
    assert_int_equal(fcntl(self.pipe, F_SETFL, 0), 0);
    assert_int_equal(pthread_create(&thread, NULL, drain, &self), 0);
    Result result = recording_writer_close(&writer);
    pthread_join(thread, NULL);
    assert_int_equal(result, RESULT_IO);
    support_store(path, self.bytes, self.count);
    RecordingVerdict verdict = open_and_verify(path, &reader);
    heard_end();
    const RecordingDamage *damages;
    print_message("%s%u steps missing, at most %d\n", heard.text, verdict.steps_missing,
                  STUCK_STEPS - RECORDING_KEPT_STEPS);
    assert_int_equal(recording_reader_damages(reader, &damages) >= 1, true);
    assert_int_equal(damages[0].kind, RECORDING_MISSING);
    assert_true(verdict.steps_missing > 0 && verdict.steps_missing <= STUCK_STEPS - RECORDING_KEPT_STEPS);
    assert_int_equal(recording_reader_end(reader), STUCK_STEPS);
    recording_reader_close(&reader);
    free(self.bytes);
    close(self.pipe);
    unlink(fifo);
    unlink(path);
}

// ---- the last ten minutes ----

static void check_saved(RecordingWriter *writer, const char *path, uint32_t first) {
    RecordingReader *reader;
    assert_int_equal(recording_writer_save(writer, path), RESULT_OK);
    wait_for_saving(writer, RECORDING_SAVING_DONE);
    RecordingVerdict verdict = open_and_verify(path, &reader);
    print_message("saved steps %u to %u, expected %u to %u\n", recording_reader_first(reader),
                  recording_reader_end(reader), first, recording_writer_steps(writer));
    assert_int_equal(recording_reader_first(reader), first);
    assert_int_equal(recording_reader_end(reader), recording_writer_steps(writer));
    assert_int_equal(verdict.steps_missing, 0);
    assert_true(verdict.hash == recording_writer_hash(writer) && recording_reader_was_closed(reader));
    recording_reader_close(&reader);
    unlink(path);
}

static void test_the_last_ten_minutes_can_be_saved_at_any_time(void **state) {
    (void)state;
    char path[128];
    Toy toy;
    Heard heard;
    Pilot pilot = pilot_create(34, 12, 0.8);
    support_path("saved", path);
    RecordingWriter *writer = begin(NULL, &toy, 34);
    heard_begin(&heard);
    assert_int_equal(recording_writer_save(writer, path), RESULT_RANGE);
    assert_non_null(strstr(heard.text, "nothing is recorded yet"));
    support_fly(writer, &toy, &pilot, 33);
    check_saved(writer, path, 0);
    support_fly(writer, &toy, &pilot, 5 * MINUTE);
    check_saved(writer, path, 0);
    support_fly(writer, &toy, &pilot, 20 * MINUTE + 7);
    uint32_t wanted = recording_writer_steps(writer) - RECORDING_KEPT_STEPS;
    check_saved(writer, path, wanted / RECORDING_KEYFRAME_STEPS * RECORDING_KEYFRAME_STEPS);
    assert_int_equal(heard.errors, 1);
    assert_int_equal(recording_writer_save(writer, "no-such-folder/saved.ofr"), RESULT_OK);
    wait_for_saving(writer, RECORDING_SAVING_FAILED);
    assert_non_null(strstr(heard.text, "no-such-folder/saved.ofr.part: cannot be created"));
    assert_false(recording_writer_failed(writer));
    assert_int_equal(recording_writer_close(&writer), RESULT_OK);
    heard_end();
}

// Inputs that cannot be compressed, and new starts all the time: the memory is bounded, what is kept can be replayed.
static void test_the_memory_holds_ten_minutes_of_the_wildest_stick(void **state) {
    (void)state;
    char path[128];
    Toy toy;
    uint64_t random = 35;
    support_path("wild", path);
    RecordingWriter *writer = begin(NULL, &toy, 35);
    for (int i = 0; i < 12 * MINUTE; i++) {
        uint64_t dice = support_random(&random), more = support_random(&random);
        ControlsCode code = {(int16_t)(dice % 8193 - 4096), (int16_t)((dice >> 16) % 8193 - 4096), 0, 0, 0, 0, 0, 0, 0};
        code.rudder = (int16_t)(more % 4097 - 2048);
        code.throttle = (int16_t)((more >> 16) % 2049);
        Controls controls = recording_controls(code);
        toy_step(&toy, &controls);
        recording_writer_step(writer, code, toy_hash(&toy), &toy);
    }
    check_saved(writer, path, 2 * MINUTE);
    for (int i = 0; i < 10000; i++) {
        toy = toy_create((uint64_t)i);
        recording_writer_restart(writer, RECORDING_EVENT_RESET, &toy);
        Controls controls = recording_controls((ControlsCode){.elevator = 1});
        toy_step(&toy, &controls);
        recording_writer_step(writer, (ControlsCode){.elevator = 1}, toy_hash(&toy), &toy);
    }
    RecordingReader *reader;
    assert_int_equal(recording_writer_save(writer, path), RESULT_OK);
    wait_for_saving(writer, RECORDING_SAVING_DONE);
    RecordingVerdict verdict = open_and_verify(path, &reader);
    print_message("after 10000 new starts: %u steps kept\n", verdict.steps);
    assert_true(verdict.steps > 1000 && verdict.steps_missing == 0);
    recording_reader_close(&reader);
    assert_int_equal(recording_writer_close(&writer), RESULT_OK);
    unlink(path);
}

static void test_the_state_is_wanted_every_ten_seconds(void **state) {
    (void)state;
    Toy toy;
    Pilot pilot = pilot_create(36, 12, 0.8);
    RecordingWriter *writer = begin(NULL, &toy, 36);
    int wanted = 0;
    for (int i = 0; i < MINUTE; i++) {
        Controls moved = pilot_move(&pilot);
        ControlsCode code = recording_quantise(&moved);
        Controls controls = recording_controls(code);
        bool wants = recording_writer_wants_state(writer);
        wanted += wants;
        toy_step(&toy, &controls);
        recording_writer_step(writer, code, toy_hash(&toy), wants ? &toy : NULL);
    }
    assert_int_equal(wanted, 6);
    char path[128];
    support_path("wanted", path);
    check_saved(writer, path, 0);
    assert_int_equal(recording_writer_close(&writer), RESULT_OK);
}

// ---- cost ----

static void test_recording_allocates_nothing_and_costs_little(void **state) {
    (void)state;
    char path[128];
    Toy toy;
    Pilot pilot = pilot_create(37, 12, 0.8);
    int64_t total_ns = 0, longest_ns = 0;
    support_path("cost", path);
    RecordingWriter *writer = begin(path, &toy, 37);
    support_fly(writer, &toy, &pilot, MINUTE);
    size_t before = mallinfo2().uordblks;
    for (int i = 0; i < 10 * MINUTE; i++) {
        Controls moved = pilot_move(&pilot);
        ControlsCode code = recording_quantise(&moved);
        toy_step(&toy, &moved);
        int64_t begin_ns = clock_now_ns();
        recording_writer_step(writer, code, toy_hash(&toy), &toy);
        int64_t ns = clock_now_ns() - begin_ns;
        total_ns += ns;
        longest_ns = ns > longest_ns ? ns : longest_ns;
    }
    size_t after = mallinfo2().uordblks;
    print_message("a step: %.2f us on average, %.0f us at most; %zu bytes allocated before, %zu after\n",
                  1e-3 * (double)total_ns / (10 * MINUTE), 1e-3 * (double)longest_ns, before, after);
    if (before > 0) // sanitizers do not tell
        assert_int_equal(after, before);
    assert_int_equal(recording_writer_close(&writer), RESULT_OK);
    unlink(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_killed_program_loses_at_most_a_second),
        cmocka_unit_test(test_a_full_disk_is_told_once_and_the_flight_goes_on),
        cmocka_unit_test(test_a_file_catches_up_when_there_is_room_again),
        cmocka_unit_test(test_a_place_that_cannot_be_written_is_told_at_once),
        cmocka_unit_test(test_a_stuck_disk_holds_up_nobody),
        cmocka_unit_test(test_the_last_ten_minutes_can_be_saved_at_any_time),
        cmocka_unit_test(test_the_memory_holds_ten_minutes_of_the_wildest_stick),
        cmocka_unit_test(test_the_state_is_wanted_every_ten_seconds),
        cmocka_unit_test(test_recording_allocates_nothing_and_costs_little),
    };
    return cmocka_run_group_tests_name("test_recording_writer", tests, NULL, NULL);
}
