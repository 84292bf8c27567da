#define _POSIX_C_SOURCE 200809L
#include "app/devices/device_calibrate.h"

#include "app/devices/calibrator.h"
#include "app/devices/device_list.h"
#include "app/devices/device_print.h"
#include "app/joystick/joystick_files.h"
#include "app/signals.h"
#include "base/clock.h"
#include "base/log.h"

#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LOOK_NS INT64_C(20000000)
#define REDRAW_NS INT64_C(100000000)
#define EVENTS 64
#define OFF_CENTRE 0.1 // of the way from end to end

typedef struct Session {
    Devices *devices;
    DeviceList list; // for names of axes, and what was kept before
    Calibrator calibrator;
    CalibratorPhase told; // of which phase the person was told
    bool draws;           // stdout is a terminal
    bool hears;           // stdin has not ended
    int drawn_lines;
    int64_t drawn_ns;
} Session;

static void take_events(Session *session) {
    DeviceEvent events[EVENTS];
    int count;
    while ((count = devices_poll(session->devices, events, EVENTS)) > 0)
        for (int i = 0; i < count; i++) {
            device_list_take(&session->list, &events[i]);
            calibrator_take(&session->calibrator, &events[i]);
        }
}

// Whether a line came since. Without a person who could type one there is the time's end.
static bool enter_was_pressed(Session *session) {
    struct pollfd input = {.fd = STDIN_FILENO, .events = POLLIN};
    char bytes[256];
    if (!session->hears || poll(&input, 1, 0) <= 0)
        return false;
    ssize_t count = read(STDIN_FILENO, bytes, sizeof bytes);
    session->hears = count > 0;
    bool pressed = count > 0 && memchr(bytes, '\n', (size_t)count) != NULL;
    session->drawn_lines += pressed && session->drawn_lines > 0; // the terminal shows it below the drawing
    return pressed;
}

// ---- What the person sees ----

static int print_pad(const DeviceRow *row, const CalibratorPad *pad) {
    printf("%s (%04x:%04x)\n  axis           from   centre       to\n", row->info.name, row->info.vendor,
           row->info.product);
    for (int i = 0; i < row->info.axis_count; i++) {
        char name[32];
        const AxisCalibration *axis = &pad->calibration.axes[i];
        device_row_axis_name(row, i, name);
        if (axis->known)
            printf("  %-12s %+6.3f   %+6.3f   %+6.3f\n", name, axis->min, axis->centre, axis->max);
        else
            printf("  %-12s not moved\n", name);
    }
    return row->info.axis_count + 2;
}

static int print_pads(const Session *session) {
    int lines = 0;
    for (int i = 0; i < DEVICES_MAX; i++)
        if (session->calibrator.pads[i].there)
            lines += print_pad(&session->list.rows[i], &session->calibrator.pads[i]);
    return lines;
}

// In place of the last drawing (ECMA-48, CPL and ED).
static void draw(Session *session) {
    if (session->drawn_lines > 0)
        printf("\033[%dF\033[J", session->drawn_lines);
    session->drawn_lines = print_pads(session);
    fflush(stdout);
}

static void draw_sometimes(Session *session, int64_t now_ns) {
    if (!session->draws || session->calibrator.phase != CALIBRATOR_MOVING || now_ns - session->drawn_ns < REDRAW_NS)
        return;
    session->drawn_ns = now_ns;
    draw(session);
}

static void ask_to_rest(double seconds_max) {
    printf("Let go of all sticks and pedals, and leave the levers where they are.\n"
           "(Enter: they rest. Ctrl-C leaves, and nothing changes. All ends after %g s.)\n",
           seconds_max);
    fflush(stdout);
}

static void ask_to_move(Session *session) {
    if (session->told == session->calibrator.phase)
        return;
    session->told = session->calibrator.phase;
    printf("Now move every stick, lever and pedal to all of its ends, some times. Enter when done.\n");
    fflush(stdout);
}

// ---- What happens ----

