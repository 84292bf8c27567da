#define _POSIX_C_SOURCE 200809L
#include "app/demo/demo.h"

#include "base/log.h"
#include "config/files.h"
#include "config/options.h"
#include "config/quantity.h"
#include "config/suggest.h"
#include "terrain/geodesy.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE_BYTES 512
#define FOUND_BYTES 80 // of a line, in messages
#define SPEED_MIN 15.0
#define SPEED_MAX 1000.0
#define HEADING_MAX 360.0
#define BLANKS " \t\r\n"

typedef enum Word { TO, FROM, CLEARANCE, STICK, TITLE, AIRCRAFT, VIEW, WORD_COUNT } Word;

typedef struct Reading {
    const char *path;
    const Geoid *geoid; // NULL: only the words are wanted
    Demo *demo;
    int line;
    int first[WORD_COUNT]; // the line where each word stood first; 0: nowhere yet
} Reading;

// ---- numbers ----

static bool parse_place(const char *text, double place[3]) {
    static const QuantityKind kinds[3] = {QUANTITY_ANGLE, QUANTITY_ANGLE, QUANTITY_LENGTH};
    return text && quantity_parse_list(kinds, 3, text, place) == RESULT_OK && place[0] >= -90.0 && place[0] <= 90.0 &&
           place[1] >= -540.0 && place[1] <= 540.0 && place[2] >= -20000.0 && place[2] <= 1e6;
}

static bool parse_within(QuantityKind kind, const char *text, double least, double greatest, double *out) {
    return text && quantity_parse(kind, text, out) == RESULT_OK && *out >= least && *out <= greatest;
}

static bool parse_speed(const char *text, double *speed_m_s) {
    return parse_within(QUANTITY_SPEED, text, SPEED_MIN, SPEED_MAX, speed_m_s);
}

// Exactly `count` words, at most three.
static bool split(char *text, int count, const char *words[3]) {
    char *rest = NULL;
    for (int i = 0; i < count; i++)
        if (!(words[i] = strtok_r(i ? NULL : text, BLANKS, &rest)))
            return false;
    return !strtok_r(NULL, BLANKS, &rest);
}

// ---- lines ----

// What parses a line gives USAGE, and says nothing, where it is not of its form.

static Result parse_to(Reading *reading, char *text) {
    Demo *demo = reading->demo;
    const char *words[3];
    double place[3], speed_m_s;
    if (!split(text, 2, words) || !parse_place(words[0], place) || !parse_speed(words[1], &speed_m_s))
        return RESULT_USAGE;
    if (demo->count == DEMO_WAYPOINTS_MAX) {
        log_error("%s:%d: expected at most %d lines 'to'", reading->path, reading->line, DEMO_WAYPOINTS_MAX);
        return RESULT_FORMAT;
    }
    double undulation_m = reading->geoid ? geoid_undulation_m(reading->geoid, place[0], place[1]) : 0.0;
    demo->waypoints[demo->count++] =
        (Waypoint){place[0] * GEODESY_RAD_PER_DEG, place[1] * GEODESY_RAD_PER_DEG, place[2] + undulation_m, speed_m_s};
    return RESULT_OK;
}

static Result parse_from(Reading *reading, char *text) {
    Demo *demo = reading->demo;
    const char *words[3];
    double place[3], heading_deg;
    if (!split(text, 3, words) || !parse_place(words[0], place) ||
        !parse_within(QUANTITY_ANGLE, words[1], -HEADING_MAX, HEADING_MAX, &heading_deg) ||
        !parse_speed(words[2], &demo->start_speed_m_s))
        return RESULT_USAGE;
    demo->has_start = true;
    demo->start = (Viewpoint){place[0], place[1], place[2], heading_deg, 0.0};
    return RESULT_OK;
}

static Result parse_clearance(Reading *reading, char *text) {
    const char *words[3];
    bool is_one =
        split(text, 1, words) && parse_within(QUANTITY_LENGTH, words[0], 10.0, 10000.0, &reading->demo->clearance_m);
    return is_one ? RESULT_OK : RESULT_USAGE;
}

static Result parse_stick(Reading *reading, char *text) {
    char path[PATHS_BYTES_MAX];
    if (!*text)
        return RESULT_USAGE;
    if (files_beside(reading->path, text, path) != RESULT_OK || !files_exists(path)) {
        log_error("%s:%d: stick: there is no file '%s' beside this one; expected one of a stick's reports",
                  reading->path, reading->line, text);
        return RESULT_NOT_FOUND;
    }
    if (!reading->geoid) // for the title alone
        return RESULT_OK;
    return stick_stream_read(path, &reading->demo->stick);
}

static Result copy_text(char out[DEMO_TEXT_BYTES], const char *text) {
    return *text && snprintf(out, DEMO_TEXT_BYTES, "%s", text) < DEMO_TEXT_BYTES ? RESULT_OK : RESULT_USAGE;
}

static Result parse_title(Reading *reading, char *text) {
    return copy_text(reading->demo->title, text);
}

static Result parse_aircraft(Reading *reading, char *text) {
    Demo *demo = reading->demo;
    snprintf(demo->aircraft_where, sizeof demo->aircraft_where, "%s:%d: aircraft", reading->path, reading->line);
    return copy_text(demo->aircraft, text);
}

