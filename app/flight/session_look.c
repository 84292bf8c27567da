// What a flight looks like now: the camera, the aircraft from outside, and all that the display tells.
#include "app/aircraft/airframe.h"
#include "app/flight/flight_session.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <string.h>

#define STALL_SPEED_LEAST 8.0  // m/s: slower, angles mean nothing
#define STALL_WARNING_RAD 0.03 // before
#define STALL_SHARE 0.05       // of the flow separated
#define FLAPS_RAD 0.52         // of full flaps, as drawn

double session_altitude_m(const FlightSession *session, const FlightInstruments *now) {
    return now->h_m - geoid_undulation_m(session->world->geoid, now->lat_rad / GEODESY_RAD_PER_DEG,
                                         now->lon_rad / GEODESY_RAD_PER_DEG);
}

// The pages of keys, from the tables of actions.
#define HELP_ROW(id, keys, help) {keys, help},
static const RenderHelpRow help_rows[] = {ACTION_HELD_TABLE(HELP_ROW) ACTION_FLYING_TABLE(HELP_ROW)
                                              ACTION_ONCE_TABLE(HELP_ROW)};
#define KIOSK_ROW(id, keys, help) {keys, ACTION_##id == ACTION_LEAVE ? "begin the demonstration again" : help},
static const RenderHelpRow kiosk_help_rows[] = {ACTION_HELD_TABLE(HELP_ROW) ACTION_FLYING_TABLE(HELP_ROW)
                                                    ACTION_ONCE_TABLE(KIOSK_ROW)};
static const RenderHelpRow replay_help_rows[] = {
    ACTION_REPLAY_TABLE(HELP_ROW){"Mouse", "on the bar: to a time, or drag it"}, ACTION_ONCE_TABLE(HELP_ROW)};
#undef HELP_ROW
#undef KIOSK_ROW
_Static_assert(COUNT_OF(kiosk_help_rows) == COUNT_OF(help_rows), "only what a key does differs");

static RenderReplay make_replay(const FlightSession *session) {
    const Timeline *timeline = &session->timeline;
    return (RenderReplay){.show = session->playback != NULL,
                          .t_s = timeline->t_s,
                          .duration_s = timeline->duration_s,
                          .rate = timeline_rate(timeline),
                          .paused = timeline->paused,
                          .in_gap = session->moment.in_gap,
                          .derived = session->moment.derived};
}

// Or about to: a warning comes before.
static bool is_stalling(const FlightSession *session, const FlightInstruments *now) {
    const FlightState *state = &session->flight.state;
    return state->contact == FLIGHT_AIRBORNE && now->true_airspeed > STALL_SPEED_LEAST &&
           airframe_stalled(session->flight.aircraft, now->alpha_rad + STALL_WARNING_RAD, state->flaps) > STALL_SHARE;
}

// What is drawn of the aircraft from outside, and its shadow, which is seen from on board too: a pilot lands by it.
static RenderCraft make_craft(const FlightSession *session) {
    const FlightState *state = &session->flight.state;
    const Aircraft *aircraft = session->flight.aircraft;
    static const CraftKind KINDS[AIRCRAFT_ENGINE_COUNT] = {
        [AIRCRAFT_GLIDER] = CRAFT_GLIDER, [AIRCRAFT_PISTON] = CRAFT_C172, [AIRCRAFT_JET] = CRAFT_JET_TRAINER};
    bool turns = aircraft->engine == AIRCRAFT_PISTON && state->contact != FLIGHT_CRASHED;
    return (RenderCraft){.show = camera_is_outside(session->settings.view),
                         .casts = true,
                         .kind = KINDS[aircraft->engine],
                         .position_ecef = state->position_ecef,
                         .ecef_from_body = state->ecef_from_body,
                         .pose = {.aileron_rad = state->aileron * aircraft->aileron_rad,
                                  .elevator_rad = state->elevator * aircraft->elevator_rad,
                                  .rudder_rad = state->rudder * aircraft->rudder_rad,
                                  .flaps_rad = state->flaps * FLAPS_RAD,
                                  .gear = aircraft->gear_s > 0.0 ? state->gear : 1.0,
                                  .propeller_rad = session->propeller_rad,
                                  .rpm = turns ? 60.0 * session_propeller_rps(session) : 0.0}};
}

double session_propeller_rps(const FlightSession *session) {
    const Aircraft *aircraft = session->flight.aircraft;
    return aircraft->engine == AIRCRAFT_PISTON ? session->flight.state.engine * aircraft->rated_speed : 0.0;
}

// The pilot's own hands and feet, as long as these move the aircraft.
static bool pilot_flies(const FlightSession *session) {
    return !session->playback && !session->demo_flies && !session->holds;
}

