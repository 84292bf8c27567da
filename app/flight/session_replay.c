// A session that shows a recorded flight instead of flying: time goes along it as keys say, and the aircraft is where
// it was.
#include "app/aircraft/airframe.h"
#include "app/aircraft/isa.h"
#include "app/aircraft/trim.h"
#include "app/flight/flight_session.h"
#include "base/log.h"
#include "base/rate.h"
#include "render/hud/hud_layout.h"
#include "terrain/geodesy.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define RATE_NORMAL 3 // of --time-rate's choices: 1
#define SPEED_LOOKS 40
#define SLOW_M_S 80.0
#define SPEED_LEAST 1.3      // times the stall speed, of a track that is taken over
#define TURN_SPEED_LEAST 1.1 // times the stall speed of its turn
#define RATE_MOST 1.0        // rad/s that are taken from a track
#define KMH_PER_M_S 3.6

static void tell_difference(FlightSession *session) {
    char when[RECORDING_TIME_BYTES], message[PIPELINE_MESSAGE_BYTES];
    int64_t step = playback_first_difference(session->playback);
    if (step < 0 || session->difference_said)
        return;
    session->difference_said = true;
    recording_time_text((uint64_t)step, RECORDING_STEPS_PER_S, when);
    log_warn("flown again it is another flight than was recorded, from step %" PRId64 " on (%s); every 10 s it begins "
             "anew with what was recorded",
             step, when);
    snprintf(message, sizeof message, "not as recorded, from %s on", when);
    session_say(session, message);
}

static void show_moment(FlightSession *session) {
    int64_t step = session->flight.state.step;
    session->moment = playback_at(session->playback, session->timeline.t_s);
    tell_difference(session);
    session->flight.state = session->moment.state;
    session->flight.state.step = step;
}

static Result find_start(FlightSession *session, const Options *options) {
    const char *text = options_text(options, OPTION_AT);
    double t_s = session->timeline.backwards ? session->timeline.duration_s : 0.0;
    char duration[TIMELINE_TEXT_BYTES];
    timeline_write(session->timeline.duration_s, duration);
    if (text && (!timeline_read(text, &t_s) || t_s > session->timeline.duration_s)) {
        log_error("%s: expected a time of the flight, as seconds, M:SS or H:MM:SS, up to %s; found '%s'",
                  options_where(options, OPTION_AT), duration, text);
        return RESULT_USAGE;
    }
    timeline_jump(&session->timeline, t_s);
    return RESULT_OK;
}

// Metres a second, over the whole track but for its gaps: as the speeds at evenly spread times say.
static double mean_speed(Playback *playback) {
    double sum = 0.0, duration_s = playback_duration_s(playback);
    int known = 0;
    for (int i = 0; i < SPEED_LOOKS; i++) {
        PlaybackMoment moment = playback_at(playback, duration_s * (i + 0.5) / SPEED_LOOKS);
        sum += vec3d_length(moment.state.velocity_ecef);
        known += !moment.in_gap;
    }
    return known > 0 ? sum / known : 0.0;
}

// A track does not say what flew it: most IGC files are of gliders, and what is slow is no jet.
static Result guess_aircraft(FlightSession *session, const Options *options) {
    if (options_is_given(options, OPTION_AIRCRAFT))
        return RESULT_OK;
    bool glides = strcmp(playback_format(session->playback), "igc") == 0;
    bool slow = mean_speed(session->playback) < SLOW_M_S;
    session->aircraft_name = glides ? "ask21" : slow ? "c172" : AIRCRAFT_DEFAULT;
    return aircraft_load(session->aircraft_name, &session->aircraft);
}

static Result take_aircraft(FlightSession *session, const Options *options) {
    const Aircraft *recorded = playback_aircraft(session->playback);
    if (!recorded)
        return guess_aircraft(session, options);
    session->aircraft = *recorded;
    session->aircraft_name = playback_aircraft_name(session->playback);
    return RESULT_OK;
}

