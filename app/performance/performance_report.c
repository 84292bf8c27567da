#include "app/performance/performance_report.h"

#include "app/json.h"

#include <math.h>
#include <stdio.h>

static void add_rows(Json *json, const Performance *performance) {
    json_add_number(json, "modes_speed_m_s", performance->modes_speed);
    json_add_number(json, "modes_height_m", PERFORMANCE_HEIGHT_M);
    Json *rows = json_add_array(json, "rows");
    for (int i = 0; i < performance->count; i++) {
        const PerformanceRow *row = &performance->rows[i];
        Json *object = json_append_object(rows);
        json_add_text(object, "name", row->name);
        json_add_text(object, "unit", row->unit);
        json_add_number(object, "theory", row->theory);
        json_add_text(object, "theory_is", row->theory_is);
        json_add_number(object, "simulation", row->simulation);
        json_add_number(object, "published", row->published);
    }
}

static void add_aircraft(Json *array, const PerformanceReport *report) {
    const Aircraft *a = report->aircraft;
    Json *json = json_append_object(array);
    json_add_text(json, "name", a->id);
    json_add_text(json, "title", a->name);
    json_add_text(json, "engine", aircraft_engine_name((AircraftEngine)a->engine));
    json_add_number(json, "mass_kg", a->mass);
    json_add_number(json, "wing_m2", a->area);
    json_add_number(json, "span_m", a->span);
    json_add_number(json, "cruise_m_s", a->cruise_speed);
    json_add_number(json, "never_exceed_m_s", a->never_exceed_speed);
    json_add_number(json, "mach_limit", a->mach_limit);
    json_add_text(json, "source", a->source);
    json_add_text(json, "published_source", *a->published.source ? a->published.source : NULL);
    if (report->performance)
        add_rows(json, report->performance);
}

Result performance_report_json(const PerformanceReport *reports, int count) {
    Json *json = json_create();
    Json *array = json_add_array(json, "aircraft");
    for (int i = 0; i < count; i++)
        add_aircraft(array, &reports[i]);
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

static void print_figure(double value, int width) {
    if (isfinite(value))
        printf("%*.*f", width, fabs(value) < 1.0 ? 4 : 2, value);
    else
        printf("%*s", width, "-");
}

void performance_report_text(const PerformanceReport *report) {
    const Aircraft *a = report->aircraft;
    const Performance *performance = report->performance;
    printf("%s: %s, %.0f kg, %.2f m2, span %.2f m, engine %s\n", a->id, a->name, a->mass, a->area, a->span,
           aircraft_engine_name((AircraftEngine)a->engine));
    if (!performance)
        return;
    printf("  data: %s\n", a->source);
    printf("  published: %s\n", *a->published.source ? a->published.source : "-");
    printf("  modes at %.1f m/s, %.0f m; the rest at sea level\n", performance->modes_speed, PERFORMANCE_HEIGHT_M);
    printf("  %-24s%12s%12s%12s\n", "", "theory", "simulation", "published");
    for (int i = 0; i < performance->count; i++) {
        const PerformanceRow *row = &performance->rows[i];
        printf("  %-24s", row->name);
        print_figure(row->theory, 12);
        print_figure(row->simulation, 12);
        print_figure(row->published, 12);
        printf("%s%s\n", *row->unit ? "  " : "", row->unit);
    }
}
