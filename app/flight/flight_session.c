#include "app/flight/flight_session.h"

#include "app/recording/recording_bytes.h"
#include "base/log.h"
#include "base/statistics.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define TURN_RAD 6.283185307179586
#define PARKED_THROTTLE 0.02 // a slider at its stop may show so much

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

void session_hand_over(FlightSession *session, const Controls *before) {
    session->keyboard.controls = (Controls){.trim = fmin(fmax(before->elevator + before->trim, -1.0), 1.0),
                                            .throttle = before->throttle,
                                            .flaps = before->flaps,
                                            .gear_up = before->gear_up};
    if (session->pilot)
        pilot_keep(session->pilot, &session->keyboard);
    session->help = session->hold = (Autopilot){.engaged = false};
    session->hand_over = hand_over_begin(before);
}

static void take_over(FlightSession *session, const char *why) {
    session->demo_flies = false;
    session_hand_over(session, &session->flown);
    session_say(session, why);
}

// ---- the autopilot ----

static void hold_or_not(FlightSession *session) {
    FlightInstruments now = flight_instruments(&session->flight);
    session->holds = !session->holds;
    session_hand_over(session, &session->flown);
    session->wish = (AutopilotWish){.height_m = now.h_m, .heading_rad = now.heading_rad, .speed_m_s = now.speed_m_s};
    session->watch = terrain_watch_begin(&session->flight);
    session_say(session, session->holds ? "autopilot: this height, heading and speed" : "autopilot off");
}

static void end_hold(FlightSession *session) {
    if (!session->holds)
        return;
    session->holds = false;
    session_hand_over(session, &session->flown);
    session_say(session, "autopilot off: you have control");
}

void session_on_key(FlightSession *session, int key, bool pressed, unsigned modifiers) {
    if (session->playback && pressed && session_replay_key(session, key, modifiers))
        return;
    keyboard_on_key(&session->keyboard, key, pressed, (modifiers & KEY_SHIFT) != 0);
    if (session->settings.view == CAMERA_FREE || !keyboard_touches_controls(&session->keyboard))
        return;
    if (session->demo_flies)
        take_over(session, "you have control");
    end_hold(session);
}

void session_on_repeat(FlightSession *session, int key, unsigned modifiers) {
    if (session->playback && action_hop_s(action_of_replay_key(key, modifiers)) != 0.0)
        (void)session_replay_key(session, key, modifiers);
}

// After a crash the controls are those of the new start.
static void begin_again(FlightSession *session) {
    session->keyboard.controls = session->flown = session->flight.controls;
    session->hand_over = (HandOver){.begins = false};
    session->help = session->hold = session->demo.autopilot = (Autopilot){.engaged = false};
    session->holds = false;
    session->parked = session->flight.state.contact == FLIGHT_ROLLING;
}

// To where the flight began, as it began.
static void session_reset(FlightSession *session) {
    int64_t step = session->flight.state.step;
    session->flight.state = session->begin;
    session->flight.state.step = step;
    session->flight.controls = session->begin_controls;
    begin_again(session);
    if (session->recorder)
        recorder_restart(session->recorder, RECORDING_EVENT_RESET, &session->flight);
    session_say(session, "from the start");
}

// On a stand the demo flies when nobody else does.
static void restart_demo(FlightSession *session) {
    session->settings = session->begin_settings; // whatever the last visitor did to them
    session_reset(session);
    session->demo_flies = session->demo.count > 0 || session->demo.stick;
    demo_begin(&session->demo, &session->flight.controls);
    session->idle_s = 0.0;
    session_say(session, "demonstration: take the stick, or any key that steers");
}

static void watch_kiosk(FlightSession *session, double passed_s) {
    if (!(session->kiosk_idle_s > 0.0) || session->playback)
        return;
    bool steered = keyboard_touches_controls(&session->keyboard);
    bool goes_on = session->demo_flies && !session->settings.clock.paused;
    session->idle_s = goes_on || steered ? 0.0 : session->idle_s + passed_s;
    if (session->idle_s >= session->kiosk_idle_s)
        restart_demo(session);
}

