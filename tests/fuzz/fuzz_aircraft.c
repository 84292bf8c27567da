// Fuzz target of the aircraft reader and the flight model, for libFuzzer: the bytes become a file, which must be
// refused or fly for a second without leaving the numbers.
//   cmake --build --preset fuzz && build/fuzz/tests/fuzz_aircraft CORPUS_FOLDER, begun with assets/data/aircraft
// The reader takes paths, so the bytes go to one file of the process's own, in shared memory.
#define _GNU_SOURCE
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "app/dynamics/flight_model.h"
#include "base/log.h"

static void drop_message(void *user, LogLevel level, const char *message) {
    (void)user, (void)level, (void)message;
}

static bool sea(void *user, double lat_rad, double lon_rad, double *h_m) {
    (void)user, (void)lat_rad, (void)lon_rad;
    *h_m = 0.0;
    return true;
}

static void fly(const Aircraft *aircraft) {
    FlightStart start = {.h_m = 70.0, .speed_m_s = aircraft->cruise_speed};
    Flight flight = flight_create(aircraft, &start, (FlightGround){sea, NULL});
    for (int i = 0; i < 120; i++)
        flight_step(&flight, &(Controls){.elevator = 0.3, .aileron = 0.2, .throttle = 1.0}, FLIGHT_STEP_S);
    if (!isfinite(vec3d_length(flight.state.position_ecef)) || !isfinite(vec3d_length(flight.state.velocity_ecef)))
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
    int file = memfd_create("aircraft", 0);
    char path[64];
    Aircraft aircraft;
    log_set_sink(drop_message, NULL);
    if (file < 0)
        return 0;
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    if (write(file, bytes, count) == (ssize_t)count && aircraft_read(path, &aircraft) == RESULT_OK)
        fly(&aircraft);
    close(file);
    return 0;
}
