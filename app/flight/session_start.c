// How a flight begins: where, in what, and who flies it.
#include "app/aircraft/airframe.h"
#include "app/aircraft/isa.h"
#include "app/demo/demo_list.h"
#include "app/dynamics/flight_contact.h"
#include "app/flight/flight_session.h"
#include "app/flight/runway.h"
#include "base/log.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <string.h>

#define STALL_MARGIN 1.5 // times the stall speed, where the air is thin
#define ROUND_MIN_M 2000.0

static bool terrain_height(void *user, double lat_rad, double lon_rad, double *h_m) {
    return terrain_ground_m(user, lat_rad / GEODESY_RAD_PER_DEG, lon_rad / GEODESY_RAD_PER_DEG, h_m);
}

FlightGround session_ground(const World *world) {
    return (FlightGround){terrain_height, world->terrain};
}

static double start_speed(const FlightSession *session, const Options *options, double h_m) {
    const Aircraft *aircraft = &session->aircraft;
    const Scene *scene = &session->world->scene;
    double least = STALL_MARGIN * airframe_stall_speed(aircraft, isa_at(h_m).density, 0.0);
    if (options_is_set(options, OPTION_SPEED))
        return options_number(options, OPTION_SPEED);
    if (session->demo.has_start)
        return session->demo.start_speed_m_s;
    if (scene->has_speed && strcmp(aircraft->id, AIRCRAFT_DEFAULT) == 0)
        return fmax(scene->speed_m_s, least); // scenes are made for the aircraft that they start with
    return fmax(aircraft->cruise_speed, least);
}

// Level, however the view is tilted, unless a direction was asked for: the start of a scene looks down at the land.
static double start_pitch_rad(const Options *options, const Viewpoint *view) {
    return options_is_set(options, OPTION_LOOK) ? view->pitch_deg * GEODESY_RAD_PER_DEG : 0.0;
}

// Where it begins in the air, but higher than it was asked to.
static void say_raised(const Options *options, const Viewpoint *view, const Flight *flight, double h_m) {
    FlightInstruments now = flight_instruments(flight);
    double raised_m = now.h_m - h_m, above_m = now.above_ground_m - raised_m;
    if (!now.over_ground || raised_m < 0.1)
        return;
    log_warn("%s: %.0f m is %.0f m %s the ground there: the flight starts %.0f m above it, at %.0f m",
             options_is_set(options, OPTION_EYE) ? options_where(options, OPTION_EYE) : "the start", view->alt_m,
             fabs(above_m), above_m < 0.0 ? "under" : "above", now.above_ground_m, view->alt_m + raised_m);
}

static void say_start(const Options *options, const Viewpoint *view, const Flight *flight, const FlightStart *start) {
    bool stands = flight->state.contact == FLIGHT_ROLLING;
    if (start->on_ground && !stands)
        log_warn("the %s cannot stand where the flight starts: it starts in the air", flight->aircraft->name);
    else if (!start->on_ground && !start->untrimmed && !flight->trimmed)
        log_warn("the %s has no steady flight at %.0f m/s there: it starts as near as its wing carries",
                 flight->aircraft->name, start->speed_m_s);
    if (!start->on_ground)
        say_raised(options, view, flight, start->h_m);
}

static Flight start_flight(const FlightSession *session, const Options *options, const Viewpoint *view) {
    const World *world = session->world;
    const Aircraft *aircraft = &session->aircraft;
    double h_m = world_ellipsoid_m(world, view->lat_deg, view->lon_deg, view->alt_m);
    FlightStart start = {.lat_rad = view->lat_deg * GEODESY_RAD_PER_DEG,
                         .lon_rad = view->lon_deg * GEODESY_RAD_PER_DEG,
                         .h_m = h_m,
                         .heading_rad = view->heading_deg * GEODESY_RAD_PER_DEG,
                         .pitch_rad = start_pitch_rad(options, view),
                         .speed_m_s = start_speed(session, options, h_m),
                         .untrimmed = !options_flag(options, OPTION_TRIM),
                         .on_ground = options_flag(options, OPTION_ON_GROUND)};
    Flight flight = flight_create(aircraft, &start, session_ground(world));
    if (options_command(options) != COMMAND_REPLAY) // which begins where it was recorded
        say_start(options, view, &flight, &start);
    return flight;
}

static void say_runway(const Options *options, const Runway *run, double length_m) {
    double lat_deg = run->lat_rad / GEODESY_RAD_PER_DEG, lon_deg = run->lon_rad / GEODESY_RAD_PER_DEG;
    double heading_deg = run->heading_rad / GEODESY_RAD_PER_DEG;
    bool flat = run->slope <= RUNWAY_SLOPE;
    if (flat)
        log_info("on the ground at %.5f,%.5f, heading %.0f: %.0f m that rise or fall by %.1f %% at most", lat_deg,
                 lon_deg, heading_deg, length_m, 100.0 * run->slope);
    else
        log_warn("--on-ground: nothing within %.0f km of the start is flat for %.0f m, as far as the aircraft rolls to "
                 "take off; it stands at %.5f,%.5f, heading %.0f, where %.0f %% are the steepest; another place: "
                 "%s fly --on-ground --eye LAT,LON,0 --look HEADING,0",
                 RUNWAY_SEARCH_M * 1e-3, length_m, lat_deg, lon_deg, heading_deg, 100.0 * run->slope,
                 options_program(options));
}

