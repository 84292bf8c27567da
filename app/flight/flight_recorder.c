#define _XOPEN_SOURCE 700 // realpath
#include "app/flight/flight_recorder.h"

#include "app/version.h"
#include "base/log.h"
#include "config/files.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define NAME_BYTES 64
#define SAME_SECOND_MAX 100
#define UNWRITTEN_STEPS_MAX (RECORDING_KEPT_STEPS / 2) // a frame at the fastest rate of time is far less than the rest
#define FOLDER "recordings"

struct FlightRecorder {
    RecordingWriter *writer;
    char path[PATHS_BYTES_MAX]; // "": memory only
    char saved[PATHS_BYTES_MAX];
    bool saving, failure_said;
    uint32_t waited; // steps that are in the file for certain
};

// ---- what is recorded of where and what ----

// Of the figures, whatever they are called: FNV-1a.
static uint64_t hash_doubles(uint64_t hash, const void *from, const void *to) {
    for (const uint8_t *byte = from; byte < (const uint8_t *)to; byte++)
        hash = (hash ^ *byte) * UINT64_C(1099511628211);
    return hash;
}

uint64_t flight_recording_aircraft_hash(const Aircraft *aircraft) {
    uint64_t hash = hash_doubles(UINT64_C(14695981039346656037), &aircraft->cruise_speed, &aircraft->engine);
    hash = hash_doubles(hash, &aircraft->torque, aircraft->legs);
    for (int i = 0; i < aircraft->leg_count; i++)
        hash = hash_doubles(hash, &aircraft->legs[i].x, &aircraft->legs[i] + 1);
    return (hash ^ (uint64_t)aircraft->engine) * UINT64_C(1099511628211);
}

static void set_time(RecordingHeader *header) {
    char when[NAME_BYTES];
    time_t now = time(NULL);
    struct tm utc;
    if (gmtime_r(&now, &utc) && strftime(when, sizeof when, "%Y-%m-%dT%H:%M:%SZ", &utc))
        recording_header_set(header, RECORDING_START_UTC, "%s", when);
}

// The name of an aircraft file is one from where the program was started, and is needed from anywhere.
static void set_aircraft(RecordingHeader *header, const char *name) {
    char *path = realpath(name, NULL); // NULL: no file, but an aircraft that came with the program
    bool fits = path && strlen(path) < RECORDING_VALUE_BYTES;
    recording_header_set(header, RECORDING_AIRCRAFT, "%s", fits ? path : name);
    free(path);
}

// The names of the choices of an option, as "file|egm96|ellipsoid".
static void set_choice(RecordingHeader *header, RecordingKey key, OptionId id, int choice) {
    const char *at = option_spec(id)->choices;
    for (int i = 0; i < choice; i++)
        at += strcspn(at, "|") + 1;
    recording_header_set(header, key, "%.*s", (int)strcspn(at, "|"), at);
}

static void set_reading(RecordingHeader *header, const DemOptions *dem) {
    int datum = dem->datum == DEM_DATUM_ELLIPSOID ? 2 : 1;
    set_choice(header, RECORDING_DATUM, OPTION_DATUM, dem->datum_given ? datum : 0);
    set_choice(header, RECORDING_VOIDS, OPTION_VOIDS, (int)dem->voids);
    if (dem->spacing_m > 0.0)
        recording_header_set(header, RECORDING_SPACING, "%.17g", dem->spacing_m);
    if (dem->bounds_given)
        recording_header_set(header, RECORDING_BOUNDS, "%.17g,%.17g,%.17g,%.17g", dem->west_deg, dem->south_deg,
                             dem->east_deg, dem->north_deg);
}

static void set_scene(RecordingHeader *header, const World *world) {
    char folder[RECORDING_VALUE_BYTES];
    recording_header_set(header, RECORDING_SCENE, "%s", world->names[0] ? world->names : WORLD_DEFAULT_SCENE);
    if (getcwd(folder, sizeof folder))
        recording_header_set(header, RECORDING_FOLDER, "%s", folder);
    set_reading(header, &world->read_as);
}

