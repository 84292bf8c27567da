#include "app/flight/telemetry.h"

#include "base/log.h"
#include "terrain/geodesy.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct Telemetry {
    FILE *file;
    const char *name; // for messages
    int64_t steps;
    double shown_s;
    bool failed;
};

static const char head[] =
    "t_s,lat_deg,lon_deg,alt_m,heading_deg,pitch_deg,bank_deg,above_ground_m,airspeed_m_s,vertical_speed_m_s,"
    "alpha_deg,load_factor,throttle,flaps,gear,contact\n";

static void write_head(Telemetry *telemetry) {
    fputs(head, telemetry->file);
    fflush(telemetry->file);
}

bool telemetry_is_one(const char *path) {
    char begin[sizeof head - 1];
    FILE *file = fopen(path, "rb");
    size_t count = file ? fread(begin, 1, sizeof begin, file) : 0;
    if (file)
        fclose(file);
    return count == sizeof begin && memcmp(begin, head, sizeof begin) == 0;
}

Result telemetry_create(const char *path, Telemetry **out) {
    Telemetry *telemetry = calloc(1, sizeof *telemetry);
    if (!telemetry) {
        log_error("no memory for telemetry");
        return RESULT_MEMORY;
    }
    telemetry->name = path;
    telemetry->shown_s = NAN;
    telemetry->file = strcmp(path, "-") == 0 ? stdout : fopen(path, "w");
    if (!telemetry->file) {
        int error = errno;
        log_error("%s: the telemetry cannot be written: %s", path, strerror(error));
        free(telemetry);
        return error == ENOENT ? RESULT_NOT_FOUND : RESULT_IO;
    }
    write_head(telemetry);
    *out = telemetry;
    return RESULT_OK;
}

void telemetry_destroy(Telemetry **telemetry) {
    if (!*telemetry)
        return;
    if ((*telemetry)->file != stdout)
        fclose((*telemetry)->file);
    free(*telemetry);
    *telemetry = NULL;
}

static double degrees(double radians) {
    return radians / GEODESY_RAD_PER_DEG;
}

// What moves the aircraft, and what moves in it.
static void write_causes(FILE *file, const FlightInstruments *now, const FlightState *state) {
    static const char *const CONTACTS[] = {
        [FLIGHT_AIRBORNE] = "airborne", [FLIGHT_ROLLING] = "rolling", [FLIGHT_CRASHED] = "crashed"};
    fprintf(file, "%.2f,%.2f,%.3f,%.3f,%.3f,%s\n", degrees(now->alpha_rad), now->load_factor, state->throttle,
            state->flaps, state->gear, CONTACTS[state->contact]);
}

static void write_line(const Telemetry *telemetry, double t_s, const Flight *flight, const Geoid *geoid,
                       bool only_path) {
    FlightInstruments now = flight_instruments(flight);
    double lat_deg = degrees(now.lat_rad), lon_deg = degrees(now.lon_rad);
    fprintf(telemetry->file, "%.3f,%.8f,%.8f,%.2f,%.2f,%.2f,%.2f,", t_s, lat_deg, lon_deg,
            now.h_m - geoid_undulation_m(geoid, lat_deg, lon_deg), degrees(now.heading_rad), degrees(now.pitch_rad),
            degrees(now.bank_rad));
    if (now.over_ground) // else nothing is known of it
        fprintf(telemetry->file, "%.2f", now.above_ground_m);
    if (only_path) {
        fprintf(telemetry->file, ",,%.2f,,,,,,\n", now.vertical_speed_m_s);
        return;
    }
    fprintf(telemetry->file, ",%.2f,%.2f,", now.calibrated_airspeed, now.vertical_speed_m_s);
    write_causes(telemetry->file, &now, &flight->state);
}

static void tell(Telemetry *telemetry, double t_s, const Flight *flight, const Geoid *geoid, bool only_path) {
    write_line(telemetry, t_s, flight, geoid, only_path);
    telemetry->shown_s = t_s;
    telemetry->failed = fflush(telemetry->file) != 0;
    if (telemetry->failed)
        log_warn("%s: telemetry cannot be written any more: %s; flying on", telemetry->name, strerror(errno));
}

void telemetry_step(Telemetry *telemetry, const Flight *flight, const Geoid *geoid) {
    if (!telemetry->failed && telemetry->steps % TELEMETRY_STEPS == 0)
        tell(telemetry, (double)telemetry->steps * FLIGHT_STEP_S, flight, geoid, false);
    telemetry->steps++;
}

void telemetry_show(Telemetry *telemetry, double t_s, const Flight *flight, const Geoid *geoid, bool only_path) {
    bool due = !(fabs(t_s - telemetry->shown_s) < TELEMETRY_STEPS * FLIGHT_STEP_S - 1e-9); // at first it is no number
    if (!telemetry->failed && due)
        tell(telemetry, t_s, flight, geoid, only_path);
}
