// The real flight model over real terrain, recorded and flown again: the same to the bit, whoever loaded the land; the
// first step that differs; any moment, there and back.
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include <math.h>

#include <fcntl.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

#include "app/replay/replay_scene.h"
#include "base/clock.h"
#include "terrain/geodesy.h"
#include "tests/heard.h"
#include "tests/replay_support.h"

#define HOUR_STEPS (3600u * 120u / REPLAY_SLOWNESS)
#if defined(NDEBUG) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define FASTER_THAN_TIME 200.0
#else
#define FASTER_THAN_TIME 1.0 // built to find faults, not to be fast
#endif
#define SHORT_STEPS 12000u // 100 s
#define DIVE 2400u
#define RESET 8400u
#define LONG_STEPS (3u * 3600u * 120u)
#define SEEKS 50

typedef struct Fixture {
    ReplayWorld world;
    Flown flown; // a short flight with a crash and a reset
} Fixture;

static int set_up(void **state) {
    static Fixture fixture;
    replay_world_load(2, &fixture.world);
    replay_fly(&fixture.world, "short", SHORT_STEPS, DIVE, RESET, &fixture.flown);
    *state = &fixture;
    return 0;
}

static int tear_down(void **state) {
    Fixture *fixture = *state;
    flown_remove(&fixture->flown);
    replay_world_unload(&fixture->world);
    return 0;
}

// ---- the same flight ----

typedef struct Long {
    uint32_t steps, crashes;
    double lowest_m;
    uint64_t hash;
    double seconds;
} Long;

static void fly_on_and_on(ReplayWorld *world, const char *path, uint32_t steps, Long *out) {
    Aircraft aircraft;
    FlightRecorder *recorder;
    Hands hands = hands_create(3);
    assert_int_equal(aircraft_load(AIRCRAFT_DEFAULT, &aircraft), RESULT_OK);
    Flight flight = replay_start(world, &aircraft);
    const RecordedFlight recorded = replay_recorded(&flight);
    assert_int_equal(options_set(world->options, OPTION_RECORD, path, SOURCE_COMMAND_LINE, "--record"), RESULT_OK);
    assert_int_equal(recorder_create(&world->world, world->options, &recorded, &recorder), RESULT_OK);
    *out = (Long){.steps = steps, .lowest_m = INFINITY};
    int64_t begin_ns = clock_now_ns();
    for (uint32_t i = 0; i < steps; i++) {
        Controls controls = hands_move(&hands, &flight);
        FlightContact before = flight.state.contact;
        recorder_fly(recorder, &flight, &controls);
        recorder_wait(recorder);
        out->crashes += before != FLIGHT_CRASHED && flight.state.contact == FLIGHT_CRASHED;
        if (i % 120 == 0 && flight.state.contact == FLIGHT_AIRBORNE)
            out->lowest_m = fmin(out->lowest_m, flight_instruments(&flight).above_ground_m);
    }
    out->seconds = (double)(clock_now_ns() - begin_ns) * 1e-9;
    out->hash = recorder_hash(recorder);
    assert_int_equal(recorder_steps(recorder), steps);
    assert_int_equal(recorder_close(&recorder), RESULT_OK);
}

static double bytes_per_hour(const char *path, uint32_t steps) {
    struct stat about;
    assert_int_equal(stat(path, &about), 0);
    return (double)about.st_size * 3600.0 * 120.0 / steps;
}