Result session_begin_replay(FlightSession *session, Playback *playback, const Options *options) {
    session->playback = playback;
    Result aircraft = take_aircraft(session, options);
    if (aircraft != RESULT_OK)
        return aircraft;
    session->flight.wind_ecef = playback_wind(playback);
    session->demo_flies = false;
    session->timeline = timeline_create(playback_duration_s(playback));
    session->timeline.rate = options_choice(options, OPTION_REPLAY_RATE) - RATE_NORMAL;
    session->timeline.backwards = options_flag(options, OPTION_BACKWARDS);
    flight_map_take_replay(&session->map, playback);
    Result result = find_start(session, options);
    if (result == RESULT_OK)
        show_moment(session);
    return result;
}

// Also in the turn that it is in, which gliders fly slowly.
static double least_speed(const Aircraft *aircraft, const FlightInstruments *now) {
    double stall = airframe_stall_speed(aircraft, isa_at(now->h_m).density, 0.0);
    double carried = 1.0 / cos(fmin(fabs(now->bank_rad), TRIM_BANK_MOST));
    return stall * fmax(SPEED_LEAST, TURN_SPEED_LEAST * sqrt(carried));
}

// The speed as the HUD shows it.
static void say_taken(FlightSession *session, bool raised) {
    char message[PIPELINE_MESSAGE_BYTES];
    int bytes = snprintf(message, sizeof message, "you have control: %.40s", session->aircraft.id);
    if (raised)
        snprintf(message + bytes, sizeof message - (size_t)bytes, "; too slow to fly: started at %.0f km/h",
                 flight_instruments(&session->flight).calibrated_airspeed * KMH_PER_M_S);
    session_say(session, message);
}

// Of a track a steady flight is made from where it was.
static void fly_on_track(FlightSession *session) {
    const FlightInstruments now = flight_instruments(&session->flight);
    const Vec3d rate_body = session->flight.state.rate_body;
    double speed_m_s = fmax(now.speed_m_s, least_speed(&session->aircraft, &now));
    double climb = fmin(fmax(now.vertical_speed_m_s / speed_m_s, -1.0), 1.0);
    const FlightStart start = {.lat_rad = now.lat_rad,
                               .lon_rad = now.lon_rad,
                               .h_m = now.h_m,
                               .heading_rad = now.heading_rad,
                               .pitch_rad = asin(climb),
                               .speed_m_s = speed_m_s,
                               .bank_rad = now.bank_rad};
    session->flight = flight_create(&session->aircraft, &start, session->flight.ground);
    // What is slower than it flies turns as no aircraft does, and so do hands that hold a phone.
    if (speed_m_s == now.speed_m_s && vec3d_length(rate_body) < RATE_MOST)
        session->flight.state.rate_body = rate_body;
    say_taken(session, speed_m_s > now.speed_m_s);
}

// A recording's state is all there is to know.
static void fly_on(FlightSession *session) {
    session->flight.state = playback_at_step(session->playback, session->timeline.t_s).state;
    if (!playback_aircraft(session->playback))
        fly_on_track(session);
    else
        session_say(session, "you have control");
}

// The surfaces as they are; what a state does not tell, or not whole (flaps and gear on their way, brakes), as the
// recorded pilot had it.
static Controls controls_before(FlightSession *session) {
    const FlightState *state = &session->flight.state;
    Controls before;
    if (!playback_controls(session->playback, session->timeline.t_s, &before))
        before = (Controls){.flaps = state->flaps, .gear_up = state->gear < 0.5};
    before.elevator = state->elevator;
    before.trim = 0.0;
    before.aileron = state->aileron;
    before.rudder = state->rudder;
    before.throttle = state->throttle;
    return before;
}

void session_end_replay(FlightSession *session) {
    int64_t step = session->flight.state.step;
    fly_on(session);
    session->flown = controls_before(session);
    session->playback = NULL;
    session->flight.state.step = step;
    session->keyboard = keyboard_create(0.0);
    session->holds = session->parked = false;
    session_hand_over(session, &session->flown);
    session->begin = session->flight.state;
    session->begin_controls = session->keyboard.controls;
    session->stood = false;
    if (session->recorder)
        recorder_restart(session->recorder, RECORDING_EVENT_TAKE_OVER, &session->flight);
}

