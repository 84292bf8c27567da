#include "app/flight/flight_session.h"

#include "app/aircraft/airframe.h"
#include "app/aircraft/isa.h"
#include "app/flight/flight_contact.h"
#include "base/log.h"
#include "base/statistics.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define STALL_MARGIN 1.5 // times the stall speed, where the air is thin
#define ROUND_MIN_M 2000.0

static bool terrain_height(void *user, double lat_rad, double lon_rad, double *h_m) {
    return terrain_ground_m(user, lat_rad / GEODESY_RAD_PER_DEG, lon_rad / GEODESY_RAD_PER_DEG, h_m);
}

FlightGround session_ground(const World *world) {
    return (FlightGround){terrain_height, world->terrain};
}

static double start_speed(const World *world, const Options *options, const Aircraft *aircraft, double h_m) {
    if (options_is_set(options, OPTION_SPEED))
        return options_number(options, OPTION_SPEED);
    if (world->scene.has_speed && strcmp(aircraft->id, AIRCRAFT_DEFAULT) == 0)
        return world->scene.speed_m_s; // scenes are made for the aircraft that they start with
    return fmax(aircraft->cruise_speed, STALL_MARGIN * airframe_stall_speed(aircraft, isa_at(h_m).density, 0.0));
}

// Level, however the view is tilted, unless a direction was asked for: the start of a scene looks down at the land.
static double start_pitch_rad(const Options *options, const Viewpoint *view) {
    return options_is_set(options, OPTION_LOOK) ? view->pitch_deg * GEODESY_RAD_PER_DEG : 0.0;
}

static void say_start(const Flight *flight, const FlightStart *start) {
    if (start->on_ground && flight->state.contact != FLIGHT_ROLLING)
        log_warn("the %s cannot stand where the flight starts: it starts in the air", flight->aircraft->name);
    else if (!start->on_ground && !start->untrimmed && !flight->trimmed)
        log_warn("the %s has no steady flight at %.0f m/s there: it starts as near as its wing carries",
                 flight->aircraft->name, start->speed_m_s);
}