static void an_hour_over_hills_is_the_same_flight_whoever_loads_the_land(void **state) {
    static const int WORKERS[] = {1, 8}; // it is flown over what two loaded
    Fixture *fixture = *state;
    char path[128];
    Long flight;
    replay_path("hour", path);
    fly_on_and_on(&fixture->world, path, HOUR_STEPS, &flight);
    double bytes = bytes_per_hour(path, HOUR_STEPS);
    print_message("%u steps in %.2f s, %.0f times as fast as time; %u crashes, down to %.0f m; %.2f MB an hour\n",
                  flight.steps, flight.seconds, flight.steps / 120.0 / flight.seconds, flight.crashes, flight.lowest_m,
                  bytes * 1e-6);
    assert_true(bytes < 2e6);
    assert_true(flight.crashes > 0 && flight.crashes < 200 && flight.lowest_m < 200.0);
    for (size_t i = 0; i < COUNT_OF(WORKERS); i++) {
        ReplayWorld world;
        replay_world_load(WORKERS[i], &world);
        RecordingVerdict verdict = replay_verdict(&world, path);
        print_message("land by %d workers: hash %016" PRIx64 ", flown %016" PRIx64 ", first difference %" PRId64
                      ", %.0f times as fast as time\n",
                      WORKERS[i], verdict.hash, flight.hash, verdict.first_difference_step, verdict.realtime_factor);
        assert_true(verdict.equal && verdict.hash == flight.hash && verdict.expected_hash == flight.hash);
        assert_true(verdict.steps == HOUR_STEPS && verdict.steps_missing == 0 && verdict.first_difference_step == -1);
        assert_true(verdict.realtime_factor > FASTER_THAN_TIME);
        replay_world_unload(&world);
    }
    unlink(path);
}

static void resets_and_crashes_are_flown_again(void **state) {
    const Fixture *fixture = *state;
    const Flown *flown = &fixture->flown;
    RecordingVerdict verdict = replay_verdict(&fixture->world, flown->path);
    print_message("crash at step %u, anew at %u, reset before %u of %u\n", flown->crash, flown->anew, flown->reset,
                  flown->steps);
    assert_true(flown->crash > DIVE && flown->anew > flown->crash && flown->anew < RESET);
    assert_true(verdict.equal && verdict.hash == flown->hash && verdict.steps == SHORT_STEPS);
}

// Before it said where names start from, how its land was read, and what the default scene is called.
static void an_old_recording_finds_its_land(void **state) {
    const Fixture *fixture = *state;
    const RecordingKey NEW[] = {RECORDING_SCENE, RECORDING_FOLDER, RECORDING_DATUM, RECORDING_VOIDS};
    char path[128];
    RecordingHeader header;
    RecordingWriter *writer;
    World world = {0};
    Aircraft aircraft;
    replay_path("old", path);
    assert_int_equal(aircraft_load(AIRCRAFT_DEFAULT, &aircraft), RESULT_OK);
    Flight flight = replay_start(&fixture->world, &aircraft);
    const RecordedFlight recorded = replay_recorded(&flight);
    flight_recording_header(&fixture->world.world, &recorded, &header);
    assert_string_equal(header.environment[RECORDING_SCENE], "jacksboro");
    for (size_t i = 0; i < COUNT_OF(NEW); i++) {
        assert_string_not_equal(header.environment[NEW[i]], "");
        recording_header_set(&header, NEW[i], "%s", "");
    }
    assert_int_equal(recording_writer_create(&header, path, fixture->flown.states[0], &writer), RESULT_OK);
    assert_int_equal(recording_writer_close(&writer), RESULT_OK);
    assert_int_equal(replay_load_scene(fixture->world.options, path, &world), RESULT_OK);
    assert_int_equal(dem_hash(terrain_dem(world.terrain)), dem_hash(terrain_dem(fixture->world.world.terrain)));
    world_unload(&world);
    unlink(path);
}

// ---- another flight ----

