#include "app/flight/flight_settings.h"

#include "app/scene_load.h"
#include "base/rate.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <stdio.h>

#define TAU_STEP 1.2599210498948732 // three presses halve or double
#define TAU_MIN 0.1
#define TAU_MAX 64.0
#define TARGET_MIN_MS 1.0
#define TARGET_MAX_MS 1000.0
#define FOV_STEP 1.15
#define FOV_MIN 2.0 // degrees
#define FOV_MAX 150.0

FlightSettings flight_settings_create(const Options *options) {
    bool hud = options_flag(options, OPTION_HUD);
    bool compare = options_is_set(options, OPTION_COMPARE);
    return (FlightSettings){
        .method = (LodMethod)options_choice(options, OPTION_METHOD),
        .compare = compare,
        .right = compare ? (LodMethod)options_choice(options, OPTION_COMPARE) : LOD_HYBRID,
        .bound_corner = scene_bound_corner(options),
        .tau_px = options_number(options, OPTION_TAU),
        .target_ms = options_is_set(options, OPTION_TARGET_MS) ? options_number(options, OPTION_TARGET_MS) : 0.0,
        .fov_rad = options_number(options, OPTION_FOV) * GEODESY_RAD_PER_DEG,
        .view = (CameraView)options_choice(options, OPTION_VIEW),
        .colouring = (RenderColouring)options_choice(options, OPTION_COLOUR),
        .wireframe = options_flag(options, OPTION_WIREFRAME),
        .magenta = options_flag(options, OPTION_MAGENTA),
        .show_flight = hud,
        .show_numbers = hud,
        .show_accuracy = options_flag(options, OPTION_ACCURACY),
        .clock = flight_clock_create(options_choice(options, OPTION_TIME_RATE))};
}

const char *flight_colouring_name(RenderColouring colouring) {
    static const char *const names[RENDER_COLOURING_COUNT] = {"land", "level", "cache", "partition"};
    return names[colouring];
}

// All, then without the numbers, then nothing.
static void cycle_hud(FlightSettings *settings) {
    bool all = settings->show_flight && settings->show_numbers;
    bool nothing = !settings->show_flight;
    settings->show_numbers = nothing;
    settings->show_flight = all || nothing;
}

static double scaled(double value, double factor, double least, double greatest) {
    return fmin(fmax(value * factor, least), greatest);
}

static void zoom(FlightSettings *settings, double factor) {
    settings->fov_rad = scaled(settings->fov_rad, factor, FOV_MIN * GEODESY_RAD_PER_DEG, FOV_MAX * GEODESY_RAD_PER_DEG);
}

static bool apply_view(FlightSettings *settings, Action action, char *message, size_t size) {
    switch (action) {
    case ACTION_VIEW_NEXT:
    case ACTION_VIEW_PREVIOUS:
        settings->view = (CameraView)((settings->view + (action == ACTION_VIEW_NEXT ? 1 : CAMERA_VIEW_COUNT - 1)) %
                                      CAMERA_VIEW_COUNT);
        snprintf(message, size, "view: %s", camera_view_name(settings->view));
        return true;
    case ACTION_ZOOM_IN:
    case ACTION_ZOOM_OUT:
        zoom(settings, action == ACTION_ZOOM_IN ? 1.0 / FOV_STEP : FOV_STEP);
        snprintf(message, size, "field of view %.0f degrees", settings->fov_rad / GEODESY_RAD_PER_DEG);
        return true;
    case ACTION_HUD:
        cycle_hud(settings);
        return true;
    case ACTION_HELP:
        settings->show_help = !settings->show_help;
        return true;
    case ACTION_ACCURACY:
        settings->show_accuracy = !settings->show_accuracy;
        return true;
    default:
        return false;
    }
}

static bool apply_time(FlightSettings *settings, Action action, char *message, size_t size) {
    char rate[RATE_BYTES];
    switch (action) {
    case ACTION_PAUSE:
        settings->clock.paused = !settings->clock.paused;
        return true;
    case ACTION_TIME_FASTER:
    case ACTION_TIME_SLOWER:
        flight_clock_change_rate(&settings->clock, action == ACTION_TIME_FASTER ? 1 : -1);
        rate_write(flight_clock_rate(&settings->clock), rate);
        snprintf(message, size, "time %s", rate);
        return true;
    default:
        return false;
    }
}

static LodMethod method_after(LodMethod method) {
    return (LodMethod)((method + 1) % LOD_METHOD_COUNT);
}

// What is wanted; the display says what is shown.
static void say_methods(const FlightSettings *settings, char *message, size_t size) {
    if (settings->compare)
        snprintf(message, size, "left: %s, right: %s", lod_method_name(settings->method),
                 lod_method_name(settings->right));
    else
        snprintf(message, size, "method: %s (%s)", lod_method_name(settings->method),
                 lod_method_source(settings->method));
}

static bool apply_method(FlightSettings *settings, Action action, char *message, size_t size) {
    switch (action) {
    case ACTION_METHOD:
        settings->method = method_after(settings->method);
        break;
    case ACTION_METHOD_RIGHT:
        if (!settings->compare) {
            snprintf(message, size, "press c to see two methods");
            return true;
        }
        settings->right = method_after(settings->right);
        break;
    case ACTION_COMPARE:
        settings->compare = !settings->compare;
        settings->right = method_after(settings->method);
        break;
    default:
        return false;
    }
    say_methods(settings, message, size);
    return true;
}

// Finer costs more: a governed flight gets more time for it.
static void change_detail(FlightSettings *settings, bool finer, char *message, size_t size) {
    if (settings->target_ms > 0.0) {
        settings->target_ms =
            scaled(settings->target_ms, finer ? TAU_STEP : 1.0 / TAU_STEP, TARGET_MIN_MS, TARGET_MAX_MS);
        snprintf(message, size, "target %.1f ms a frame", settings->target_ms);
    } else {
        settings->tau_px = scaled(settings->tau_px, finer ? 1.0 / TAU_STEP : TAU_STEP, TAU_MIN, TAU_MAX);
        snprintf(message, size, "tolerated error %.2f px", settings->tau_px);
    }
}

static bool apply_detail(FlightSettings *settings, Action action, char *message, size_t size) {
    switch (action) {
    case ACTION_FINER:
    case ACTION_COARSER:
        change_detail(settings, action == ACTION_FINER, message, size);
        return true;
    case ACTION_WIREFRAME:
        settings->wireframe = !settings->wireframe;
        return true;
    case ACTION_COLOURING:
        settings->colouring = (RenderColouring)((settings->colouring + 1) % RENDER_COLOURING_COUNT);
        snprintf(message, size, "colours: %s", flight_colouring_name(settings->colouring));
        return true;
    default:
        return false;
    }
}

bool flight_settings_apply(FlightSettings *settings, Action action, char *message, size_t size) {
    message[0] = '\0';
    return apply_view(settings, action, message, size) || apply_time(settings, action, message, size) ||
           apply_detail(settings, action, message, size) || apply_method(settings, action, message, size);
}
