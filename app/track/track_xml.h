// app/track/track_xml.h: an XML file as a sequence of elements, in memory that does not grow with it.
// Lines are counted from 1; texts are UTF-8.
// Everything handed to the caller lives until the call returns. One thread.
#pragma once
#include "base/base.h"

#define TRACK_XML_TEXT_BYTES 1024 // of an element; longer ones are cut
#define TRACK_XML_NAME_BYTES 32
#define TRACK_XML_DEPTH_MAX 64

// Where an element is. Names are without their namespace's prefix.
typedef struct TrackXmlPlace {
    int64_t line;
    int depth;          // the root's is 1
    const char *parent; // "": of the root
} TrackXmlPlace;

typedef struct TrackXmlHandler {
    // `attributes`: name, value, name, value, NULL. What is not RESULT_OK ends the reading and is handed on.
    Result (*begin)(void *user, const TrackXmlPlace *place, const char *name, const char *const *attributes);
    // `text`: what stands in the element itself, without white space around it; "" if it has elements.
    Result (*end)(void *user, const TrackXmlPlace *place, const char *name, const char *text);
    // The file is cut off, or damaged so that nothing more can be read of it: closes what is open. `points`: how many
    // there are to be kept.
    Result (*cut)(void *user, int *points);
} TrackXmlHandler;

// A file that is cut off, or damaged in its second half, is read as far as it goes, with a warning of file and line,
// unless there are no points to be kept. Entities, documents nested deeper than TRACK_XML_DEPTH_MAX, and single tags
// above a megabyte are refused. NOT_FOUND, IO, MEMORY; FORMAT names file and line.
MUST_USE Result track_xml_read(const char *path, const TrackXmlHandler *handler, void *user);
