#define _POSIX_C_SOURCE 200809L
#include "app/flight/flight_loop.h"

#include "app/pipeline/picture.h"
#include "app/signals.h"
#include "base/clock.h"
#include "base/log.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

// Without a person to wait for, a frame is this much of the flight, whatever it takes to draw.
#define FIXED_FRAME_S (1.0 / 60.0)
#define PICTURE_SPACING 60 // frames, where the length of the flight is not known beforehand

static void on_key(void *user, int key, int scancode, bool pressed, bool repeated, unsigned modifiers) {
    (void)scancode; // key codes already name positions
    FlightLoop *loop = user;
    if (repeated)
        session_on_repeat(loop->session, key, modifiers);
    else
        session_on_key(loop->session, key, pressed, modifiers);
}

static void on_pointer(void *user, double x, double y, bool down) {
    FlightLoop *loop = user;
    session_on_pointer(loop->session, x, y, down, loop->width, loop->height);
}

static void on_resize(void *user, int width, int height) {
    FlightLoop *loop = user;
    if (width > 0 && height > 0) { // a minimised window has no pixels
        loop->width = width;
        loop->height = height;
    }
}

static bool has_demo(const FlightSession *session) {
    return session->demo.count > 0 || session->demo.stick;
}

static bool is_over(const FlightLoop *loop, int64_t ordered) {
    bool demo_over =
        !loop->window && loop->frames == 0 && has_demo(loop->session) && demo_is_over(&loop->session->demo);
    bool replay_over = !loop->window && loop->frames == 0 && loop->session->playback &&
                       timeline_is_at_end(&loop->session->timeline) && ordered > 0;
    return (loop->frames > 0 && ordered >= loop->frames) || loop->session->leave_wanted || demo_over || replay_over ||
           (loop->window && context_should_close(loop->context)) || signals_leave_wanted();
}

// What a frame is of the flight where none waits for the clock: exactly, as a film needs it.
static double frame_s(const FlightLoop *loop) {
    return loop->session->playback ? 1.0 / loop->fps : FIXED_FRAME_S;
}

// The frames that the pictures are spread over.
static int64_t expected_frames(const FlightLoop *loop) {
    const FlightSession *session = loop->session;
    if (loop->frames > 0)
        return loop->frames;
    if (session->playback)
        return (int64_t)(timeline_left_s(&session->timeline) / frame_s(loop)) + 1;
    if (!has_demo(session))
        return (int64_t)loop->picture_count * PICTURE_SPACING;
    FlightInstruments now = flight_instruments(&session->flight);
    double duration_s = demo_duration_s(&session->demo, now.lat_rad, now.lon_rad);
    return (int64_t)(duration_s / (FIXED_FRAME_S * flight_clock_rate(&session->settings.clock))) + 1;
}

// Whether frame `index` of the flight is one of the evenly spread pictures.
static bool is_picture(const FlightLoop *loop, int64_t index) {
    if (loop->pictures && loop->every > 0)
        return index % loop->every == 0;
    if (!loop->pictures || index >= loop->picture_frames)
        return false;
    int64_t frames = loop->picture_frames, count = loop->picture_count;
    return ((index + 1) * count + frames - 1) / frames > (index * count + frames - 1) / frames;
}

// One at a time: the next one waits, and so gets another name.
static void ask_for_picture(FlightLoop *loop, FrameOrder *order) {
    loop->session->screenshot_wanted = false;
    order->asked = picture_new_name((int64_t)time(NULL), order->picture) == RESULT_OK;
    if (order->asked)
        snprintf(loop->asked, sizeof loop->asked, "%s", order->picture);
    else
        session_say(loop->session, "no picture: the folder for pictures has too long a name");
}

// What became of it.
static void hear_picture(FlightLoop *loop, const PipelineStats *stats) {
    char message[PIPELINE_MESSAGE_BYTES];
    if (stats->asked == loop->asked_heard)
        return;
    loop->asked_heard = stats->asked;
    if (stats->asked_failure == RESULT_OK)
        log_info("picture: %s", loop->asked);
    snprintf(message, sizeof message,
             stats->asked_failure == RESULT_OK ? "picture: %.140s" : "no picture: %.110s cannot be written",
             loop->asked);
    session_say(loop->session, message);
    loop->asked[0] = '\0';
}

