// app/track/track_format.h: the formats of tracks: which one a file is of, reading any of them, writing any of them.
// As in app/track/track.h; each format's own units and datums are docs/tracks.md's matter.
// The table is static; a TrackReading borrows what it names.
#pragma once
#include "app/track/track.h"
#include "terrain/geo.h"

// What the altitudes of an IGC file are taken from.
typedef enum TrackIgcAlt {
    TRACK_IGC_PRESSURE,  // the pressure column, as it is
    TRACK_IGC_ELLIPSOID, // the GNSS column, as above the ellipsoid
    TRACK_IGC_GEOID,     // the GNSS column, as above the geoid
    TRACK_IGC_UNTOLD     // as HFALG says, else as TRACK_IGC_ELLIPSOID: the specification's own
} TrackIgcAlt;

typedef struct TrackReading {
    TrackIgcAlt igc_alt;
    const Geoid *geoid; // NULL: altitudes above the ellipsoid are refused
    const char *object; // which of several tracks: its name, or its number from 1 (ACMI: its id); NULL: the first
} TrackReading;
TrackReading track_reading_default(void); // without a geoid

typedef struct TrackFormat {
    const char *name;   // "igc"
    const char *ending; // ".igc"
    const char *what;   // "IGC flight log"
    bool wants_geoid;   // to read or write altitudes above the ellipsoid
    bool wants_start;   // cannot be written without a date
    bool has_attitude;
    bool has_objects;                    // may hold several flights, of which one is asked for
    bool has_pressure;                   // a place of its own for pressure altitudes
    bool (*recognise)(const char *head); // the first bytes of a file, as text
    // Logs what is wrong with file and line. NOT_FOUND, IO, FORMAT, UNSUPPORTED, MEMORY.
    Result (*read)(const char *path, const TrackReading *how, Track *out);
    // NULL: cannot be written. `geoid` is NULL or what wants_geoid asks for; errors stay in the stream.
    void (*write)(const Track *track, const Geoid *geoid, FILE *to);
} TrackFormat;

// Ends with a row without a name. A format is known by its row here and nowhere else.
extern const TrackFormat track_formats[];

// Whether the name ends as that of a flight does; the file isn't looked at.
bool track_is_named(const char *path);
// By the file's contents, else by its ending. NOT_FOUND, IO; FORMAT lists the formats there are.
MUST_USE Result track_format_of_file(const char *path, const TrackFormat **out);
// By the ending alone, of a file to be written. USAGE lists the endings there are.
MUST_USE Result track_format_of_ending(const char *path, const TrackFormat **out);
// A file of any of the formats.
MUST_USE Result track_load(const char *path, const TrackReading *how, Track *out);
// The file appears whole or not at all. Warns where pressure altitudes become others. USAGE: the format needs a date,
// and the track has none; IO, MEMORY.
MUST_USE Result track_save(const char *path, const TrackFormat *format, const Track *track, const Geoid *geoid);
