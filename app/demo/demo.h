// app/demo/demo.h: demonstration flights: places that an autopilot flies to, one after another, or the reports of a
// stick as somebody once moved it.
// As app/pilot/autopilot.h; in the file degrees, metres above the geoid, units as everywhere.
// A Demo owns its stick's reports, and is a value otherwise; one thread.
#pragma once
#include "app/joystick/stick_stream.h"
#include "app/pilot/autopilot.h"
#include "app/viewpoint.h"
#include "base/paths.h"
#include "terrain/geo.h"

#define DEMO_WAYPOINTS_MAX 256
#define DEMO_TEXT_BYTES 160
#define DEMO_ENDING ".demo"
#define DEMO_CLEARANCE_M 120.0

typedef struct Demo {
    char title[DEMO_TEXT_BYTES];               // "" where the file has none
    char aircraft[DEMO_TEXT_BYTES];            // by its name, or ""
    char aircraft_where[PATHS_BYTES_MAX + 32]; // for messages: "round.demo:3: aircraft"
    char view[DEMO_TEXT_BYTES];                // as --view takes it, or ""
    bool has_start;
    Viewpoint start; // heading, level
    double start_speed_m_s;
    Waypoint waypoints[DEMO_WAYPOINTS_MAX];
    int count;          // of waypoints; 0: flown by `stick`
    double clearance_m; // above the ground ahead, at least
    StickStream *stick;
    int next; // the waypoint flown to; count: the demo is over
    Autopilot autopilot;
} Demo;

// A text file of lines
//   title TEXT
//   aircraft NAME                    that it is made for
//   view VIEW
//   from LAT,LON,ALT HEADING SPEED   where it begins; else where the scene does
//   clearance LENGTH                 default 120m
//   to LAT,LON,ALT SPEED             any number
//   stick FILE                       beside this one, as stick_stream_read takes it; instead of `to`
// and comments after '#'; all but `to` once. Whether there is such an aircraft is asked by who needs it. NOT_FOUND, IO,
// FORMAT (file, line, what was expected); logged.
MUST_USE Result demo_read(const char *path, const Geoid *geoid, Demo *out);
// The title alone; "" where there is none. Errors of demo_read.
MUST_USE Result demo_read_title(const char *path, char out[DEMO_TEXT_BYTES]);
void demo_clear(Demo *demo);

// A round about what the viewpoint looks at, for terrains without a demo of their own.
void demo_make_round(const Viewpoint *view, const Geoid *geoid, double distance_m, Demo *out);

// To its begin again, with the controls that the flight begins with.
void demo_begin(Demo *demo, const Controls *controls);
// The controls for the step of `dt_s` to come; goes on to the next waypoint when one is reached.
Controls demo_fly(Demo *demo, const Flight *flight, double dt_s);
bool demo_is_over(const Demo *demo);
// About how long the whole demo takes from a place.
double demo_duration_s(const Demo *demo, double lat_rad, double lon_rad);
