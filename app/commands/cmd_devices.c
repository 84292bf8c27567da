#define _POSIX_C_SOURCE 200809L
#include "app/commands/command.h"
#include "app/devices/device_calibrate.h"
#include "app/devices/device_print.h"
#include "app/signals.h"
#include "base/clock.h"
#include "base/log.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#define LOOK_S 5.0                          // that devices may take to be found
#define FIRST_REPORTS_NS INT64_C(300000000) // wait for what devices say without being touched
#define REDRAW_NS INT64_C(50000000)
#define EVENTS 64
#define CALIBRATE_S 60.0

typedef struct Show {
    Devices *devices;
    DeviceList list;
    bool json, redraws, lines;
    int64_t printed[DEVICES_MAX]; // reports of each, when its line was printed last
} Show;

static void print_change(const DeviceEvent *event, const DeviceRow *row) {
    static const char *const what[] = {
        [DEVICE_ARRIVED] = "arrived", [DEVICE_DENIED] = "cannot be read", [DEVICE_LEFT] = "left"};
    if (event->kind != DEVICE_REPORT)
        printf("%s: %s %s\n", row->info.path, row->info.name, what[event->kind]);
}

static void take_events(Show *show) {
    DeviceEvent events[EVENTS];
    int count;
    while ((count = devices_poll(show->devices, events, EVENTS)) > 0)
        for (int i = 0; i < count; i++) {
            device_list_take(&show->list, &events[i]);
            if (events[i].kind == DEVICE_ARRIVED)
                show->printed[events[i].slot] = 0;
            if (show->lines)
                print_change(&events[i], &show->list.rows[events[i].slot]);
        }
}

static void print_states(Show *show) {
    for (int i = 0; i < DEVICES_MAX; i++) {
        const DeviceRow *row = &show->list.rows[i];
        if (row->there && row->reports > show->printed[i])
            device_print_state(stdout, row);
        show->printed[i] = row->reports;
    }
    fflush(stdout);
}

// In place: the cursor goes home, and what was there is wiped first (ECMA-48, CUP and ED).
static void redraw(const Show *show) {
    printf("\033[H\033[J");
    device_print_list(stdout, &show->list, devices_lack(show->devices));
    printf("Ctrl-C leaves.\n");
    fflush(stdout);
}

static void watch(Show *show, int64_t until_ns) {
    int64_t now_ns = clock_now_ns();
    take_events(show);
    if (show->lines && device_list_count(&show->list) == 0)
        device_print_list(stdout, &show->list, devices_lack(show->devices));
    while (!signals_leave_wanted() && (until_ns == 0 || now_ns < until_ns)) {
        take_events(show);
        if (show->redraws)
            redraw(show);
        else if (show->lines)
            print_states(show);
        now_ns += REDRAW_NS;
        clock_sleep_until_ns(now_ns);
    }
    take_events(show);
}

static void look_once(Show *show) {
    clock_sleep_until_ns(clock_now_ns() + FIRST_REPORTS_NS);
    take_events(show);
}

static Result print_result(const Show *show, bool watched) {
    const char *lack = devices_lack(show->devices);
    if (show->json)
        return device_print_json(&show->list, lack);
    if (!watched)
        device_print_list(stdout, &show->list, lack);
    return RESULT_OK;
}

static double seconds_of(const Options *options, double otherwise) {
    return options_is_set(options, OPTION_WATCH_SECONDS) ? options_number(options, OPTION_WATCH_SECONDS) : otherwise;
}

static Result check(const Options *options) {
    bool calibrates = options_flag(options, OPTION_CALIBRATE);
    if (!calibrates || (!options_flag(options, OPTION_WATCH) && !options_flag(options, OPTION_JSON)))
        return RESULT_OK;
    log_error("devices: --calibrate asks a person: expected neither --watch nor --json with it");
    return RESULT_USAGE;
}

static Result run(Show *show, const Options *options) {
    bool watches = options_flag(options, OPTION_WATCH);
    double seconds = seconds_of(options, 0.0);
    int64_t until_ns = seconds > 0.0 ? clock_now_ns() + (int64_t)(seconds * 1e9) : 0;
    show->json = options_flag(options, OPTION_JSON);
    show->redraws = watches && !show->json && isatty(STDOUT_FILENO);
    show->lines = watches && !show->json && !show->redraws;
    if (!devices_wait(show->devices, LOOK_S))
        log_warn("devices: after %g s some are still being looked at", LOOK_S);
    if (options_flag(options, OPTION_CALIBRATE))
        return device_calibrate(show->devices, seconds_of(options, CALIBRATE_S));
    if (watches)
        watch(show, until_ns);
    else
        look_once(show);
    return print_result(show, watches);
}

Result cmd_devices(const Options *options) {
    sigset_t before;
    if (check(options) != RESULT_OK)
        return RESULT_USAGE;
    Show *show = calloc(1, sizeof *show);
    if (!show) {
        log_error("devices: no memory for %zu bytes", sizeof *show);
        return RESULT_MEMORY;
    }
    if (!options_flag(options, OPTION_VERBOSE))
        log_set_level(LOG_ERROR); // the list says what the log would
    signals_hold(&before);
    device_list_init(&show->list);
    Result result = devices_create(NULL, &show->devices);
    if (result == RESULT_OK)
        result = run(show, options);
    devices_destroy(&show->devices);
    signals_restore(&before);
    free(show);
    return result;
}