static void name_picture(FlightLoop *loop, int64_t index, FrameOrder *order) {
    bool last = loop->screenshot && loop->frames > 0 && index + 1 == loop->frames;
    if (last)
        snprintf(order->picture, sizeof order->picture, "%s", loop->screenshot);
    else if (is_picture(loop, index))
        snprintf(order->picture, sizeof order->picture, "%s/" FLIGHT_PICTURE_BEGIN "%03d.png", loop->pictures,
                 ++loop->pictures_begun);
    else if (loop->session->screenshot_wanted && !loop->asked[0])
        ask_for_picture(loop, order);
}

static void make_order(FlightLoop *loop, int64_t index, FrameOrder *order) {
    PipelineStats stats = pipeline_stats(loop->pipeline);
    hear_picture(loop, &stats);
    session_hear_changes(loop->session, &stats.changes, stats.cut.method);
    session_govern(loop->session, &stats);
    session_order(loop->session, loop->width, loop->height, stats.frame_ms, stats.frame_p99_ms, order);
    monitor_follow(loop->monitor, loop->session->settings.show_accuracy, order);
    order->film = loop->film && index >= 0;
    if (index >= 0)
        name_picture(loop, index, order);
}

// The last frame once more, as it is only now known to be the last.
static Result draw_last_picture(FlightLoop *loop) {
    FrameOrder order;
    make_order(loop, -1, &order);
    snprintf(order.picture, sizeof order.picture, "%s", loop->screenshot);
    return pipeline_submit(loop->pipeline, &order, true);
}

// Waits until the next frame is due; without a window nobody watches, and nothing waits.
static double pass_time(const FlightLoop *loop, int64_t *due_ns, int64_t *last_ns) {
    if (!loop->window || loop->lockstep)
        return frame_s(loop);
    *due_ns += (int64_t)(1e9 / loop->fps);
    int64_t now_ns = clock_now_ns();
    if (*due_ns < now_ns)
        *due_ns = now_ns;
    clock_sleep_until_ns(*due_ns);
    now_ns = clock_now_ns();
    double passed_s = (double)(now_ns - *last_ns) * 1e-9;
    *last_ns = now_ns;
    return passed_s;
}

static Result fly_frames(FlightLoop *loop) {
    bool every_frame_counts = !loop->window || loop->lockstep || loop->frames > 0;
    int64_t last_ns = clock_now_ns(), due_ns = last_ns;
    FrameOrder order;
    int64_t index = 0;
    for (; !is_over(loop, index); index++) {
        make_order(loop, index, &order);
        Result result = pipeline_submit(loop->pipeline, &order, every_frame_counts);
        if (result != RESULT_OK)
            return result;
        double passed_s = pass_time(loop, &due_ns, &last_ns);
        if (loop->window)
            context_poll_events(loop->context);
        loop->session->now_ns = loop->window && !loop->lockstep ? last_ns : 0;
        session_advance(loop->session, passed_s);
        if ((!loop->window || loop->lockstep) && loop->session->recorder)
            recorder_wait(loop->session->recorder);
    }
    bool picture_due = loop->screenshot && !(loop->frames > 0 && index >= loop->frames);
    return picture_due ? draw_last_picture(loop) : RESULT_OK;
}

Result flight_loop_run(FlightLoop *loop) {
    sigset_t before;
    signals_hold(&before);
    loop->picture_frames = expected_frames(loop);
    if (loop->window) {
        context_on_key(loop->context, on_key, loop);
        context_on_pointer(loop->context, on_pointer, loop);
        context_on_resize(loop->context, on_resize, loop);
    }
    Result result = fly_frames(loop);
    Result drained = pipeline_drain(loop->pipeline);
    PipelineStats stats = pipeline_stats(loop->pipeline);
    hear_picture(loop, &stats);
    if (loop->window) {
        context_on_key(loop->context, NULL, NULL);
        context_on_pointer(loop->context, NULL, NULL);
        context_on_resize(loop->context, NULL, NULL);
    }
    signals_restore(&before);
    return result != RESULT_OK ? result : drained;
}
