// app/flight/telemetry.h: a flight as lines of CSV while it goes on, for scripts and instruments beside the program.
// Degrees, metres above the geoid EGM96, metres a second, seconds of flight; heading clockwise from north.
// A Telemetry owns its file. One thread.
#pragma once
#include "app/dynamics/flight_model.h"
#include "terrain/geo.h"

#define TELEMETRY_STEPS 12 // between two lines: ten a second of flight

typedef struct Telemetry Telemetry;

// Whether a regular file begins as what is written here; what cannot be read does not.
bool telemetry_is_one(const char *path);

// "-": standard output. Its first line names the columns; those of a track come first, so that it can be replayed.
// NOT_FOUND, IO: logged; MEMORY.
MUST_USE Result telemetry_create(const char *path, Telemetry **out);
void telemetry_destroy(Telemetry **telemetry);
// After each step; every TELEMETRY_STEPS a line. A file that cannot be written any more is told once.
// Of a replay: at times of the recorded flight, which may go backwards. `only_path`: what a path does not tell
// (airspeed, angle of attack, load, controls, contact) stays empty.
void telemetry_show(Telemetry *telemetry, double t_s, const Flight *flight, const Geoid *geoid, bool only_path);
void telemetry_step(Telemetry *telemetry, const Flight *flight, const Geoid *geoid);