// Of the autopilot; the words that the display shows, or NULL.
static const char *warning(const FlightSession *session) {
    bool flies = session->holds && !session->demo_flies && !session->playback;
    if (!flies || !session->watch.ahead || session->flight.state.contact != FLIGHT_AIRBORNE)
        return NULL;
    return session->watch.turn_rad == 0.0 ? "TERRAIN AHEAD \xE2\x80\x93 flying over it"
                                          : "TERRAIN AHEAD \xE2\x80\x93 turning away";
}

static RenderHud make_hud(const FlightSession *session, double frame_ms, double frame_p99_ms) {
    const FlightSettings *settings = &session->settings;
    FlightInstruments now = flight_instruments(&session->flight);
    const FlightState *state = &session->flight.state;
    bool only_path = session->playback && session->moment.only_path, kiosk = session->kiosk_idle_s > 0.0;
    return (RenderHud){.show_flight = settings->show_flight,
                       .show_numbers = settings->show_numbers,
                       .show_help = settings->show_help,
                       .help = session->playback ? replay_help_rows
                               : kiosk           ? kiosk_help_rows
                                                 : help_rows,
                       .help_count = session->playback ? (int)COUNT_OF(replay_help_rows) : (int)COUNT_OF(help_rows),
                       .replay = make_replay(session),
                       .heading_rad = now.heading_rad,
                       .pitch_rad = now.pitch_rad,
                       .bank_rad = now.bank_rad,
                       .speed_m_s = only_path ? now.speed_m_s : now.calibrated_airspeed,
                       .stalls = !only_path && is_stalling(session, &now),
                       .flaps = state->flaps,
                       .gear_retracts = !only_path && session->aircraft.gear_s > 0.0,
                       .gear = state->gear,
                       .brakes = session->flown.brake_left > 0.0 && !session->playback,
                       // The help for keys trims by itself.
                       .trim = pilot_flies(session) && !session->help.engaged ? session->keyboard.controls.trim : 0.0,
                       .rudder = pilot_flies(session) ? session->keyboard.controls.rudder : 0.0,
                       .autopilot = session->holds && !session->demo_flies && !session->playback,
                       .warning = warning(session),
                       .altitude_m = session_altitude_m(session, &now),
                       .above_ground_m = now.above_ground_m,
                       .vertical_speed_m_s = now.vertical_speed_m_s,
                       .no_engine = only_path || session->aircraft.engine == AIRCRAFT_GLIDER,
                       .throttle = session->flight.state.throttle,
                       .velocity_ecef = session->flight.state.velocity_ecef,
                       .over_terrain = now.over_ground,
                       .crashed = session->flight.state.contact == FLIGHT_CRASHED,
                       .paused = settings->clock.paused,
                       .alpha_rad = only_path ? (double)NAN : now.alpha_rad,
                       .outside = camera_is_outside(settings->view),
                       .aircraft_ecef = session->flight.state.position_ecef,
                       .nose_ecef = quatd_rotate(session->flight.state.ecef_from_body, vec3d(1, 0, 0)),
                       .wing_ecef = quatd_rotate(session->flight.state.ecef_from_body, vec3d(0, 1, 0)),
                       .datum = "EGM96",
                       .show_names = settings->show_flight && !settings->show_numbers,
                       .target_ms = settings->target_ms,
                       .target_out_of_reach = governor_is_out_of_reach(session->governor.reach),
                       .target_missed = session->governor.reach == GOVERNOR_NOT_MET,
                       .frame_ms = frame_ms,
                       .frame_p99_ms = frame_p99_ms};
}

void session_order(const FlightSession *session, int width, int height, double frame_ms, double frame_p99_ms,
                   FrameOrder *order) {
    const FlightSettings *settings = &session->settings;
    *order = (FrameOrder){.method = settings->method,
                          .compare = settings->compare,
                          .right = settings->right,
                          .width = width,
                          .height = height};
    RenderPacket *look = &order->look;
    look->camera = camera_of_flight(&session->flight, &session->rig, settings->view, settings->fov_rad);
    look->sun_ecef = session->sun_ecef;
    look->craft = make_craft(session);
    look->colouring = settings->colouring;
    look->wireframe = settings->wireframe;
    look->magenta_background = settings->magenta;
    look->hud = make_hud(session, frame_ms, frame_p99_ms);
    if (settings->view == CAMERA_MAP)
        flight_map_tell(&session->map, &session->flight, &look->camera, session->playback || session->demo_flies,
                        session->demo_flies ? session->demo.next : -1, &look->hud.map);
    const double *back = look->camera.camera_from_ecef.m[2];
    order->view =
        (LodView){.eye_ecef = look->camera.eye_ecef,
                  .forward_ecef = vec3d(-back[0], -back[1], -back[2]),
                  // Of the whole picture in two halves too: comparing changes no triangle.
                  .px_per_rad = camera_px_per_rad(look->camera.fov_y_rad, width, height, settings->bound_corner),
                  .tau_px = settings->tau_px};
    if (session->message_s > 0.0)
        memcpy(order->message, session->message, sizeof order->message);
}