// ---- the autopilot, held ----

// What it does not move is the pilot's.
static Controls held_controls(FlightSession *session, const Controls *pilot) {
    AutopilotWish wish = session->wish;
    if (session->flight.state.contact == FLIGHT_AIRBORNE)
        terrain_watch_change(&session->watch, &session->flight, &wish);
    Controls held = autopilot_hold(&session->hold, &session->flight, &wish, FLIGHT_STEP_S);
    held.flaps = pilot->flaps;
    held.gear_up = pilot->gear_up;
    held.brake_left = pilot->brake_left;
    held.brake_right = pilot->brake_right;
    session->keyboard.controls.throttle = held.throttle; // from where the pilot goes on
    return held;
}

static void move_flaps(FlightSession *session, bool down) {
    char message[PIPELINE_MESSAGE_BYTES];
    keyboard_move_flaps(&session->keyboard, down);
    snprintf(message, sizeof message, "flaps %.0f %%", 100.0 * session->keyboard.controls.flaps);
    session_say(session, session->aircraft.flaps_s > 0.0 ? message : "this aircraft has no flaps");
}

static void set_gear(FlightSession *session, bool up) {
    keyboard_set_gear(&session->keyboard, up);
    bool fixed = session->aircraft.gear_s <= 0.0;
    session_say(session, fixed ? "the gear is fixed" : up ? "gear up" : "gear down");
}

