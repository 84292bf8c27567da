// app/live/monitor.h: what the panel of accuracy against time shows, while a flight goes on: the error of a drawn cut,
// measured, and frame time against tolerance. A thread of lowest priority does the work, in a small share of the
// machine's time, and only while the panel is open.
// Milliseconds, pixels.
// A Monitor owns its thread, its Lod and a copy of one cut; it borrows the Pipeline, and ends before it. One thread,
// the one that submits, uses it.
#pragma once
#include "app/pipeline/pipeline.h"
#include "base/base.h"
#include "render/accuracy.h"

#define MONITOR_SHARE 0.005 // of all processors' time

typedef struct MonitorOptions {
    LodOptions lod; // of the flight
    const Terrain *terrain;
    Pipeline *pipeline;
} MonitorOptions;

typedef struct Monitor Monitor;
MUST_USE Result monitor_create(const MonitorOptions *options, Monitor **out);
// Waits for no more than the piece of work in hand: a millisecond of measuring, one refinement, or one Lod's creation.
void monitor_destroy(Monitor **monitor);

// With each frame, before it is submitted: hears of the frames drawn since, and fills `order->look.hud.accuracy`.
// `open`: the panel is shown; else nothing is worked on, and what was measured is forgotten.
void monitor_follow(Monitor *monitor, bool open, FrameOrder *order);
// Between `true` and `false` an open panel stays as it is, in frames that do not show it: the thread rests, nothing is
// forgotten, and neither the frames drawn meanwhile nor that time count. No monitor_follow meanwhile.
void monitor_rest(Monitor *monitor, bool resting);
// What the panel showed last; `show` is false when it never was open. Until the next monitor_follow.
const RenderAccuracy *monitor_shown(const Monitor *monitor);
// What the thread has used of a processor so far.
double monitor_spent_ms(Monitor *monitor);