// The flight's steps as they were, but one with another code.
static void record_altered(const Fixture *fixture, const char *path, uint32_t altered) {
    const Flown *flown = &fixture->flown;
    Aircraft aircraft;
    RecordingHeader header;
    RecordingWriter *writer;
    assert_int_equal(aircraft_load(AIRCRAFT_DEFAULT, &aircraft), RESULT_OK);
    Flight flight = replay_start(&fixture->world, &aircraft);
    const RecordedFlight recorded = replay_recorded(&flight);
    flight_recording_header(&fixture->world.world, &recorded, &header);
    assert_int_equal(recording_writer_create(&header, path, flown->states[0], &writer), RESULT_OK);
    for (uint32_t i = 0; i < flown->steps; i++) {
        ControlsCode code = flown->codes[i];
        if (i == RESET)
            recording_writer_restart(writer, RECORDING_EVENT_RESET, flown->states[i]);
        code.rudder = (int16_t)(code.rudder + (i == altered));
        recording_writer_step(writer, code, flown->hashes[i], flown->states[i + 1]);
    }
    assert_int_equal(recording_writer_close(&writer), RESULT_OK);
}

static void another_control_code_is_told_at_its_step(void **state) {
    static const uint32_t AT[] = {0, 1, 99, 100, 1199, 1200, 1201, RESET, 9999, SHORT_STEPS - 1};
    const Fixture *fixture = *state;
    char path[128];
    replay_path("altered", path);
    for (size_t i = 0; i < COUNT_OF(AT); i++) {
        record_altered(fixture, path, AT[i]);
        RecordingVerdict verdict = replay_verdict(&fixture->world, path);
        if (verdict.equal || verdict.first_difference_step != AT[i])
            fail_msg("altered at step %u, told at %" PRId64, AT[i], verdict.first_difference_step);
    }
    record_altered(fixture, path, UINT32_MAX); // so that it is the alteration that is told
    assert_true(replay_verdict(&fixture->world, path).equal);
    unlink(path);
}

// A flight whose aircraft gets heavier by a hair at one step.
typedef struct Heavier {
    Flight flight; // first, so that its callbacks serve
    Aircraft other;
    int64_t at;
} Heavier;

static void step_heavier(void *user, const Controls *controls) {
    Heavier *heavier = user;
    if (heavier->flight.state.step >= heavier->at)
        heavier->flight.aircraft = &heavier->other;
    flight_step(&heavier->flight, controls, FLIGHT_STEP_S);
}

static void another_figure_of_the_aircraft_is_told_at_its_step(void **state) {
    static const uint32_t AT[] = {0, 1, 777, 1200, RESET + 5};
    const Fixture *fixture = *state;
    Aircraft aircraft;
    RecordingReader *reader;
    assert_int_equal(aircraft_load(AIRCRAFT_DEFAULT, &aircraft), RESULT_OK);
    for (size_t i = 0; i < COUNT_OF(AT); i++) {
        Heavier heavier = {.flight = replay_start(&fixture->world, &aircraft), .other = aircraft, .at = AT[i]};
        heavier.other.mass *= 1.0 + 1e-9;
        RecordingSim sim = flight_sim(&heavier.flight);
        RecordingVerdict verdict;
        sim.user = &heavier;
        sim.step = step_heavier;
        assert_int_equal(recording_reader_open(fixture->flown.path, &reader), RESULT_OK);
        assert_int_equal(recording_verify(reader, &sim, &verdict), RESULT_OK);
        recording_reader_close(&reader);
        if (verdict.first_difference_step != AT[i])
            fail_msg("heavier from step %u on, told at %" PRId64, AT[i], verdict.first_difference_step);
    }
}

static void write_heavier_aircraft(const char *path) {
    char line[512];
    FILE *from = fopen(SOURCE_DIR "/assets/data/aircraft/t37.aircraft", "r"), *to = fopen(path, "w");
    assert_true(from && to);
    int changed = 0;
    while (fgets(line, sizeof line, from)) {
        bool is_mass = strncmp(line, "mass = ", 7) == 0;
        fputs(is_mass ? "mass = 6361lb\n" : line, to);
        changed += is_mass;
    }
    fclose(from);
    fclose(to);
    assert_int_equal(changed, 1);
}

