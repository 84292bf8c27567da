#include "app/aircraft/aircraft.h"
#include "app/aircraft/aircraft_table.h"
#include "app/aircraft/airframe.h"
#include "app/aircraft/isa.h"
#include "base/log.h"
#include "config/ini_read.h"
#include "config/quantity.h"
#include "config/suggest.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RAD_PER_DEG (3.14159265358979323846 / 180.0)
#define AIR_RATE_MOST 200.0 // 1/s: what the air may do to the motion at the never-exceed speed; steps are 1/120 s
#define LEG_RATE_MOST 400.0 // 1/s: of a leg's spring or damper on the mass that it moves
#define PLACE_MOST 200.0    // m: of parts of an aircraft from its centre of gravity

typedef enum Form { FORM_NUMBER, FORM_PLACE, FORM_TEXT, FORM_ENGINE } Form;

// Which engines a key is for: bits 1 << AircraftEngine.
#define OF_ALL 7
#define OF_PISTON (1 << AIRCRAFT_PISTON)
#define OF_JET (1 << AIRCRAFT_JET)

typedef struct Key {
    const char *section, *name;
    Form form;
    size_t offset; // in Aircraft or, of legs, in AircraftLeg
    QuantityKind kind;
    double least, greatest, otherwise; // otherwise NAN: required, but in [published]
    int engines;
} Key;