static Result parse_view(Reading *reading, char *text) {
    double numbers[4];
    return option_parse(OPTION_VIEW, text, numbers) == RESULT_OK ? copy_text(reading->demo->view, text) : RESULT_USAGE;
}

static const struct {
    const char *word, *form; // as messages tell it
    Result (*parse)(Reading *reading, char *text);
} WORDS[WORD_COUNT] = {
    [TO] = {"to", "LAT,LON,ALT SPEED' (degrees, -20 to 1000 km; 15 to 1000 m/s)", parse_to},
    [FROM] = {"from", "LAT,LON,ALT HEADING SPEED' (degrees, -20 to 1000 km; -360 to 360 degrees; 15 to 1000 m/s)",
              parse_from},
    [CLEARANCE] = {"clearance", "LENGTH' (10 to 10000 m)", parse_clearance},
    [STICK] = {"stick", "FILE' (of a stick's reports, beside this one)", parse_stick},
    [TITLE] = {"title", "TEXT' (1 to 159 bytes)", parse_title},
    [AIRCRAFT] = {"aircraft", "NAME' (1 to 159 bytes)", parse_aircraft},
    [VIEW] = {"view", "VIEW' (one of " CHOICES_VIEW ")", parse_view},
};

static Result refuse_word(const Reading *reading, const char *found) {
    const char *names[WORD_COUNT];
    char all[128] = "", question[SUGGEST_BYTES];
    for (int i = 0; i < WORD_COUNT; i++) {
        size_t used = strlen(all);
        names[i] = WORDS[i].word;
        snprintf(all + used, sizeof all - used, "%s%s", i ? ", " : "", names[i]);
    }
    log_error("%s:%d: expected a line that begins with one of %s, or a comment after '#'; found '%.*s'%s",
              reading->path, reading->line, all, FOUND_BYTES, found,
              suggest_question(found, names, WORD_COUNT, question));
    return RESULT_FORMAT;
}

// What excludes each other, or may stand there once only.
static Result check_order(Reading *reading, Word word) {
    Word other = word == TO ? STICK : TO;
    bool both = (word == TO || word == STICK) && reading->first[other];
    if (both)
        log_error("%s:%d: '%s', and '%s' on line %d; expected either lines 'to LAT,LON,ALT SPEED' or 'stick FILE'",
                  reading->path, reading->line, WORDS[word].word, WORDS[other].word, reading->first[other]);
    else if (word != TO && reading->first[word])
        log_error("%s:%d: '%s' was given on line %d; remove one of them", reading->path, reading->line,
                  WORDS[word].word, reading->first[word]);
    else
        return RESULT_OK;
    return RESULT_FORMAT;
}

static Result parse_word(Reading *reading, Word word, char *text) {
    char found[FOUND_BYTES];
    snprintf(found, sizeof found, "%s", text); // it is cut in parts below
    Result result = check_order(reading, word);
    if (result == RESULT_OK)
        result = WORDS[word].parse(reading, text);
    if (reading->first[word] == 0)
        reading->first[word] = reading->line;
    if (result != RESULT_USAGE)
        return result;
    log_error("%s:%d: expected '%s %s; found '%s'", reading->path, reading->line, WORDS[word].word, WORDS[word].form,
              found);
    return RESULT_FORMAT;
}

static void trim_end(char *text) {
    for (size_t length = strlen(text); length > 0 && strchr(BLANKS, text[length - 1]); length--)
        text[length - 1] = '\0';
}

static Result parse_line(Reading *reading, char *line) {
    char *word = line + strspn(line, BLANKS);
    word[strcspn(word, "#")] = '\0';
    trim_end(word);
    if (*word == '\0')
        return RESULT_OK;
    char *text = word + strcspn(word, BLANKS);
    if (*text)
        *text++ = '\0';
    text += strspn(text, BLANKS);
    for (int i = 0; i < WORD_COUNT; i++)
        if (strcmp(word, WORDS[i].word) == 0)
            return parse_word(reading, (Word)i, text);
    return refuse_word(reading, word);
}

static Result read_lines(FILE *stream, Reading *reading) {
    char line[LINE_BYTES];
    for (reading->line = 1; fgets(line, sizeof line, stream); reading->line++) {
        if (!strchr(line, '\n') && !feof(stream)) {
            log_error("%s:%d: expected a line of at most %d bytes, without zero bytes", reading->path, reading->line,
                      LINE_BYTES - 2);
            return RESULT_FORMAT;
        }
        Result result = parse_line(reading, line);
        if (result != RESULT_OK)
            return result;
    }
    return ferror(stream) ? RESULT_IO : RESULT_OK;
}

static Result read_file(Reading *reading) {
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
    Reading reading = {.path = path, .geoid = geoid, .demo = &demo};
    Result result = read_file(&reading);
    if (result == RESULT_OK && demo.count == 0 && !demo.stick) {
        log_error("%s: the demo flight goes nowhere; expected lines 'to LAT,LON,ALT SPEED', or 'stick FILE'", path);
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
    Reading reading = {.path = path, .demo = demo};
    if (!demo) {
        log_error("%s: no memory for a demo flight", path);
        return RESULT_MEMORY;
    }
    Result result = read_file(&reading);
    memcpy(out, demo->title, DEMO_TEXT_BYTES);
    demo_clear(demo);
    free(demo);
    return result;
}