// As where the program, or its data, are another version.
static void an_aircraft_with_other_figures_is_warned_of(void **state) {
    const Fixture *fixture = *state;
    char path[128], aircraft_path[160];
    replay_path("figures", path);
    snprintf(aircraft_path, sizeof aircraft_path, "%s.aircraft", path);
    write_heavier_aircraft(aircraft_path);
    Aircraft aircraft;
    RecordingHeader header;
    RecordingWriter *writer;
    assert_int_equal(aircraft_load(AIRCRAFT_DEFAULT, &aircraft), RESULT_OK);
    Flight flight = replay_start(&fixture->world, &aircraft);
    const RecordedFlight recorded = {&flight, aircraft_path};
    flight_recording_header(&fixture->world.world, &recorded, &header);
    assert_int_equal(recording_writer_create(&header, path, fixture->flown.states[0], &writer), RESULT_OK);
    for (uint32_t i = 0; i < 500; i++)
        recording_writer_step(writer, fixture->flown.codes[i], fixture->flown.hashes[i], fixture->flown.states[i + 1]);
    assert_int_equal(recording_writer_close(&writer), RESULT_OK);
    Heard heard;
    heard_begin(&heard);
    RecordingVerdict verdict = replay_verdict(&fixture->world, path);
    heard_end();
    print_message("%sfirst difference %" PRId64 "\n", heard.text, verdict.first_difference_step);
    assert_int_equal(heard.warnings, 1);
    assert_non_null(strstr(heard.text, "other figures of the aircraft"));
    assert_int_equal(verdict.first_difference_step, 0);
    unlink(path);
    unlink(aircraft_path);
}

// ---- any moment ----

static void expect_moment(const Fixture *fixture, Playback *playback, uint32_t p) {
    PlaybackMoment moment = playback_at(playback, p / 120.0);
    if (!flown_is(&fixture->flown, p, &moment.state, true))
        fail_msg("before step %u it is not what was flown", p);
    if (moment.in_gap || moment.only_path || moment.derived)
        fail_msg("before step %u something is said to be missing", p);
}

static void every_moment_is_what_was_flown(void **state) {
    const Fixture *fixture = *state;
    uint64_t random = 5;
    Playback *playback = replay_open(&fixture->world, fixture->flown.path);
    assert_true(fabs(playback_duration_s(playback) - SHORT_STEPS / 120.0) < 1e-9);
    for (uint32_t p = 0; p <= SHORT_STEPS; p += 1 + p % 3)
        expect_moment(fixture, playback, p);
    for (uint32_t p = SHORT_STEPS; p > 7; p -= 1 + p % 7)
        expect_moment(fixture, playback, p);
    for (int i = 0; i < 200; i++)
        expect_moment(fixture, playback, (uint32_t)(hands_share(&random) * SHORT_STEPS));
    for (uint32_t p = RESET - 3; p < RESET + 3; p++) // to and fro over a border
        for (uint32_t q = RESET + 3; q > RESET - 3; q--) {
            expect_moment(fixture, playback, p);
            expect_moment(fixture, playback, q);
        }
    assert_int_equal(playback_first_difference(playback), -1);
    PlaybackMoment before = playback_at(playback, -3.0), after = playback_at(playback, 1e9);
    assert_true(flown_is(&fixture->flown, 0, &before.state, true));
    assert_true(flown_is(&fixture->flown, SHORT_STEPS, &after.state, true));
    playback_close(&playback);
}