// Until it is done, or left: false.
static bool go_through(Session *session, int64_t until_ns) {
    int64_t last_ns = clock_now_ns(), now_ns = last_ns;
    while (session->calibrator.phase != CALIBRATOR_DONE && now_ns < until_ns) {
        if (signals_leave_wanted())
            return false;
        clock_sleep_until_ns(now_ns + LOOK_NS);
        now_ns = clock_now_ns();
        take_events(session);
        calibrator_advance(&session->calibrator, (double)(now_ns - last_ns) * 1e-9);
        if (enter_was_pressed(session))
            calibrator_next(&session->calibrator);
        if (session->calibrator.phase == CALIBRATOR_MOVING)
            ask_to_move(session);
        draw_sometimes(session, now_ns);
        last_ns = now_ns;
    }
    return true;
}

// A stick that seems to rest near its end was held when it was told first.
static bool is_off_centre(const DeviceRow *row, int index, const AxisCalibration *axis) {
    const AxisMapping *mapping = device_row_mapping(row, index);
    double span = axis->max - axis->min;
    bool near_an_end = fmin(axis->centre - axis->min, axis->max - axis->centre) < OFF_CENTRE * span;
    return axis->known && mapping && pad_control_least(mapping->control) < 0.0 && near_an_end;
}

static void forget_off_centre(Session *session) {
    for (int i = 0; i < DEVICES_MAX; i++) {
        const DeviceRow *row = &session->list.rows[i];
        CalibratorPad *pad = &session->calibrator.pads[i];
        for (int k = 0; pad->there && k < row->info.axis_count; k++) {
            char name[32];
            if (!is_off_centre(row, k, &pad->calibration.axes[k]))
                continue;
            device_row_axis_name(row, k, name);
            printf("%s: %s seemed to rest at %+.3f, near its end, and is not kept: let go of it first, and once more\n",
                   row->info.name, name, pad->calibration.axes[k].centre);
            pad->calibration.axes[k].known = false;
        }
    }
}

static Result keep_pad(const CalibratorPad *pad, const DeviceRow *row) {
    if (calibrator_learned(pad) == 0) {
        printf("%s: nothing was learned; its calibration stays\n", row->info.name);
        return RESULT_OK;
    }
    PadCalibration merged = calibrator_merge(pad, &row->calibration);
    Result result = joystick_save_calibration(&row->info, &merged);
    if (result == RESULT_OK)
        printf("%s: %d of %d axes are kept, for all devices %04x:%04x\n", row->info.name, calibrator_learned(pad),
               row->info.axis_count, row->info.vendor, row->info.product);
    return result;
}

static Result keep(const Session *session) {
    char path[PATHS_BYTES_MAX];
    Result result = RESULT_OK;
    for (int i = 0; i < DEVICES_MAX && result == RESULT_OK; i++)
        if (session->calibrator.pads[i].there)
            result = keep_pad(&session->calibrator.pads[i], &session->list.rows[i]);
    if (result == RESULT_OK && joystick_calibration_file(path))
        printf("File: %s\n", path);
    return result;
}

static Result finish(Session *session, double seconds_max) {
    if (session->calibrator.phase == CALIBRATOR_RESTING) {
        log_error("devices: within %g s the sticks were never left alone for %g s; if they tremble by themselves, "
                  "press Enter while nobody touches them",
                  seconds_max, CALIBRATOR_STILL_S);
        return RESULT_RANGE;
    }
    if (session->calibrator.phase == CALIBRATOR_MOVING)
        calibrator_next(&session->calibrator);
    draw(session);
    forget_off_centre(session);
    return keep(session);
}

static Result run(Session *session, double seconds_max) {
    take_events(session);
    if (calibrator_pads(&session->calibrator) == 0) {
        device_print_list(stdout, &session->list, devices_lack(session->devices));
        fflush(stdout);
        log_error("devices: there is nothing to calibrate: plug in a stick that may be read");
        return RESULT_NOT_FOUND;
    }
    ask_to_rest(seconds_max);
    if (go_through(session, clock_now_ns() + (int64_t)(seconds_max * 1e9)))
        return finish(session, seconds_max);
    printf("Left; nothing has changed.\n");
    return RESULT_OK;
}

Result device_calibrate(Devices *devices, double seconds_max) {
    Session *session = calloc(1, sizeof *session);
    if (!session) {
        log_error("devices: no memory for %zu bytes", sizeof *session);
        return RESULT_MEMORY;
    }
    session->devices = devices;
    session->draws = isatty(STDOUT_FILENO);
    session->hears = true;
    device_list_init(&session->list);
    calibrator_init(&session->calibrator);
    Result result = run(session, seconds_max);
    free(session);
    return result;
}