void flight_recording_header(const World *world, const RecordedFlight *flown, RecordingHeader *out) {
    const Dem *dem = terrain_dem(world->terrain);
    const Flight *flight = flown->flight;
    *out = recording_header_create(FLIGHT_STATE_BYTES, FLIGHT_STATE_LAYOUT);
    recording_header_set(out, RECORDING_PROGRAM, "overfly %s", version_text());
    set_scene(out, world);
    set_time(out);
    recording_header_set(out, RECORDING_DEM, "%s", dem->file);
    recording_header_set(out, RECORDING_DEM_HASH, "%016llx", (unsigned long long)dem_hash(dem));
    set_aircraft(out, flown->aircraft);
    recording_header_set(out, RECORDING_AIRCRAFT_HASH, "%016llx",
                         (unsigned long long)flight_recording_aircraft_hash(flight->aircraft));
    recording_header_set(out, RECORDING_WEATHER, "wind %.17g %.17g %.17g m/s ECEF", flight->wind_ecef.x,
                         flight->wind_ecef.y, flight->wind_ecef.z);
}

void flight_recording_weather(const RecordingHeader *header, Flight *flight) {
    Vec3d wind;
    flight->wind_ecef = vec3d(0.0, 0.0, 0.0);
    if (sscanf(header->environment[RECORDING_WEATHER], "wind %lf %lf %lf", &wind.x, &wind.y, &wind.z) == 3)
        flight->wind_ecef = wind;
}

// ---- recording ----

// Of what a link leads to, else the name itself.
static bool kept_name(const char *path, char out[PATHS_BYTES_MAX]) {
    struct stat about;
    char *target = lstat(path, &about) == 0 && S_ISLNK(about.st_mode) ? realpath(path, NULL) : NULL;
    int printed = snprintf(out, PATHS_BYTES_MAX, "%s~", target ? target : path);
    free(target);
    return printed > 0 && printed < PATHS_BYTES_MAX;
}

bool recorder_keeps(const char *path, char out[PATHS_BYTES_MAX]) {
    struct stat about;
    return stat(path, &about) == 0 && S_ISREG(about.st_mode) && about.st_size > 0 && kept_name(path, out);
}

static Result keep_earlier(const char *path) {
    char kept[PATHS_BYTES_MAX], now[PATHS_BYTES_MAX];
    if (!path || !recorder_keeps(path, kept))
        return RESULT_OK;
    snprintf(now, sizeof now, "%.*s", (int)strlen(kept) - 1, kept);
    if (rename(now, kept) == 0) {
        log_info("%s: the recording that was there is kept as %s", path, kept);
        return RESULT_OK;
    }
    log_error("--record: %s is there, and cannot be kept as %s: %s; name another file", path, kept, strerror(errno));
    return RESULT_IO;
}

Result recorder_create(const World *world, const Options *options, const RecordedFlight *flown, FlightRecorder **out) {
    const char *path = options_text(options, OPTION_RECORD);
    uint8_t state[FLIGHT_STATE_BYTES];
    RecordingHeader header;
    FlightRecorder *recorder = calloc(1, sizeof *recorder);
    if (!recorder) {
        log_error("no memory for recording the flight");
        return RESULT_MEMORY;
    }
    if (path)
        snprintf(recorder->path, sizeof recorder->path, "%s", path);
    flight_recording_header(world, flown, &header);
    flight_state_pack(&flown->flight->state, state);
    Result result = keep_earlier(path);
    if (result == RESULT_OK)
        result = recording_writer_create(&header, path, state, &recorder->writer);
    if (result == RESULT_OK)
        *out = recorder;
    else
        free(recorder);
    return result;
}

Result recorder_close(FlightRecorder **recorder) {
    if (!*recorder)
        return RESULT_OK;
    if (recorder_path(*recorder) && recorder_steps(*recorder) == 0)
        log_warn("%s: nothing was flown, and nothing is in it", recorder_path(*recorder));
    Result result = recording_writer_close(&(*recorder)->writer);
    free(*recorder);
    *recorder = NULL;
    return result;
}

void recorder_fly(FlightRecorder *recorder, Flight *flight, const Controls *controls) {
    uint8_t state[FLIGHT_STATE_BYTES];
    ControlsCode code = recording_quantise(controls);
    Controls flown = recording_controls(code);
    flight_step(flight, &flown, FLIGHT_STEP_S);
    flight_state_pack(&flight->state, state);
    recording_writer_step(recorder->writer, code, flight_state_hash(&flight->state), state);
}

void recorder_restart(FlightRecorder *recorder, RecordingEventKind why, const Flight *flight) {
    uint8_t state[FLIGHT_STATE_BYTES];
    flight_state_pack(&flight->state, state);
    recording_writer_restart(recorder->writer, why, state);
}

void recorder_event(FlightRecorder *recorder, RecordingEventKind kind, const void *data, size_t bytes) {
    recording_writer_event(recorder->writer, kind, data, bytes);
}