static void between_two_steps_it_is_between_them(void **state) {
    const Fixture *fixture = *state;
    uint64_t random = 6;
    Playback *playback = replay_open(&fixture->world, fixture->flown.path);
    for (int i = 0; i < 500; i++) {
        uint32_t p = (uint32_t)(hands_share(&random) * (SHORT_STEPS - 1));
        double share = 0.05 + 0.9 * hands_share(&random);
        FlightState from = flown_state(&fixture->flown, p), to = flown_state(&fixture->flown, p + 1);
        if (p + 1 == RESET || p == fixture->flown.anew)
            continue;
        PlaybackMoment moment = playback_at(playback, (p + share) / 120.0);
        double way_m = vec3d_length(vec3d_sub(to.position_ecef, from.position_ecef)),
               gone_m = vec3d_length(vec3d_sub(moment.state.position_ecef, from.position_ecef)),
               left_m = vec3d_length(vec3d_sub(to.position_ecef, moment.state.position_ecef));
        if (fabs(gone_m + left_m - way_m) > 1e-6 || fabs(gone_m - share * way_m) > 1e-4 * way_m + 1e-6)
            fail_msg("step %u + %.3f: %.6f m gone, %.6f m left of %.6f m", p, share, gone_m, left_m, way_m);
        Quatd q = moment.state.ecef_from_body;
        assert_true(fabs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1.0) < 1e-12);
    }
    playback_close(&playback);
}

static void a_new_start_is_a_jump(void **state) {
    const Fixture *fixture = *state;
    const uint32_t jumps[] = {RESET - 1, fixture->flown.anew};
    Playback *playback = replay_open(&fixture->world, fixture->flown.path);
    for (size_t i = 0; i < COUNT_OF(jumps); i++) {
        PlaybackMoment moment = playback_at(playback, (jumps[i] + 0.6) / 120.0);
        FlightState next = flown_state(&fixture->flown, jumps[i] + 1);
        double jump_m = vec3d_length(vec3d_sub(next.position_ecef, moment.state.position_ecef));
        print_message("step %u: %.0f m to the next\n", jumps[i], jump_m);
        assert_true(jump_m > 50.0);
        assert_true(flown_is(&fixture->flown, jumps[i], &moment.state, true));
    }
    playback_close(&playback);
}

// ---- as a track ----

// Whether the aircraft was set down elsewhere in one of the steps from..to - 1, or before one of from + 1..to.
static bool has_jump(const Flown *flown, uint32_t from, uint32_t to) {
    bool jump = from < RESET && to >= RESET;
    for (uint32_t p = from; p < to; p++)
        jump = jump ||
               (flown_state(flown, p).contact == FLIGHT_CRASHED && flown_state(flown, p + 1).contact != FLIGHT_CRASHED);
    return jump;
}

static void a_track_of_it_has_its_places_and_its_jumps(void **state) {
    const Fixture *fixture = *state;
    Playback *playback = replay_open(&fixture->world, fixture->flown.path);
    Track track;
    Aircraft aircraft;
    assert_int_equal(aircraft_load(AIRCRAFT_DEFAULT, &aircraft), RESULT_OK);
    assert_int_equal(playback_track(playback, 0.5, &track), RESULT_OK);
    assert_int_equal(track.count, 201);
    assert_true(track_duration_s(&track) == 100.0 && !track_is_derived(&track) && isfinite(track.start_unix_s));
    int jumps = 0;
    for (int i = 0; i < track.count; i++) {
        Flight flight = replay_start(&fixture->world, &aircraft);
        flight.state = flown_state(&fixture->flown, (uint32_t)i * 60);
        FlightInstruments now = flight_instruments(&flight);
        const TrackPoint *point = &track.points[i];
        double lat_deg = now.lat_rad / GEODESY_RAD_PER_DEG, lon_deg = now.lon_rad / GEODESY_RAD_PER_DEG;
        double alt_m = now.h_m - geoid_undulation_m(fixture->world.world.geoid, lat_deg, lon_deg);
        if (point->t_s != i * 0.5 || fabs(point->at.lat_deg - lat_deg) > 1e-12 ||
            fabs(point->at.lon_deg - lon_deg) > 1e-12 || fabs(point->at.alt_m - alt_m) > 1e-9)
            fail_msg("point %d: %.9f, %.9f, %.3f m at %g s; flown: %.9f, %.9f, %.3f m", i, point->at.lat_deg,
                     point->at.lon_deg, point->at.alt_m, point->t_s, lat_deg, lon_deg, alt_m);
        bool jump = i > 0 && has_jump(&fixture->flown, (uint32_t)(i - 1) * 60, (uint32_t)i * 60);
        jumps += jump;
        if (jump != (bool)(point->flags & TRACK_GAP))
            fail_msg("point %d: a gap is expected: %d, found: %u", i, jump, point->flags);
    }
    print_message("%d points, %d jumps\n", track.count, jumps);
    assert_true(jumps >= 2 && track_gap_count(&track) == jumps);
    track_clear(&track);
    Heard heard;
    heard_begin(&heard);
    Result result = playback_track(playback, 1e-5, &track);
    heard_end();
    print_message("%s", heard.text);
    assert_int_equal(result, RESULT_RANGE);
    assert_int_equal(heard.errors, 1);
    playback_close(&playback);
}

