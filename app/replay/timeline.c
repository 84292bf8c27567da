#include "app/replay/timeline.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SHOWN_MOST_S 3.6e8 // what fits the text
#define AT_END_S 1e-9      // so near is there

Timeline timeline_create(double duration_s) {
    return (Timeline){.duration_s = fmax(duration_s, 0.0)};
}

double timeline_rate(const Timeline *timeline) {
    double rate = ldexp(1.0, timeline->rate);
    return timeline->backwards ? -rate : rate;
}

double timeline_left_s(const Timeline *timeline) {
    double way_s = timeline->backwards ? timeline->t_s : timeline->duration_s - timeline->t_s;
    return way_s / fabs(timeline_rate(timeline));
}

bool timeline_is_at_end(const Timeline *timeline) {
    return timeline->backwards ? timeline->t_s <= 0.0 : timeline->t_s >= timeline->duration_s;
}

void timeline_jump(Timeline *timeline, double t_s) {
    if (!isnan(t_s))
        timeline->t_s = fmin(fmax(t_s, 0.0), timeline->duration_s);
    timeline->carry_s = 0.0;
}

// Kahan's sum: W. Kahan, "Further remarks on reducing truncation errors", CACM 8 (1965) 40.
static void move(Timeline *timeline, double by_s) {
    double wanted_s = by_s - timeline->carry_s, t_s = timeline->t_s + wanted_s;
    timeline->carry_s = (t_s - timeline->t_s) - wanted_s;
    timeline->t_s = t_s;
}

void timeline_advance(Timeline *timeline, double passed_s) {
    if (timeline->paused || !(passed_s > 0.0))
        return;
    double left_s = timeline_left_s(timeline);
    if (passed_s >= left_s - AT_END_S)
        timeline_jump(timeline, timeline->backwards ? 0.0 : timeline->duration_s);
    else
        move(timeline, passed_s * timeline_rate(timeline));
    timeline->paused = timeline_is_at_end(timeline);
}

void timeline_change_rate(Timeline *timeline, int by) {
    int rate = timeline->rate + by;
    rate = rate < TIMELINE_RATE_LEAST ? TIMELINE_RATE_LEAST : rate;
    timeline->rate = rate > TIMELINE_RATE_MOST ? TIMELINE_RATE_MOST : rate;
}

void timeline_play_or_pause(Timeline *timeline) {
    timeline->paused = !timeline->paused;
    if (!timeline->paused && timeline_is_at_end(timeline))
        timeline->t_s = timeline->backwards ? timeline->duration_s : 0.0;
}

void timeline_turn(Timeline *timeline) {
    timeline->backwards = !timeline->backwards;
    timeline->paused = timeline_is_at_end(timeline);
}

void timeline_write(double t_s, char out[TIMELINE_TEXT_BYTES]) {
    // Cut off, not rounded: a time is shown when it is reached.
    long long tenths = (long long)floor(fmin(fmax(t_s, 0.0), SHOWN_MOST_S) * 10.0 + 1e-6), seconds = tenths / 10;
    snprintf(out, TIMELINE_TEXT_BYTES, "%lld:%02lld:%02lld.%lld", seconds / 3600, seconds / 60 % 60, seconds % 60,
             tenths % 10);
}

// Digits, with decimals or without: no sign, no exponent, no name of a number.
static bool read_part(const char **at, double *value) {
    size_t length = strspn(*at, "0123456789.");
    char text[32], *end;
    if (length == 0 || length >= sizeof text || !isdigit((unsigned char)(*at)[0]))
        return false;
    memcpy(text, *at, length);
    text[length] = '\0';
    *value = strtod(text, &end);
    *at += length;
    return *end == '\0';
}

bool timeline_read(const char *text, double *t_s) {
    double sum = 0.0, part;
    int parts = 0;
    for (;; text++, parts++) {
        const char *begin = text;
        if (parts == 3 || !read_part(&text, &part) || (parts > 0 && part >= 60.0))
            return false;
        sum = sum * 60.0 + part;
        if (*text == '\0')
            break;
        if (*text != ':' || memchr(begin, '.', (size_t)(text - begin))) // only seconds have decimals
            return false;
    }
    *t_s = sum;
    return true;
}