#define ROW(type, section, name, field, kind, least, greatest, otherwise, engines)                                     \
    {section, name, FORM_NUMBER, offsetof(type, field), QUANTITY_##kind, least, greatest, otherwise, engines},
#define ROW_ALL(s, n, f, k, l, g, o) ROW(Aircraft, s, n, f, k, l, g, o, OF_ALL)
#define ROW_PISTON(s, n, f, k, l, g, o) ROW(Aircraft, s, n, f, k, l, g, o, OF_PISTON)
#define ROW_JET(s, n, f, k, l, g, o) ROW(Aircraft, s, n, f, k, l, g, o, OF_JET)
#define ROW_PUBLISHED(s, n, f, k, l, g, o) ROW(Aircraft, s, n, published.f, k, l, g, o, OF_ALL)
#define ROW_LEG(s, n, f, k, l, g, o) ROW(AircraftLeg, s, n, f, k, l, g, o, OF_ALL)
#define OTHER(section, name, form, type, field)                                                                        \
    { section, name, form, offsetof(type, field), QUANTITY_LENGTH, -PLACE_MOST, PLACE_MOST, NAN, OF_ALL }

static const Key keys[] = {
    AIRCRAFT_TABLE(ROW_ALL) PISTON_TABLE(ROW_PISTON) JET_TABLE(ROW_JET) PUBLISHED_TABLE(ROW_PUBLISHED) // numbers
    OTHER("aircraft", "name", FORM_TEXT, Aircraft, name),
    OTHER("aircraft", "source", FORM_TEXT, Aircraft, source),
    OTHER("published", "source", FORM_TEXT, Aircraft, published.source),
    OTHER("engine", "kind", FORM_ENGINE, Aircraft, engine),
    OTHER("hull", "nose", FORM_PLACE, Aircraft, nose),
    OTHER("hull", "tail", FORM_PLACE, Aircraft, tail),
    OTHER("hull", "tip", FORM_PLACE, Aircraft, tip),
    OTHER("hull", "belly", FORM_PLACE, Aircraft, belly),
};
static const Key leg_keys[] = {
    LEG_TABLE(ROW_LEG) // numbers
    OTHER("leg", "position", FORM_PLACE, AircraftLeg, x),
};
#define KEY_COUNT ((int)COUNT_OF(keys))
#define LEG_KEY_COUNT ((int)COUNT_OF(leg_keys))

// A file while it is read; the lines on which keys stood, 0: not yet.
typedef struct Reading {
    Aircraft aircraft;
    int lines[COUNT_OF(keys)];
    int leg_lines[AIRCRAFT_LEGS_MAX][COUNT_OF(leg_keys)];
} Reading;

static bool is_optional(const Key *key) {
    return !isnan(key->otherwise) || strcmp(key->section, "published") == 0;
}

static void set_defaults(const Key *rows, int count, char *base) {
    for (int i = 0; i < count; i++)
        if (rows[i].form == FORM_NUMBER) {
            double scale = rows[i].kind == QUANTITY_ANGLE ? RAD_PER_DEG : 1.0, value = scale * rows[i].otherwise;
            memcpy(base + rows[i].offset, &value, sizeof value);
        }
}

// ---- one entry --------------------------------------------------------------------------------------------------

static bool refuse_value(const IniEntry *entry, const char *expected) {
    log_error("%s:%d: [%s] %s: expected %s; found '%s'", entry->file, entry->line, entry->section, entry->name,
              expected, entry->value);
    return false;
}

static bool keep_number(const Key *key, const IniEntry *entry, char *base) {
    double value, degrees = key->kind == QUANTITY_ANGLE ? RAD_PER_DEG : 1.0;
    const char *units = quantity_units(key->kind);
    if (quantity_parse(key->kind, entry->value, &value) == RESULT_OK && value >= key->least && value <= key->greatest) {
        value *= degrees;
        memcpy(base + key->offset, &value, sizeof value);
        return true;
    }
    char expected[160];
    snprintf(expected, sizeof expected, "a number from %g to %g%s%s%s", key->least, key->greatest, *units ? " (" : "",
             units, *units ? "; the range in the first unit)" : "");
    return refuse_value(entry, expected);
}

static bool keep_place(const Key *key, const IniEntry *entry, char *base) {
    static const QuantityKind kinds[3] = {QUANTITY_LENGTH, QUANTITY_LENGTH, QUANTITY_LENGTH};
    double place[3];
    bool good = quantity_parse_list(kinds, 3, entry->value, place) == RESULT_OK;
    for (int i = 0; i < 3 && good; i++)
        good = fabs(place[i]) <= key->greatest;
    if (!good)
        return refuse_value(entry, "AHEAD,RIGHT,DOWN, three lengths from the centre of gravity, at most 200 m");
    memcpy(base + key->offset, place, sizeof place);
    return true;
}

static bool keep_text(const Key *key, const IniEntry *entry, char *base) {
    size_t length = strlen(entry->value);
    if (length == 0 || length >= AIRCRAFT_TEXT_BYTES)
        return refuse_value(entry, "a text of 1 to 255 bytes");
    memcpy(base + key->offset, entry->value, length + 1);
    return true;
}

static bool keep_engine(const IniEntry *entry, Aircraft *aircraft) {
    for (int i = 0; i < AIRCRAFT_ENGINE_COUNT; i++)
        if (strcmp(entry->value, aircraft_engine_name((AircraftEngine)i)) == 0) {
            aircraft->engine = i;
            return true;
        }
    return refuse_value(entry, "none, piston or jet");
}

static bool keep(const Key *key, const IniEntry *entry, char *base, int *line) {
    if (*line > 0) {
        log_error("%s:%d: [%s] %s was given on line %d already; remove one of them", entry->file, entry->line,
                  entry->section, entry->name, *line);
        return false;
    }
    *line = entry->line;
    switch (key->form) {
    case FORM_NUMBER:
        return keep_number(key, entry, base);
    case FORM_PLACE:
        return keep_place(key, entry, base);
    case FORM_TEXT:
        return keep_text(key, entry, base);
    case FORM_ENGINE:
        return keep_engine(entry, (Aircraft *)(void *)base);
    }
    return false;
}

static bool refuse_key(const IniEntry *entry, const char *section) {
    const char *names[KEY_COUNT + LEG_KEY_COUNT];
    int count = 0;
    bool known = strcmp(section, "leg") == 0;
    for (int i = 0; i < KEY_COUNT; i++)
        known = known || strcmp(keys[i].section, section) == 0;
    for (int i = 0; i < KEY_COUNT + LEG_KEY_COUNT; i++) {
        const Key *key = i < KEY_COUNT ? &keys[i] : &leg_keys[i - KEY_COUNT];
        if (!known || strcmp(key->section, section) == 0)
            names[count++] = known ? key->name : key->section;
    }
    const char *typed = known ? entry->name : section, *nearest = suggest_nearest(typed, names, count);
    log_error("%s:%d: an aircraft has no '%s' in [%s]%s%s%s", entry->file, entry->line, entry->name, entry->section,
              nearest ? known ? "; did you mean '" : "; did you mean [" : "; docs/aircraft.md lists what it has",
              nearest ? nearest : "", nearest ? known ? "'?" : "]?" : "");
    return false;
}

static int leg_named(Aircraft *aircraft, const IniEntry *entry, const char *name) {
    for (int i = 0; i < aircraft->leg_count; i++)
        if (strcmp(aircraft->legs[i].name, name) == 0)
            return i;
    if (aircraft->leg_count == AIRCRAFT_LEGS_MAX || !*name || strlen(name) >= sizeof aircraft->legs[0].name) {
        log_error("%s:%d: [%s]: expected at most %d legs, with names of 1 to 31 bytes as in [leg nose]", entry->file,
                  entry->line, entry->section, AIRCRAFT_LEGS_MAX);
        return -1;
    }
    AircraftLeg *leg = &aircraft->legs[aircraft->leg_count];
    set_defaults(leg_keys, LEG_KEY_COUNT, (char *)leg);
    snprintf(leg->name, sizeof leg->name, "%s", name);
    return aircraft->leg_count++;
}

static bool visit_leg(Reading *reading, const IniEntry *entry, const char *name) {
    int leg = leg_named(&reading->aircraft, entry, name);
    for (int i = 0; i < LEG_KEY_COUNT && leg >= 0; i++)
        if (strcmp(leg_keys[i].name, entry->name) == 0)
            return keep(&leg_keys[i], entry, (char *)&reading->aircraft.legs[leg], &reading->leg_lines[leg][i]);
    return leg >= 0 && refuse_key(entry, "leg");
}

static bool visit_entry(void *user, const IniEntry *entry) {
    Reading *reading = user;
    if (strncmp(entry->section, "leg ", 4) == 0)
        return visit_leg(reading, entry, entry->section + 4);
    for (int i = 0; i < KEY_COUNT; i++)
        if (strcmp(keys[i].section, entry->section) == 0 && strcmp(keys[i].name, entry->name) == 0)
            return keep(&keys[i], entry, (char *)&reading->aircraft, &reading->lines[i]);
    return refuse_key(entry, entry->section);
}

// ---- the whole --------------------------------------------------------------------------------------------------

static Result check_keys(const char *path, const Reading *reading) {
    int engine = reading->aircraft.engine;
    for (int i = 0; i < KEY_COUNT; i++) {
        bool wanted = keys[i].engines & (1 << engine);
        if (wanted && reading->lines[i] == 0 && !is_optional(&keys[i])) {
            log_error("%s: '%s' is missing in [%s]", path, keys[i].name, keys[i].section);
            return RESULT_FORMAT;
        }
        if (!wanted && reading->lines[i] > 0) {
            log_error("%s:%d: an aircraft with the engine '%s' has no '%s'; remove it", path, reading->lines[i],
                      aircraft_engine_name((AircraftEngine)engine), keys[i].name);
            return RESULT_FORMAT;
        }
    }
    return RESULT_OK;
}

static Result check_legs(const char *path, const Reading *reading) {
    const Aircraft *a = &reading->aircraft;
    for (int leg = 0; leg < a->leg_count; leg++)
        for (int i = 0; i < LEG_KEY_COUNT; i++)
            if (reading->leg_lines[leg][i] == 0 && isnan(leg_keys[i].otherwise)) {
                log_error("%s: '%s' is missing in [leg %s]", path, leg_keys[i].name, a->legs[leg].name);
                return RESULT_FORMAT;
            }
    if (a->leg_count >= 3)
        return RESULT_OK;
    log_error("%s: %d legs; expected at least three sections [leg NAME] to stand on", path, a->leg_count);
    return RESULT_FORMAT;
}

// No body of positive mass has other moments: triangle inequality, and a positive determinant.
static Result check_inertia(const char *path, const Aircraft *a) {
    bool good = a->ixx + a->iyy >= a->izz && a->iyy + a->izz >= a->ixx && a->izz + a->ixx >= a->iyy &&
                a->ixx * a->izz > 1.01 * a->ixz * a->ixz;
    if (good)
        return RESULT_OK;
    log_error("%s: no body has these moments of inertia; expected each of ixx, iyy, izz at most the sum of the others, "
              "and ixz smaller than both",
              path);
    return RESULT_FORMAT;
}

// The simulation's steps must be able to follow.
static Result check_rates(const char *path, const Aircraft *a) {
    double air = airframe_stiffness(a, ISA_DENSITY_0, a->never_exceed_speed);
    if (air > AIR_RATE_MOST) {
        log_error(
            "%s: at the never-exceed speed the air would turn or brake the aircraft at a rate of %.0f 1/s; expected "
            "%.0f at most: mass or moments of inertia are too small for the wing, or a derivative too large",
            path, air, AIR_RATE_MOST);
        return RESULT_FORMAT;
    }
    for (int i = 0; i < a->leg_count; i++) {
        const AircraftLeg *leg = &a->legs[i];
        double moved = 1.0 / (1.0 / a->mass + leg->x * leg->x / a->iyy + leg->y * leg->y / a->ixx);
        double rate = fmax(sqrt(leg->stiffness / moved), leg->damping / moved);
        if (rate > LEG_RATE_MOST) {
            log_error(
                "%s: [leg %s] springs or damps at a rate of %.0f 1/s; expected %.0f at most: lower 'stiffness' or "
                "'damping'",
                path, leg->name, rate, LEG_RATE_MOST);
            return RESULT_FORMAT;
        }
    }
    return RESULT_OK;
}

static Result derive(const char *path, Aircraft *aircraft) {
    Result result = aircraft_derive(aircraft);
    if (result == RESULT_RANGE)
        log_error("%s: no stall angle up to 57 degrees gives the lift coefficients 'maximum', 'maximum-flaps' and "
                  "'minimum' in [lift] with this slope; bring them nearer to 'zero'",
                  path);
    return result == RESULT_OK ? RESULT_OK : RESULT_FORMAT;
}

static void name_after(const char *path, Aircraft *aircraft) {
    const char *slash = strrchr(path, '/'), *begin = slash ? slash + 1 : path, *dot = strrchr(begin, '.');
    int length = (int)(dot && dot > begin ? (size_t)(dot - begin) : strlen(begin));
    snprintf(aircraft->id, sizeof aircraft->id, "%.*s", length, begin);
}

Result aircraft_read(const char *path, Aircraft *out) {
    Reading reading = {.aircraft = {.mass = 0.0}};
    set_defaults(keys, KEY_COUNT, (char *)&reading.aircraft);
    Result result = ini_read(path, visit_entry, &reading);
    if (result == RESULT_NOT_FOUND || result == RESULT_IO)
        log_error("%s: the aircraft file %s", path, result == RESULT_IO ? "cannot be read" : "does not exist");
    if (result == RESULT_OK)
        result = check_keys(path, &reading);
    if (result == RESULT_OK)
        result = check_legs(path, &reading);
    if (result == RESULT_OK)
        result = check_inertia(path, &reading.aircraft);
    if (result == RESULT_OK)
        result = check_rates(path, &reading.aircraft);
    if (result == RESULT_OK)
        result = derive(path, &reading.aircraft);
    if (result != RESULT_OK)
        return result;
    name_after(path, &reading.aircraft);
    *out = reading.aircraft;
    return RESULT_OK;
}

// ---- by name ----------------------------------------------------------------------------------------------------

static const NamedFileKind KIND = {"aircraft", AIRCRAFT_ENDING, "an aircraft"};

Result aircraft_list(NamedFiles *out) {
    return named_files_of_program(&KIND, out);
}

Result aircraft_find(const char *where, const char *name_or_path, char path[PATHS_BYTES_MAX]) {
    return named_files_find(&KIND, where, name_or_path, path);
}

Result aircraft_load(const char *name_or_path, Aircraft *out) {
    char path[PATHS_BYTES_MAX];
    Result result = aircraft_find("aircraft", name_or_path, path);
    return result == RESULT_OK ? aircraft_read(path, out) : result;
}