// ---- long flights ----

static bool no_ground(void *user, double lat_rad, double lon_rad, double *h_m) {
    (void)user, (void)lat_rad, (void)lon_rad, (void)h_m;
    return false;
}

// A disk that takes nothing as long as the flight goes on, as a pipe that nobody empties; then all of it, into a file.
typedef struct SlowDisk {
    char pipe[140], file[128];
    uint32_t steps;         // of the whole flight
    _Atomic uint32_t flown; // so far
} SlowDisk;

// Hands off but for what a key does now and then: steps as cheap as there are.
static void fly_high(const Fixture *fixture, SlowDisk *disk) {
    Aircraft aircraft;
    FlightRecorder *recorder;
    Options *options = fixture->world.options;
    assert_int_equal(aircraft_load(AIRCRAFT_DEFAULT, &aircraft), RESULT_OK);
    Flight flight = replay_start(&fixture->world, &aircraft);
    flight.ground = (FlightGround){no_ground, NULL};
    const RecordedFlight recorded = replay_recorded(&flight);
    assert_int_equal(options_set(options, OPTION_RECORD, disk->pipe, SOURCE_COMMAND_LINE, "--record"), RESULT_OK);
    assert_int_equal(recorder_create(&fixture->world.world, options, &recorded, &recorder), RESULT_OK);
    Controls controls = flight.controls;
    for (uint32_t i = 0; i < disk->steps; i++) {
        controls.aileron = i % 2400 < 60 ? 0.05 : i % 2400 - 1200 < 60 ? -0.05 : 0.0;
        recorder_fly(recorder, &flight, &controls);
        recorder_wait(recorder);
        atomic_store(&disk->flown, i + 1);
    }
    assert_int_equal(recorder_close(&recorder), RESULT_OK);
}

// The flight's first ten seconds over and over, as the flight model would take longer than all other tests.
static void record_long(const Fixture *fixture, const char *path, uint32_t steps) {
    const Flown *flown = &fixture->flown;
    Aircraft aircraft;
    RecordingHeader header;
    RecordingWriter *writer;
    assert_int_equal(aircraft_load(AIRCRAFT_DEFAULT, &aircraft), RESULT_OK);
    Flight flight = replay_start(&fixture->world, &aircraft);
    const RecordedFlight recorded = replay_recorded(&flight);
    flight_recording_header(&fixture->world.world, &recorded, &header);
    assert_int_equal(recording_writer_create(&header, path, flown->states[0], &writer), RESULT_OK);
    for (uint32_t i = 0; i < steps; i++) {
        uint32_t k = i % RECORDING_KEYFRAME_STEPS;
        recording_writer_step(writer, flown->codes[k], flown->hashes[k], flown->states[0]);
        if (i % RECORDING_KEPT_STEPS == 0)
            recording_writer_wait(writer);
    }
    assert_int_equal(recording_writer_close(&writer), RESULT_OK);
}

