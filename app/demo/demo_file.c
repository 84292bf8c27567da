#define _POSIX_C_SOURCE 200809L
#include "app/demo/demo.h"

#include "base/log.h"
#include "config/files.h"
#include "config/quantity.h"
#include "terrain/geodesy.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE_BYTES 512
#define SPEED_MIN 15.0
#define SPEED_MAX 1000.0
#define BLANKS " \t\r\n"

typedef struct Reading {
    const char *path;
    const Geoid *geoid; // NULL: only the words are wanted
    Demo *demo;
} Reading;

static bool parse_place(const char *text, double place[3]) {
    static const QuantityKind kinds[3] = {QUANTITY_ANGLE, QUANTITY_ANGLE, QUANTITY_LENGTH};
    return text && quantity_parse_list(kinds, 3, text, place) == RESULT_OK && place[0] >= -90.0 && place[0] <= 90.0 &&
           place[1] >= -540.0 && place[1] <= 540.0 && place[2] >= -20000.0 && place[2] <= 1e6;
}

static bool parse_speed(const char *text, double *speed_m_s) {
    return text && quantity_parse(QUANTITY_SPEED, text, speed_m_s) == RESULT_OK && *speed_m_s >= SPEED_MIN &&
           *speed_m_s <= SPEED_MAX;
}

static bool parse_to(const Reading *reading, const char *words[3]) {
    Demo *demo = reading->demo;
    double place[3], speed_m_s;
    if (words[2] || demo->count == DEMO_WAYPOINTS_MAX || !parse_place(words[0], place) ||
        !parse_speed(words[1], &speed_m_s))
        return false;
    double undulation_m = reading->geoid ? geoid_undulation_m(reading->geoid, place[0], place[1]) : 0.0;
    demo->waypoints[demo->count++] =
        (Waypoint){place[0] * GEODESY_RAD_PER_DEG, place[1] * GEODESY_RAD_PER_DEG, place[2] + undulation_m, speed_m_s};
    return true;
}

static bool parse_from(const Reading *reading, const char *words[3]) {
    Demo *demo = reading->demo;
    double place[3], heading_deg;
    if (!parse_place(words[0], place) || !words[1] ||
        quantity_parse(QUANTITY_ANGLE, words[1], &heading_deg) != RESULT_OK ||
        !parse_speed(words[2], &demo->start_speed_m_s))
        return false;
    demo->has_start = true;
    demo->start = (Viewpoint){place[0], place[1], place[2], heading_deg, 0.0};
    return true;
}

static bool parse_clearance(const Reading *reading, const char *words[3]) {
    double *clearance_m = &reading->demo->clearance_m;
    return words[0] && !words[1] && quantity_parse(QUANTITY_LENGTH, words[0], clearance_m) == RESULT_OK &&
           *clearance_m >= 10.0 && *clearance_m <= 10000.0;
}

static bool copy_text(char out[DEMO_TEXT_BYTES], const char *text) {
    return *text && snprintf(out, DEMO_TEXT_BYTES, "%s", text) < DEMO_TEXT_BYTES;
}

// What stands after the first word is one text.
static bool parse_text(const Reading *reading, const char *word, const char *text, bool *is_one) {
    Demo *demo = reading->demo;
    *is_one = true;
    if (strcmp(word, "title") == 0)
        return copy_text(demo->title, text);
    if (strcmp(word, "aircraft") == 0)
        return copy_text(demo->aircraft, text);
    if (strcmp(word, "view") == 0)
        return copy_text(demo->view, text);
    *is_one = false;
    return false;
}

static Result read_stick(const Reading *reading, const char *name) {
    char path[PATHS_BYTES_MAX];
    if (!reading->geoid) // for the title alone
        return RESULT_OK;
    Result result = files_beside(reading->path, name, path);
    stick_stream_destroy(&reading->demo->stick);
    return result == RESULT_OK ? stick_stream_read(path, &reading->demo->stick) : result;
}

