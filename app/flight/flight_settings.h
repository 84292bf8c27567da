// app/flight/flight_settings.h: what a person may change in flight, and how keys change it.
// Pixels, radians.
// A value.
#pragma once
#include "app/flight/camera.h"
#include "app/flight/flight_clock.h"
#include "config/options.h"
#include "input/action.h"
#include "render/render.h"
#include "terrain/lod/lod.h"

typedef struct FlightSettings {
    LodMethod method; // that is wanted; one that cannot be made does not come
    bool compare;     // with `right` on the right half
    LodMethod right;
    bool bound_corner; // the tolerance holds at the picture's corners
    double tau_px, fov_rad;
    double target_ms; // that a frame may take: tau_px is the governor's; 0: tau_px is the person's
    CameraView view;
    RenderColouring colouring;
    bool wireframe, magenta;
    bool show_flight, show_numbers, show_help;
    bool show_accuracy; // the panel of accuracy against time
    FlightClock clock;
} FlightSettings;

FlightSettings flight_settings_create(const Options *options);
const char *flight_colouring_name(RenderColouring colouring); // "land"

// Carries out what changes settings and says it in `message` (at most `size` bytes, "" when there is nothing to say);
// false for actions of another kind.
bool flight_settings_apply(FlightSettings *settings, Action action, char *message, size_t size);
