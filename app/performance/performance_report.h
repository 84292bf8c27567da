// app/performance/performance_report.h: the tables of aircraft, for people and for programs.
// Metres a second, seconds.
// Borrows everything.
#pragma once
#include "app/performance/performance.h"

typedef struct PerformanceReport {
    const Aircraft *aircraft;
    const Performance *performance; // NULL: the aircraft is listed only
} PerformanceReport;

// One JSON document on stdout: {aircraft: [{name, title, engine, mass_kg, ..., rows: [{name, unit, theory, simulation,
// published, theory_is}]}]}. MEMORY, IO.
MUST_USE Result performance_report_json(const PerformanceReport *reports, int count);
void performance_report_text(const PerformanceReport *report);
