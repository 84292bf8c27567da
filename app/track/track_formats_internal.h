// app/track/track_formats_internal.h: the readers and writers that the table of formats consists of.
// As in app/track/track_format.h.
// Included by the table and by the formats only.
#pragma once
#include "app/track/track_format.h"

bool track_csv_recognise(const char *head);
// A line of column names (t_s, lat_deg, lon_deg, alt_m, and heading_deg, pitch_deg or neither; bank_deg, gap, derived,
// unix_s where they are there; others are left alone, and so are lines that begin with '#'), then a line a point.
Result track_csv_read(const char *path, const TrackReading *how, Track *out);
void track_csv_write(const Track *track, const Geoid *geoid, FILE *to);
bool track_igc_recognise(const char *head);
Result track_igc_read(const char *path, const TrackReading *how, Track *out);
void track_igc_write(const Track *track, const Geoid *geoid, FILE *to);
bool track_gpx_recognise(const char *head);
Result track_gpx_read(const char *path, const TrackReading *how, Track *out);
void track_gpx_write(const Track *track, const Geoid *geoid, FILE *to);
bool track_kml_recognise(const char *head);
Result track_kml_read(const char *path, const TrackReading *how, Track *out);
void track_kml_write(const Track *track, const Geoid *geoid, FILE *to);
bool track_acmi_recognise(const char *head);
Result track_acmi_read(const char *path, const TrackReading *how, Track *out);
void track_acmi_write(const Track *track, const Geoid *geoid, FILE *to);

// How a file that has attitude says that ours is none that was measured; a reader marks it again.
#define TRACK_DERIVED_MARK "attitude derived from the path"

// The whole text as a number. False: it is none, or not finite.
bool track_read_number(const char *text, double *out);
double track_utc(const Track *track, int point); // Unix seconds; the start is known
double track_longitude(double lon_deg);          // -180..180
// For XML: markup escaped, and '?' for what XML cannot hold.
void track_write_xml_text(const char *text, FILE *to);