static bool parse_words(const Reading *reading, const char *word, char *text) {
    const char *words[3] = {NULL, NULL, NULL};
    char *rest = NULL;
    for (int i = 0; i < 3; i++)
        words[i] = strtok_r(i ? NULL : text, BLANKS, &rest);
    if (strtok_r(NULL, BLANKS, &rest))
        return false;
    if (strcmp(word, "to") == 0)
        return parse_to(reading, words);
    if (strcmp(word, "from") == 0)
        return parse_from(reading, words);
    return strcmp(word, "clearance") == 0 && parse_clearance(reading, words);
}

static Result refuse(const Reading *reading, int line) {
    log_error(
        "%s:%d: expected 'to LAT,LON,ALT SPEED' (at most %d times; %g to %g m/s), 'from LAT,LON,ALT HEADING SPEED', "
        "'clearance LENGTH' (10 to 10000 m), 'stick FILE', 'title TEXT', 'aircraft NAME', 'view VIEW', or a comment "
        "after '#'",
        reading->path, line, DEMO_WAYPOINTS_MAX, SPEED_MIN, SPEED_MAX);
    return RESULT_FORMAT;
}

static void trim_end(char *text) {
    for (size_t length = strlen(text); length > 0 && strchr(BLANKS, text[length - 1]); length--)
        text[length - 1] = '\0';
}

static Result parse_line(const Reading *reading, char *line, int number) {
    char *word = line + strspn(line, BLANKS);
    bool is_text;
    word[strcspn(word, "#")] = '\0';
    trim_end(word);
    if (*word == '\0')
        return RESULT_OK;
    char *text = word + strcspn(word, BLANKS);
    if (*text)
        *text++ = '\0';
    text += strspn(text, BLANKS);
    if (strcmp(word, "stick") == 0 && *text)
        return read_stick(reading, text);
    bool parsed = parse_text(reading, word, text, &is_text);
    return parsed || (!is_text && parse_words(reading, word, text)) ? RESULT_OK : refuse(reading, number);
}

static Result read_lines(FILE *stream, const Reading *reading) {
    char line[LINE_BYTES];
    for (int number = 1; fgets(line, sizeof line, stream); number++) {
        bool whole = strchr(line, '\n') || feof(stream);
        Result result = whole ? parse_line(reading, line, number) : refuse(reading, number);
        if (result != RESULT_OK)
            return result;
    }
    return ferror(stream) ? RESULT_IO : RESULT_OK;
}

static Result read_file(const Reading *reading) {
    FILE *stream = fopen(reading->path, "r");
    if (!stream) {
        log_error("%s: the demo flight cannot be opened: %s", reading->path, strerror(errno));
        return RESULT_NOT_FOUND;
    }
    Result result = read_lines(stream, reading);
    fclose(stream);
    if (result == RESULT_IO)
        log_error("%s: the demo flight cannot be read", reading->path);
    return result;
}

Result demo_read(const char *path, const Geoid *geoid, Demo *out) {
    Demo demo = {.clearance_m = DEMO_CLEARANCE_M};
    const Reading reading = {path, geoid, &demo};
    Result result = read_file(&reading);
    if (result == RESULT_OK && demo.count == 0 && !demo.stick) {
        log_error("%s: the demo flight goes nowhere; expected lines 'to LAT,LON,ALT SPEED', or 'stick FILE'", path);
        result = RESULT_FORMAT;
    }
    if (result == RESULT_OK && demo.count > 0 && demo.stick) {
        log_error("%s: expected either lines 'to LAT,LON,ALT SPEED' or 'stick FILE'; found both", path);
        result = RESULT_FORMAT;
    }
    if (result == RESULT_OK)
        *out = demo;
    else
        demo_clear(&demo);
    return result;
}

Result demo_read_title(const char *path, char out[DEMO_TEXT_BYTES]) {
    Demo *demo = calloc(1, sizeof *demo);
    const Reading reading = {path, NULL, demo};
    if (!demo)
        return RESULT_MEMORY;
    Result result = read_file(&reading);
    memcpy(out, demo->title, DEMO_TEXT_BYTES);
    demo_clear(demo);
    free(demo);
    return result;
}