static void any_moment_of_three_hours_is_that_of_the_flight(void **state) {
    const Fixture *fixture = *state;
    char path[128];
    uint64_t random = 7;
    replay_path("long", path);
    record_long(fixture, path, LONG_STEPS);
    int64_t begin_ns = clock_now_ns();
    Playback *playback = replay_open(&fixture->world, path);
    double open_s = (double)(clock_now_ns() - begin_ns) * 1e-9, sum_ms = 0.0, most_ms = 0.0;
    for (int i = 0; i < SEEKS; i++) {
        uint32_t p = (uint32_t)(hands_share(&random) * LONG_STEPS);
        begin_ns = clock_now_ns();
        PlaybackMoment moment = playback_at(playback, p / 120.0);
        double ms = (double)(clock_now_ns() - begin_ns) * 1e-6;
        sum_ms += ms;
        most_ms = fmax(most_ms, ms);
        assert_true(flown_is(&fixture->flown, p % RECORDING_KEYFRAME_STEPS, &moment.state, true));
    }
    print_message("%.0f minutes, opened in %.3f s; a seek takes %.2f ms on average, %.2f ms at most\n",
                  LONG_STEPS / 7200.0, open_s, sum_ms / SEEKS, most_ms);
    assert_int_equal(playback_first_difference(playback), -1);
    playback_close(&playback);
    unlink(path);
}

static void wait_until_it_stands_still(SlowDisk *disk) {
    for (uint32_t before = UINT32_MAX, now = 0; (now != before || now == 0) && now < disk->steps;) {
        nanosleep(&(struct timespec){.tv_nsec = 200000000}, NULL);
        before = now;
        now = atomic_load(&disk->flown);
    }
}

static void *empty_late(void *user) {
    SlowDisk *disk = user;
    char bytes[4096];
    int from = open(disk->pipe, O_RDONLY), to = open(disk->file, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    wait_until_it_stands_still(disk);
    for (ssize_t count; (count = read(from, bytes, sizeof bytes)) > 0;)
        if (write(to, bytes, (size_t)count) != count)
            break;
    close(from);
    close(to);
    return NULL;
}

static void a_slow_disk_is_waited_for_where_time_does_not_matter(void **state) {
    const Fixture *fixture = *state;
    static SlowDisk disk;
    disk.steps = 40 * 60 * 120; // more than the memory holds, which are 2048 chunks
    pthread_t thread;
    replay_path("slow", disk.file);
    snprintf(disk.pipe, sizeof disk.pipe, "%s.pipe", disk.file);
    assert_int_equal(mkfifo(disk.pipe, 0600), 0);
    assert_int_equal(pthread_create(&thread, NULL, empty_late, &disk), 0);
    fly_high(fixture, &disk);
    assert_int_equal(pthread_join(thread, NULL), 0);
    RecordingReader *reader;
    assert_int_equal(recording_reader_open(disk.file, &reader), RESULT_OK);
    assert_int_equal(recording_reader_end(reader), disk.steps);
    assert_int_equal(recording_reader_segment_count(reader), disk.steps / RECORDING_KEYFRAME_STEPS);
    const RecordingDamage *damages;
    assert_int_equal(recording_reader_damages(reader, &damages), 0);
    recording_reader_close(&reader);
    unlink(disk.pipe);
    unlink(disk.file);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_hour_over_hills_is_the_same_flight_whoever_loads_the_land),
        cmocka_unit_test(resets_and_crashes_are_flown_again),
        cmocka_unit_test(an_old_recording_finds_its_land),
        cmocka_unit_test(another_control_code_is_told_at_its_step),
        cmocka_unit_test(another_figure_of_the_aircraft_is_told_at_its_step),
        cmocka_unit_test(an_aircraft_with_other_figures_is_warned_of),
        cmocka_unit_test(every_moment_is_what_was_flown),
        cmocka_unit_test(between_two_steps_it_is_between_them),
        cmocka_unit_test(a_new_start_is_a_jump),
        cmocka_unit_test(a_track_of_it_has_its_places_and_its_jumps),
        cmocka_unit_test(any_moment_of_three_hours_is_that_of_the_flight),
        cmocka_unit_test(a_slow_disk_is_waited_for_where_time_does_not_matter),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
