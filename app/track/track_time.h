// app/track/track_time.h: UTC as files write it.
// Seconds since 1970-01-01T00:00:00Z, without leap seconds (Unix time), of the years 1 to 9999.
// Pure functions; any thread.
#pragma once
#include "base/base.h"

#define TRACK_TIME_BYTES 32
#define TRACK_DAY_S 86400.0

// False: there is no such day. Gregorian.
bool track_time_of_day(int year, int month, int day, double *unix_s);
// "2024-05-01T12:34:56.789Z", as ISO 8601 and XML Schema's dateTime have it: a fraction is optional, 'Z' may be an
// offset (+02:00), and without either UTC is meant. False: it is none.
bool track_time_read(const char *text, double *unix_s);
// To the millisecond, which is left out where it is zero.
void track_time_write(double unix_s, char out[TRACK_TIME_BYTES]);

typedef struct TrackDate {
    int year, month, day, hour, minute;
    double second; // 0 .. 60, a whole millisecond
} TrackDate;
TrackDate track_time_date(double unix_s);