// Who asks for no place on the ground is put where the aircraft can take off.
static void choose_runway(const Options *options, const FlightSession *session, Viewpoint *view) {
    const FlightGround ground = session_ground(session->world);
    double h_m = world_ellipsoid_m(session->world, view->lat_deg, view->lon_deg, view->alt_m);
    const RunwayWish wish = {.lat_rad = view->lat_deg * GEODESY_RAD_PER_DEG,
                             .lon_rad = view->lon_deg * GEODESY_RAD_PER_DEG,
                             .heading_rad = view->heading_deg * GEODESY_RAD_PER_DEG,
                             .heading_given = options_is_set(options, OPTION_LOOK),
                             .length_m = runway_length_m(&session->aircraft, h_m)};
    Runway run;
    if (!options_flag(options, OPTION_ON_GROUND) || options_is_set(options, OPTION_EYE))
        return;
    if (runway_find(&ground, &wish, &run) != RESULT_OK) {
        log_warn(
            "--on-ground: the land near the start is too small for the %.0f m that the aircraft rolls to take off; "
            "it starts where it would in the air",
            wish.length_m);
        return;
    }
    view->lat_deg = run.lat_rad / GEODESY_RAD_PER_DEG;
    view->lon_deg = run.lon_rad / GEODESY_RAD_PER_DEG;
    view->heading_deg = run.heading_rad / GEODESY_RAD_PER_DEG;
    say_runway(options, &run, wish.length_m);
}

// How far the view's middle is from the eye: where the line of sight meets the ground.
static double sight_distance(const World *world, const Viewpoint *view) {
    FlightGround ground = session_ground(world);
    Vec3d eye = world_viewpoint_ecef(world, view), ahead = viewpoint_forward(view);
    double distance_m = ROUND_MIN_M, above_m;
    for (int i = 0; i < 64; i++, distance_m *= 1.08) {
        if (!flight_ground_below(&ground, vec3d_mad(eye, ahead, distance_m), &above_m))
            return fmax(distance_m / 1.08, ROUND_MIN_M);
        if (above_m <= 0.0)
            break;
    }
    return distance_m;
}

// ---- the demo ----

static Result read_demo(const Options *options, FlightSession *session) {
    const World *world = session->world;
    char path[PATHS_BYTES_MAX];
    bool named = options_command(options) == COMMAND_DEMO;
    session->demo_flies = named || options_flag(options, OPTION_DEMO);
    if (named) {
        Result result = demo_find(options_positionals(options)[0], path);
        return result == RESULT_OK ? demo_read(path, world->geoid, &session->demo) : result;
    }
    bool of_scene = session->demo_flies && world->scene.demo;
    return of_scene ? demo_read(world->scene.demo, world->geoid, &session->demo) : RESULT_OK;
}

// What the command line does not say.
static void take_from_demo(const Options *options, FlightSession *session, Viewpoint *view) {
    const Demo *demo = &session->demo;
    if (demo->has_start && !options_is_set(options, OPTION_EYE))
        *view = demo->start;
    if (demo->view[0] && !options_is_given(options, OPTION_VIEW))
        camera_view_find(demo->view, &session->settings.view); // one of the choices of --view
}

static Result load_aircraft(const Options *options, FlightSession *session) {
    bool of_demo = session->demo.aircraft[0] && !options_is_given(options, OPTION_AIRCRAFT);
    const char *name = of_demo ? session->demo.aircraft : options_text(options, OPTION_AIRCRAFT);
    const char *where = of_demo ? session->demo.aircraft_where : options_where(options, OPTION_AIRCRAFT);
    char path[PATHS_BYTES_MAX];
    session->aircraft_name = name;
    Result result = aircraft_find(*where ? where : "aircraft", name, path);
    return result == RESULT_OK ? aircraft_read(path, &session->aircraft) : result;
}

static void start(const Options *options, const Viewpoint *view, FlightSession *session) {
    session->flight = start_flight(session, options, view);
    session->begin = session->flight.state;
    session->begin_controls = session->flown = session->flight.controls;
    session->stood = session->parked = session->flight.state.contact == FLIGHT_ROLLING;
    session->keyboard = keyboard_create(session->flight.controls.throttle);
    session->keyboard.controls = session->flight.controls;
    if (session->demo_flies && session->demo.count == 0 && !session->demo.stick)
        demo_make_round(view, session->world->geoid, sight_distance(session->world, view), &session->demo);
    demo_begin(&session->demo, &session->flight.controls);
    flight_map_take_demo(&session->map, &session->flight, &session->demo);
}

Result session_create(const World *world, const Options *options, FlightSession *out) {
    Viewpoint view;
    Result result = world_viewpoint(world, options, &view);
    if (result != RESULT_OK)
        return result;
    *out = (FlightSession){.world = world, .settings = flight_settings_create(options)};
    out->governor = governor_create(out->settings.target_ms, out->settings.tau_px);
    out->assist = options_flag(options, OPTION_ASSIST);
    out->kiosk_idle_s = options_flag(options, OPTION_KIOSK) ? options_number(options, OPTION_IDLE) : 0.0;
    result = read_demo(options, out);
    if (result == RESULT_OK) {
        take_from_demo(options, out, &view);
        result = load_aircraft(options, out);
    }
    if (result != RESULT_OK) {
        session_end(out);
        return result;
    }
    choose_runway(options, out, &view);
    out->sun_ecef = world_sun(world, options, &view);
    out->begin_settings = out->settings;
    start(options, &view, out);
    return RESULT_OK;
}

void session_end(FlightSession *session) {
    demo_clear(&session->demo);
}
