// app/live/live_report.h: what the panel of accuracy showed, for programs.
// As render/accuracy.h.
// Borrows everything.
#pragma once
#include "app/json.h"
#include "render/accuracy.h"

// "accuracy": {tau_px, frame_ms, measured, curve, p50, p99, stack}; nothing where the panel never was open.
void live_report_add(Json *parent, const RenderAccuracy *shown);