static void act(FlightSession *session, Action action) {
    char message[PIPELINE_MESSAGE_BYTES];
    if (session->playback && session_replay_act(session, action))
        return;
    switch (action) {
    case ACTION_LEAVE:
        session->leave_wanted = !(session->kiosk_idle_s > 0.0);
        if (!session->leave_wanted)
            restart_demo(session);
        return;
    case ACTION_AUTOPILOT:
        hold_or_not(session);
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
    case ACTION_FLAPS_DOWN:
    case ACTION_FLAPS_UP:
        move_flaps(session, action == ACTION_FLAPS_DOWN);
        return;
    case ACTION_GEAR_UP:
    case ACTION_GEAR_DOWN:
        set_gear(session, action == ACTION_GEAR_UP);
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
    if (!pilot_was_touched(session->pilot))
        return;
    session->idle_s = 0.0;
    if (session->demo_flies)
        take_over(session, "you have control");
    end_hold(session);
}

static void end_demo(FlightSession *session) {
    if (session->kiosk_idle_s > 0.0)
        restart_demo(session);
    else
        take_over(session, "the demo is over: you have control");
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

// An engine at idle would roll the aircraft off while its pilot still looks around.
static void hold_parked(FlightSession *session, Controls *controls) {
    bool stands = session->flight.state.contact == FLIGHT_ROLLING;
    session->parked = session->parked && stands && controls->throttle <= PARKED_THROTTLE;
    if (session->parked)
        controls->brake_left = controls->brake_right = 1.0;
}

// The model starts anew in the air; what began on its wheels goes back there instead, in the same moment.
static void leave_crash(FlightSession *session) {
    const FlightState *state = &session->flight.state;
    if (session->stood && state->contact == FLIGHT_CRASHED && state->crashed_s + FLIGHT_STEP_S >= FLIGHT_RESET_S)
        session_reset(session);
}

static void step(FlightSession *session) {
    leave_crash(session);
    Controls controls = sample_keyboard(session);
    hold_parked(session, &controls);
    if (session->demo_flies)
        controls = demo_fly(&session->demo, &session->flight, FLIGHT_STEP_S);
    else if (session->holds)
        controls = held_controls(session, &controls);
    else if (wants_help(session))
        controls = autopilot_assist(&session->help, &session->flight, &controls, FLIGHT_STEP_S);
    else
        session->help = (Autopilot){.engaged = false};
    if (!session->demo_flies)
        hand_over_ease(&session->hand_over, &controls, FLIGHT_STEP_S);
    session->flown = controls;
    const FlightState before = session->flight.state;
    if (session->recorder)
        recorder_fly(session->recorder, &session->flight, &controls);
    else
        flight_step(&session->flight, &controls, FLIGHT_STEP_S);
    shake_pads(session, &before);
    if (session->telemetry)
        telemetry_step(session->telemetry, &session->flight, session->world->geoid);
    session->crashes += before.contact != FLIGHT_CRASHED && session->flight.state.contact == FLIGHT_CRASHED;
    if (before.contact == FLIGHT_CRASHED && session->flight.state.contact != FLIGHT_CRASHED)
        begin_again(session);
    if (session->demo_flies && demo_is_over(&session->demo))
        end_demo(session);
}

static void act_on_presses(FlightSession *session) {
    for (Action action; (action = keyboard_next_action(&session->keyboard)) != ACTION_NONE;)
        act(session, action);
}

static void note_rate(FlightSession *session) {
    double rate = flight_clock_rate(&session->settings.clock);
    uint64_t bits;
    uint8_t data[sizeof bits];
    memcpy(&bits, &rate, sizeof bits);
    recording_put64(data, bits);
    recorder_event(session->recorder, RECORDING_EVENT_TIME_RATE, data, sizeof data);
}

// Of what has changed since the recording was told.
static void note_events(FlightSession *session) {
    const FlightClock *clock = &session->settings.clock;
    const SessionNoted before = session->noted;
    const SessionNoted now = {clock->paused, session->demo_flies, clock->rate - FLIGHT_CLOCK_NORMAL};
    if (!session->recorder || session->playback)
        return;
    session->noted = now;
    if (now.rate != before.rate)
        note_rate(session);
    if (now.demo != before.demo)
        recorder_event(session->recorder, now.demo ? RECORDING_EVENT_DEMO_ON : RECORDING_EVENT_DEMO_OFF, NULL, 0);
    if (now.paused != before.paused)
        recorder_event(session->recorder, now.paused ? RECORDING_EVENT_PAUSE : RECORDING_EVENT_RESUME, NULL, 0);
}

static void fly_steps(FlightSession *session, double passed_s) {
    int steps = flight_clock_steps(&session->settings.clock, passed_s, FLIGHT_STEP_S);
    double step_ns = FLIGHT_STEP_S / flight_clock_rate(&session->settings.clock) * 1e9;
    double end_ns = (double)session->now_ns - session->settings.clock.owed_s * 1e9;
    for (int i = 0; i < steps; i++) {
        hear_pads(session, session->now_ns ? (int64_t)(end_ns - (steps - i) * step_ns) : PILOT_EVERYTHING);
        act_on_presses(session);
        note_events(session);
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

// Of the flight that is flown or shown.
static double session_time_s(const FlightSession *session) {
    return session->playback ? session->timeline.t_s : (double)session->flight.state.step * FLIGHT_STEP_S;
}

void session_advance(FlightSession *session, double passed_s) {
    hear_recorder(session);
    if (session->pilot)
        pilot_poll(session->pilot);
    if (session->playback || session->settings.clock.paused)
        hear_pads(session, PILOT_EVERYTHING);
    act_on_presses(session);
    note_events(session);
    if (session->playback)
        session_replay_advance(session, passed_s);
    else
        fly_steps(session, passed_s);
    if (session->pilot)
        pilot_look(session->pilot, &session->rig.look_right, &session->rig.look_up);
    watch_kiosk(session, passed_s);
    session->propeller_rad =
        fmod(session->propeller_rad + TURN_RAD * session_propeller_rps(session) * passed_s, TURN_RAD);
    flight_map_note(&session->map, &session->flight, session_time_s(session));
    if (session->playback && session->settings.view == CAMERA_MAP)
        flight_map_look_ahead(&session->map, &session->flight.ground, session->playback);
    const CameraMotion motion = camera_motion(session);
    camera_rig_advance(&session->rig, &session->flight, session->settings.view, &motion, passed_s);
    session->message_s = fmax(session->message_s - passed_s, 0.0);
}