static void say_rate(FlightSession *session) {
    char message[PIPELINE_MESSAGE_BYTES], rate[RATE_BYTES];
    rate_write(timeline_rate(&session->timeline), rate);
    snprintf(message, sizeof message, "replay %s", rate);
    session_say(session, message);
}

static void jump(FlightSession *session, double t_s) {
    timeline_jump(&session->timeline, t_s);
    show_moment(session);
}

static void act_on_time(FlightSession *session, Action action) {
    Timeline *timeline = &session->timeline;
    switch (action) {
    case ACTION_REPLAY_FASTER:
    case ACTION_REPLAY_SLOWER:
        timeline_change_rate(timeline, action == ACTION_REPLAY_FASTER ? 1 : -1);
        say_rate(session);
        return;
    case ACTION_REPLAY_TURN:
        timeline_turn(timeline);
        say_rate(session);
        return;
    case ACTION_REPLAY_PLAY:
        timeline_play_or_pause(timeline);
        show_moment(session);
        return;
    default:
        return;
    }
}

bool session_replay_key(FlightSession *session, int key, unsigned modifiers) {
    Action action = action_of_replay_key(key, modifiers);
    const Timeline *timeline = &session->timeline;
    // The free view is flown with the keys that fly.
    if (action == ACTION_NONE ||
        (session->settings.view == CAMERA_FREE && action_of_key(key, false) < ACTION_HELD_COUNT &&
         action_of_key(key, false) != ACTION_NONE))
        return false;
    if (action == ACTION_REPLAY_TAKE_OVER)
        session_end_replay(session);
    else if (action == ACTION_REPLAY_TENTH)
        jump(session, timeline->duration_s * (key - '0') / 10.0);
    else if (action == ACTION_REPLAY_START || action == ACTION_REPLAY_END)
        jump(session, action == ACTION_REPLAY_START ? 0.0 : timeline->duration_s);
    else if (action_hop_s(action) != 0.0)
        jump(session, timeline->t_s + action_hop_s(action));
    else
        act_on_time(session, action);
    return true;
}

bool session_replay_act(FlightSession *session, Action action) {
    switch (action) {
    case ACTION_PAUSE:
        act_on_time(session, ACTION_REPLAY_PLAY);
        return true;
    case ACTION_TIME_FASTER:
        act_on_time(session, ACTION_REPLAY_FASTER);
        return true;
    case ACTION_TIME_SLOWER:
        act_on_time(session, ACTION_REPLAY_SLOWER);
        return true;
    default:
        if (action < ACTION_FLYING_FIRST || action > ACTION_FLYING_LAST)
            return false;
        session_say(session, "this is a replay: Enter takes over the controls");
        return true;
    }
}

static bool shows_bar(const FlightSession *session, int width, int height) {
    return session->playback && session->settings.show_flight && !session->settings.show_help &&
           width >= HUD_WIDTH_LEAST && height >= HUD_HEIGHT_LEAST;
}

// The moment itself is looked up once a frame, however often the mouse tells where it is.
void session_on_pointer(FlightSession *session, double x, double y, bool down, int width, int height) {
    HudLayout layout = hud_layout_make(width, height, false);
    HudReplayPlace place = hud_layout_replay(&layout, session->moment.derived);
    if (down && !session->pointer_down)
        session->scrubs = shows_bar(session, width, height) && hud_replay_is_on(&place, x, y);
    session->pointer_down = down;
    session->scrubs = session->scrubs && down && session->playback;
    if (session->scrubs)
        timeline_jump(&session->timeline, session->timeline.duration_s * hud_replay_share(&place, x));
}

void session_replay_advance(FlightSession *session, double passed_s) {
    if (!session->scrubs)
        timeline_advance(&session->timeline, passed_s);
    show_moment(session);
    if (session->telemetry)
        telemetry_show(session->telemetry, session->timeline.t_s, &session->flight, session->world->geoid,
                       session->moment.only_path);
}
