#include "app/track/track_time.h"

#include <math.h>
#include <stdio.h>

#define YEAR_DAYS 365
#define CYCLE_DAYS 146097    // of 400 years
#define YEARS_OF_DAYS 719468 // from 1 March of year 0 to 1 January 1970

static bool is_leap(int year) {
    return year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
}

static int month_days(int year, int month) {
    static const int days[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    return days[month - 1] + (month == 2 && is_leap(year));
}

// Years that begin in March have the leap day at their end; (153 m + 2) / 5 days lie before their month m.
bool track_time_of_day(int year, int month, int day, double *unix_s) {
    if (year < 1 || year > 9999 || month < 1 || month > 12 || day < 1 || day > month_days(year, month))
        return false;
    int y = month > 2 ? year : year - 1, m = (month + 9) % 12;
    int64_t days = (int64_t)YEAR_DAYS * y + y / 4 - y / 100 + y / 400 + (153 * m + 2) / 5 + day - 1 - YEARS_OF_DAYS;
    *unix_s = (double)days * TRACK_DAY_S;
    return true;
}

// `count` digits, and the byte `after` them unless it is 0.
static bool take_digits(const char **text, int count, char after, int *out) {
    *out = 0;
    for (int i = 0; i < count; i++, (*text)++) {
        if (**text < '0' || **text > '9')
            return false;
        *out = 10 * *out + (**text - '0');
    }
    if (after && **text != after)
        return false;
    *text += after != 0;
    return true;
}

static double take_fraction(const char **text) {
    double value = 0.0, unit = 0.1;
    if (**text != '.' && **text != ',')
        return 0.0;
    for ((*text)++; **text >= '0' && **text <= '9'; (*text)++, unit *= 0.1)
        value += unit * (**text - '0');
    return value;
}

// Seconds that local time is ahead.
static bool take_zone(const char **text, double *ahead_s) {
    int sign = **text == '+' ? 1 : **text == '-' ? -1 : 0, hours, minutes = 0;
    *ahead_s = 0.0;
    if (**text == 'Z' || **text == 'z')
        (*text)++;
    if (sign == 0)
        return true;
    (*text)++;
    if (!take_digits(text, 2, 0, &hours))
        return false;
    *text += **text == ':';
    if (**text && !take_digits(text, 2, 0, &minutes))
        return false;
    *ahead_s = sign * (hours * 3600.0 + minutes * 60.0);
    return hours < 24 && minutes < 60;
}

bool track_time_read(const char *text, double *unix_s) {
    int year, month, day, hour, minute, second;
    double days_s, ahead_s;
    if (!take_digits(&text, 4, '-', &year) || !take_digits(&text, 2, '-', &month) || !take_digits(&text, 2, 0, &day))
        return false;
    if (*text != 'T' && *text != 't' && *text != ' ')
        return false;
    text++;
    if (!take_digits(&text, 2, ':', &hour) || !take_digits(&text, 2, ':', &minute) ||
        !take_digits(&text, 2, 0, &second))
        return false;
    double fraction = take_fraction(&text);
    if (!take_zone(&text, &ahead_s) || *text || hour > 24 || minute > 59 || second > 60)
        return false;
    if (!track_time_of_day(year, month, day, &days_s))
        return false;
    *unix_s = days_s + hour * 3600.0 + minute * 60.0 + second + fraction - ahead_s;
    return true;
}

TrackDate track_time_date(double unix_s) {
    double whole_ms = fmin(fmax(round(unix_s * 1000.0), -62135596800e3), 253402300799999.0); // years 1 to 9999
    int64_t ms = (int64_t)whole_ms, day_ms = (int64_t)TRACK_DAY_S * 1000;
    int64_t days = ms / day_ms - (ms % day_ms < 0), rest = ms - days * day_ms;
    int64_t since = days + YEARS_OF_DAYS, cycle = since / CYCLE_DAYS, in_cycle = since % CYCLE_DAYS;
    int64_t year = (in_cycle - in_cycle / 1460 + in_cycle / 36524 - in_cycle / 146096) / YEAR_DAYS;
    int64_t in_year = in_cycle - (YEAR_DAYS * year + year / 4 - year / 100), month = (5 * in_year + 2) / 153;
    return (TrackDate){.year = (int)(cycle * 400 + year + (month >= 10)),
                       .month = (int)(month < 10 ? month + 3 : month - 9),
                       .day = (int)(in_year - (153 * month + 2) / 5 + 1),
                       .hour = (int)(rest / 3600000),
                       .minute = (int)(rest / 60000 % 60),
                       .second = (double)(rest % 60000) / 1000.0};
}

void track_time_write(double unix_s, char out[TRACK_TIME_BYTES]) {
    TrackDate date = track_time_date(unix_s);
    bool whole = date.second == floor(date.second);
    snprintf(out, TRACK_TIME_BYTES, whole ? "%04d-%02d-%02dT%02d:%02d:%02.0fZ" : "%04d-%02d-%02dT%02d:%02d:%06.3fZ",
             date.year % 10000, date.month % 100, date.day % 100, date.hour % 100, date.minute % 100, date.second);
}