static Flight start_flight(const World *world, const Options *options, const Aircraft *aircraft,
                           const Viewpoint *view) {
    double h_m = world_ellipsoid_m(world, view->lat_deg, view->lon_deg, view->alt_m);
    FlightStart start = {.lat_rad = view->lat_deg * GEODESY_RAD_PER_DEG,
                         .lon_rad = view->lon_deg * GEODESY_RAD_PER_DEG,
                         .h_m = h_m,
                         .heading_rad = view->heading_deg * GEODESY_RAD_PER_DEG,
                         .pitch_rad = start_pitch_rad(options, view),
                         .speed_m_s = start_speed(world, options, aircraft, h_m),
                         .untrimmed = !options_flag(options, OPTION_TRIM),
                         .on_ground = options_flag(options, OPTION_ON_GROUND)};
    Flight flight = flight_create(aircraft, &start, session_ground(world));
    say_start(&flight, &start);
    return flight;
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

static Result prepare_demo(const World *world, const Viewpoint *view, FlightSession *session) {
    session->demo_flies = true;
    if (world->scene.demo)
        return demo_read(world->scene.demo, world->geoid, &session->demo);
    demo_make_round(view, world->geoid, sight_distance(world, view), &session->demo);
    return RESULT_OK;
}

Result session_create(const World *world, const Options *options, FlightSession *out) {
    Viewpoint view;
    Result result = world_viewpoint(world, options, &view);
    if (result != RESULT_OK)
        return result;
    *out = (FlightSession){.world = world, .settings = flight_settings_create(options)};
    out->governor = governor_create(out->settings.target_ms, out->settings.tau_px);
    out->sun_ecef = world_sun(world, options, &view);
    result = aircraft_load(options_text(options, OPTION_AIRCRAFT), &out->aircraft);
    if (result != RESULT_OK)
        return result;
    out->assist = options_flag(options, OPTION_ASSIST);
    out->flight = start_flight(world, options, &out->aircraft, &view);
    out->begin = out->flight.state;
    out->keyboard = keyboard_create(out->flight.controls.throttle);
    out->keyboard.controls = out->flight.controls;
    return options_flag(options, OPTION_DEMO) ? prepare_demo(world, &view, out) : RESULT_OK;
}

void session_say(FlightSession *session, const char *message) {
    snprintf(session->message, sizeof session->message, "%s", message);
    session->message_s = SESSION_MESSAGE_S;
}

void session_hear_changes(FlightSession *session, const MethodChanges *changes, LodMethod shown) {
    if (changes->fallbacks != session->fallbacks_said)
        session_say(session, "the GPU has no room for the diamonds: computed on the processor");
    session->fallbacks_said = changes->fallbacks;
    if (changes->refusals == session->refusals_said)
        return;
    char message[PIPELINE_MESSAGE_BYTES];
    snprintf(message, sizeof message, "%s: %s; flying on with %s", lod_method_name(changes->refused),
             changes->why[0] ? changes->why : result_text(changes->refusal), lod_method_name(shown));
    session_say(session, message);
    session->refusals_said = changes->refusals;
}

static GovernorFrame judged_frame(const PipelineFrame *frame) {
    return (GovernorFrame){.cost_ms = frame->cost_ms,
                           .passed_s = frame->frame_ms * 1e-3,
                           .tau_px = frame->tau_px,
                           .reached_px = frame->reached_px,
                           .another = frame->another,
                           .moved = frame->moved,
                           .disturbed = frame->disturbed};
}

static double median_cost_ms(const PipelineStats *stats) {
    double cost_ms[PIPELINE_FRAMES_KEPT];
    int count = 0;
    for (int64_t i = 0; i < stats->frames && i < PIPELINE_FRAMES_KEPT; i++)
        if (!stats->latest[i].disturbed)
            cost_ms[count++] = stats->latest[i].cost_ms;
    statistics_sort(cost_ms, count);
    return count ? statistics_percentile(cost_ms, count, 0.5) : stats->frame_ms;
}

static void warn_of_slow_frames(const FlightSession *session, const PipelineStats *stats) {
    log_warn("--target-ms %g: even the coarsest tolerance, %g px, takes %.3g ms a frame here; take a longer time, or "
             "fewer pixels (--size)",
             session->settings.target_ms, GOVERNOR_TAU_MAX_PX, median_cost_ms(stats));
}

void session_govern(FlightSession *session, const PipelineStats *stats) {
    FlightSettings *settings = &session->settings;
    if (!(settings->target_ms > 0.0))
        return;
    if (session->governor.target_ms != settings->target_ms)
        governor_set_target(&session->governor, settings->target_ms);
    if (session->frames_judged < stats->frames - PIPELINE_FRAMES_KEPT)
        session->frames_judged = stats->frames - PIPELINE_FRAMES_KEPT;
    for (; session->frames_judged < stats->frames; session->frames_judged++) {
        GovernorFrame frame = judged_frame(&stats->latest[session->frames_judged % PIPELINE_FRAMES_KEPT]);
        (void)governor_hear(&session->governor, &frame);
        if (governor_notice_slow(&session->slow_notice, &session->governor, frame.passed_s))
            warn_of_slow_frames(session, stats);
    }
    settings->tau_px = session->governor.tau_px;
}

static void take_over(FlightSession *session, const char *why) {
    const FlightState *state = &session->flight.state;
    session->demo_flies = false;
    session->keyboard.controls = (Controls){
        .trim = state->elevator, .throttle = state->throttle, .flaps = state->flaps, .gear_up = state->gear < 0.5};
    session_say(session, why);
}

void session_on_key(FlightSession *session, int key, bool pressed, bool shift) {
    if (session->playback && pressed && session_replay_key(session, key))
        return;
    keyboard_on_key(&session->keyboard, key, pressed, shift);
    if (session->demo_flies && session->settings.view != CAMERA_FREE && keyboard_touches_controls(&session->keyboard))
        take_over(session, "you have control");
}

void session_on_repeat(FlightSession *session, int key) {
    Action action = session->playback ? action_of_replay_key(key) : ACTION_NONE;
    if (action == ACTION_REPLAY_BACK || action == ACTION_REPLAY_AHEAD)
        (void)session_replay_key(session, key);
}

// After a crash the controls are those of the new start.
static void begin_again(FlightSession *session) {
    session->keyboard.controls = session->flight.controls;
    session->help = session->demo.autopilot = (Autopilot){.engaged = false};
}

// To where the flight began, as it began.
static void session_reset(FlightSession *session) {
    int64_t step = session->flight.state.step;
    session->flight.state = session->begin;
    session->flight.state.step = step;
    begin_again(session);
    if (session->recorder)
        recorder_restart(session->recorder, RECORDING_EVENT_RESET, &session->flight);
    session_say(session, "from the start");
}

static void act(FlightSession *session, Action action) {
    char message[PIPELINE_MESSAGE_BYTES];
    switch (action) {
    case ACTION_LEAVE:
        session->leave_wanted = true;
        return;
    case ACTION_SCREENSHOT:
        session->screenshot_wanted = true;
        return;
    case ACTION_CENTRE:
        keyboard_centre(&session->keyboard);
        return;
    case ACTION_SAVE:
        if (session->recorder)
            recorder_save(session->recorder, message);
        session_say(session, session->recorder ? message : "nothing is recorded");
        return;
    case ACTION_RESET:
        session_reset(session);
        return;
    case ACTION_FLAPS_UP:
    case ACTION_FLAPS_DOWN:
        keyboard_move_flaps(&session->keyboard, action == ACTION_FLAPS_DOWN);
        return;
    case ACTION_GEAR_UP:
    case ACTION_GEAR_DOWN:
        keyboard_set_gear(&session->keyboard, action == ACTION_GEAR_UP);
        return;
    default:
        if (flight_settings_apply(&session->settings, action, message, sizeof message) && message[0])
            session_say(session, message);
    }
}

// In the free view the stick flies the camera, and the aircraft keeps its controls.
static CameraMotion camera_motion(const FlightSession *session) {
    const Keyboard *keyboard = &session->keyboard;
    if (session->settings.view != CAMERA_FREE)
        return (CameraMotion){0};
    return (CameraMotion){.turn = keyboard_direction(keyboard, ACTION_STICK_LEFT, ACTION_STICK_RIGHT),
                          .tilt = keyboard_direction(keyboard, ACTION_STICK_BACK, ACTION_STICK_FORWARD),
                          .ahead = keyboard_direction(keyboard, ACTION_THROTTLE_DOWN, ACTION_THROTTLE_UP),
                          .aside = keyboard_direction(keyboard, ACTION_RUDDER_LEFT, ACTION_RUDDER_RIGHT)};
}

static Controls sample_keyboard(FlightSession *session) {
    if (session->settings.view == CAMERA_FREE)
        return session->keyboard.controls;
    if (session->pilot)
        return pilot_sample(session->pilot, &session->keyboard, FLIGHT_STEP_S);
    return keyboard_sample(&session->keyboard, FLIGHT_STEP_S);
}

// What pads reported before a step begins acts in it.
static void hear_pads(FlightSession *session, int64_t until_ns) {
    char message[PILOT_MESSAGE_BYTES];
    if (!session->pilot)
        return;
    pilot_hear(session->pilot, &session->keyboard, until_ns, message);
    if (message[0])
        session_say(session, message);
    if (pilot_was_touched(session->pilot) && session->demo_flies)
        take_over(session, "you have control");
}

// A pad that lies there while the demo flies is left alone.
static void shake_pads(FlightSession *session, const FlightState *before) {
    double dt_s = FLIGHT_STEP_S / flight_clock_rate(&session->settings.clock);
    FeelRumble rumble = feel_step(&session->feel, before, &session->flight, dt_s);
    if (session->pilot && !session->demo_flies && rumble.seconds > 0.0)
        pilot_rumble(session->pilot, rumble.low, rumble.high, rumble.seconds);
}

// A stick is the pilot's own; keys get help, anew after each change.
static bool wants_help(const FlightSession *session) {
    return session->assist && !(session->pilot && pilot_drives_stick(session->pilot));
}

static void step(FlightSession *session) {
    Controls controls = sample_keyboard(session);
    if (session->demo_flies)
        controls = demo_fly(&session->demo, &session->flight, FLIGHT_STEP_S);
    else if (wants_help(session))
        controls = autopilot_assist(&session->help, &session->flight, &controls, FLIGHT_STEP_S);
    else
        session->help = (Autopilot){.engaged = false};
    const FlightState before = session->flight.state;
    if (session->recorder)
        recorder_fly(session->recorder, &session->flight, &controls);
    else
        flight_step(&session->flight, &controls, FLIGHT_STEP_S);
    shake_pads(session, &before);
    session->crashes += before.contact != FLIGHT_CRASHED && session->flight.state.contact == FLIGHT_CRASHED;
    if (before.contact == FLIGHT_CRASHED && session->flight.state.contact != FLIGHT_CRASHED)
        begin_again(session);
    if (session->demo_flies && demo_is_over(&session->demo))
        take_over(session, "the demo is over: you have control");
}

static void act_on_presses(FlightSession *session) {
    for (Action action; (action = keyboard_next_action(&session->keyboard)) != ACTION_NONE;)
        act(session, action);
}

static void fly_steps(FlightSession *session, double passed_s) {
    int steps = flight_clock_steps(&session->settings.clock, passed_s, FLIGHT_STEP_S);
    double step_ns = FLIGHT_STEP_S / flight_clock_rate(&session->settings.clock) * 1e9;
    double end_ns = (double)session->now_ns - session->settings.clock.owed_s * 1e9;
    for (int i = 0; i < steps; i++) {
        hear_pads(session, session->now_ns ? (int64_t)(end_ns - (steps - i) * step_ns) : PILOT_EVERYTHING);
        act_on_presses(session);
        step(session);
    }
}

static void hear_recorder(FlightSession *session) {
    char message[RECORDER_MESSAGE_BYTES];
    if (!session->recorder)
        return;
    recorder_news(session->recorder, message);
    if (message[0])
        session_say(session, message);
}

void session_advance(FlightSession *session, double passed_s) {
    hear_recorder(session);
    if (session->pilot)
        pilot_poll(session->pilot);
    if (session->playback || session->settings.clock.paused)
        hear_pads(session, PILOT_EVERYTHING);
    act_on_presses(session);
    if (session->playback)
        session_replay_advance(session, passed_s);
    else
        fly_steps(session, passed_s);
    if (session->pilot)
        pilot_look(session->pilot, &session->rig.look_right, &session->rig.look_up);
    const CameraMotion motion = camera_motion(session);
    camera_rig_advance(&session->rig, &session->flight, session->settings.view, &motion, passed_s);
    session->message_s = fmax(session->message_s - passed_s, 0.0);
}

double session_altitude_m(const FlightSession *session, const FlightInstruments *now) {
    return now->h_m - geoid_undulation_m(session->world->geoid, now->lat_rad / GEODESY_RAD_PER_DEG,
                                         now->lon_rad / GEODESY_RAD_PER_DEG);
}

// The pages of keys, from the tables of actions.
#define HELP_ROW(id, keys, help) {keys, help},
static const RenderHelpRow help_rows[] = {ACTION_HELD_TABLE(HELP_ROW) ACTION_ONCE_TABLE(HELP_ROW)};
static const RenderHelpRow replay_help_rows[] = {ACTION_REPLAY_TABLE(HELP_ROW) ACTION_ONCE_TABLE(HELP_ROW)};
#undef HELP_ROW

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

static RenderHud make_hud(const FlightSession *session, double frame_ms, double frame_p99_ms) {
    const FlightSettings *settings = &session->settings;
    FlightInstruments now = flight_instruments(&session->flight);
    bool only_path = session->playback && session->moment.only_path;
    return (RenderHud){.show_flight = settings->show_flight,
                       .show_numbers = settings->show_numbers,
                       .show_help = settings->show_help,
                       .help = session->playback ? replay_help_rows : help_rows,
                       .help_count = session->playback ? (int)COUNT_OF(replay_help_rows) : (int)COUNT_OF(help_rows),
                       .replay = make_replay(session),
                       .heading_rad = now.heading_rad,
                       .pitch_rad = now.pitch_rad,
                       .bank_rad = now.bank_rad,
                       .speed_m_s = now.speed_m_s,
                       .altitude_m = session_altitude_m(session, &now),
                       .above_ground_m = now.above_ground_m,
                       .vertical_speed_m_s = now.vertical_speed_m_s,
                       .throttle = only_path ? (double)NAN : session->flight.state.throttle,
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
                       .target_out_of_reach = session->governor.reach != GOVERNOR_IN_REACH,
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
    look->colouring = settings->colouring;
    look->wireframe = settings->wireframe;
    look->magenta_background = settings->magenta;
    look->hud = make_hud(session, frame_ms, frame_p99_ms);
    const double *back = look->camera.camera_from_ecef.m[2];
    order->view = (LodView){.eye_ecef = look->camera.eye_ecef,
                            .forward_ecef = vec3d(-back[0], -back[1], -back[2]),
                            // Of the whole picture in two halves too: comparing changes no triangle.
                            .px_per_rad = camera_px_per_rad(settings->fov_rad, width, height, settings->bound_corner),
                            .tau_px = settings->tau_px};
    if (session->message_s > 0.0)
        memcpy(order->message, session->message, sizeof order->message);
}
