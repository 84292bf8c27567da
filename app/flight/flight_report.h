// app/flight/flight_report.h: what a flight was, for people and for programs.
// Degrees, metres above the geoid, metres a second, milliseconds.
// Borrows everything.
#pragma once
#include "app/flight/flight_session.h"
#include "app/pipeline/pipeline.h"
#include "render/context/context.h"

typedef struct FlightReport {
    const FlightSession *session;
    PipelineStats stats;
    PipelineTimes times;
    const RenderAccuracy *accuracy; // as the panel told it last
    const Context *context;
    bool window;
} FlightReport;

// One JSON document on stdout.
MUST_USE Result flight_report_json(const FlightReport *report);
// One line in the log.
void flight_report_log(const FlightReport *report);