// ---- the last ten minutes ----

static bool name_in(const char *folder, time_t now, int number, char out[PATHS_BYTES_MAX]) {
    char when[NAME_BYTES], suffix[16] = "";
    struct tm local;
    if (!localtime_r(&now, &local) || strftime(when, sizeof when, "%Y%m%d-%H%M%S", &local) == 0)
        return false;
    if (number > 0)
        snprintf(suffix, sizeof suffix, "-%d", number + 1);
    int printed = snprintf(out, PATHS_BYTES_MAX, "%s/overfly-%s%s.ofr", folder, when, suffix);
    return printed > 0 && printed < PATHS_BYTES_MAX;
}

// In the state folder of the user; where there is none, here.
static bool new_name(char out[PATHS_BYTES_MAX]) {
    char folder[PATHS_BYTES_MAX];
    time_t now = time(NULL);
    if (!files_user_state(FOLDER, folder) || files_make_folder(folder) != RESULT_OK)
        snprintf(folder, sizeof folder, ".");
    for (int i = 0; i < SAME_SECOND_MAX; i++)
        if (!name_in(folder, now, i, out))
            return false;
        else if (!files_exists(out))
            return true;
    return false;
}

void recorder_save(FlightRecorder *recorder, char message[RECORDER_MESSAGE_BYTES]) {
    char path[PATHS_BYTES_MAX];
    Result result = new_name(path) ? recording_writer_save(recorder->writer, path) : RESULT_RANGE;
    recorder->saving = recorder->saving || result == RESULT_OK;
    if (result == RESULT_OK)
        snprintf(recorder->saved, sizeof recorder->saved, "%s", path);
    snprintf(message, RECORDER_MESSAGE_BYTES, result == RESULT_OK ? "saving the last ten minutes" : "not saved: %s",
             result_text(result));
}

static void tell_saving(FlightRecorder *recorder, char message[RECORDER_MESSAGE_BYTES]) {
    RecordingSaving saving = recording_writer_saving(recorder->writer);
    if (saving == RECORDING_SAVING_GOES_ON)
        return;
    recorder->saving = false;
    if (saving == RECORDING_SAVING_DONE) {
        snprintf(message, RECORDER_MESSAGE_BYTES, "recording: %.140s", recorder->saved);
    } else {
        snprintf(message, RECORDER_MESSAGE_BYTES, "the recording could not be saved: see the log");
    }
}

void recorder_news(FlightRecorder *recorder, char message[RECORDER_MESSAGE_BYTES]) {
    bool failed = recording_writer_failed(recorder->writer);
    message[0] = '\0';
    if (failed && !recorder->failure_said)
        snprintf(message, RECORDER_MESSAGE_BYTES, "recording stands still: the file cannot be written; flying on");
    else if (!failed && recorder->failure_said)
        snprintf(message, RECORDER_MESSAGE_BYTES, "recording goes on");
    recorder->failure_said = failed;
    if (recorder->saving)
        tell_saving(recorder, message);
}

void recorder_wait(FlightRecorder *recorder) {
    uint32_t steps = recording_writer_steps(recorder->writer);
    if (steps - recorder->waited < UNWRITTEN_STEPS_MAX)
        return;
    recording_writer_wait(recorder->writer);
    recorder->waited = steps;
}

const char *recorder_path(const FlightRecorder *recorder) {
    return recorder->path[0] ? recorder->path : NULL;
}

uint32_t recorder_steps(const FlightRecorder *recorder) {
    return recording_writer_steps(recorder->writer);
}

uint64_t recorder_hash(const FlightRecorder *recorder) {
    return recording_writer_hash(recorder->writer);
}

// ---- flown again ----

static bool load(void *user, const void *state) {
    Flight *flight = user;
    return flight_state_unpack(state, &flight->state) == RESULT_OK;
}

static void save(void *user, void *state) {
    const Flight *flight = user;
    flight_state_pack(&flight->state, state);
}

static void step(void *user, const Controls *controls) {
    flight_step(user, controls, FLIGHT_STEP_S);
}

static uint64_t hash(void *user) {
    const Flight *flight = user;
    return flight_state_hash(&flight->state);
}

RecordingSim flight_sim(Flight *flight) {
    return (RecordingSim){.user = flight,
                          .state_bytes = FLIGHT_STATE_BYTES,
                          .state_layout = FLIGHT_STATE_LAYOUT,
                          .load = load,
                          .save = save,
                          .step = step,
                          .hash = hash};
}
