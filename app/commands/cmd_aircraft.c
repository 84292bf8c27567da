#include "app/commands/command.h"
#include "app/performance/performance_report.h"
#include "base/log.h"

#include <stdlib.h>

// Aircraft one by one, and what they can do.
typedef struct Fleet {
    int count;
    bool measured;
    Aircraft *aircraft;        // [count]
    Performance *performances; // [count]
    PerformanceReport *reports;
} Fleet;

static Result make_room(Fleet *fleet, int count) {
    fleet->count = count;
    size_t room = count > 0 ? (size_t)count : 1;
    fleet->aircraft = calloc(room, sizeof *fleet->aircraft);
    fleet->performances = calloc(room, sizeof *fleet->performances);
    fleet->reports = calloc(room, sizeof *fleet->reports);
    if (fleet->aircraft && fleet->performances && fleet->reports)
        return RESULT_OK;
    log_error("no memory for %d aircraft", count);
    return RESULT_MEMORY;
}

static void destroy_fleet(Fleet *fleet) {
    free(fleet->aircraft);
    free(fleet->performances);
    free(fleet->reports);
}

static Result measure(Fleet *fleet, int index) {
    const Aircraft *aircraft = &fleet->aircraft[index];
    Result result = performance_measure(aircraft, &fleet->performances[index]);
    if (result == RESULT_RANGE)
        log_error("%s: there is no steady flight at the cruise speed of %.1f m/s and %.0f m; change 'cruise-speed'",
                  aircraft->id, aircraft->cruise_speed, PERFORMANCE_HEIGHT_M);
    return result;
}

static Result load(Fleet *fleet, const char *name, int index) {
    Result result = aircraft_load(name, &fleet->aircraft[index]);
    fleet->reports[index] = (PerformanceReport){&fleet->aircraft[index], NULL};
    if (result == RESULT_OK && fleet->measured) {
        fleet->reports[index].performance = &fleet->performances[index];
        result = measure(fleet, index);
    }
    return result;
}

static Result load_named(const Options *options, Fleet *fleet) {
    Result result = make_room(fleet, options_positional_count(options));
    fleet->measured = true;
    for (int i = 0; i < fleet->count && result == RESULT_OK; i++)
        result = load(fleet, options_positionals(options)[i], i);
    return result;
}

static Result load_all(Fleet *fleet) {
    NamedFiles list;
    Result result = aircraft_list(&list);
    if (result == RESULT_OK)
        result = make_room(fleet, list.count);
    for (int i = 0; i < fleet->count && result == RESULT_OK; i++)
        result = load(fleet, list.names[i], i);
    return result;
}

Result cmd_aircraft(const Options *options) {
    Fleet fleet = {.count = 0};
    Result result = options_positional_count(options) > 0 ? load_named(options, &fleet) : load_all(&fleet);
    if (result == RESULT_OK && options_flag(options, OPTION_JSON))
        result = performance_report_json(fleet.reports, fleet.count);
    else if (result == RESULT_OK)
        for (int i = 0; i < fleet.count; i++)
            performance_report_text(&fleet.reports[i]);
    destroy_fleet(&fleet);
    return result;
}
