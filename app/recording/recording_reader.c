#define _POSIX_C_SOURCE 200809L
#include "app/recording/recording_reader.h"

#include "app/recording/recording_scan.h"
#include "base/log.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define CHUNKS_MAX (1 << 20)
#define DAMAGES_LOGGED 8

typedef struct IndexEntry {
    uint64_t offset; // of the header
    RecordingChunkHeader header;
} IndexEntry;

struct RecordingReader {
    char *path;
    RecordingScan scan;
    RecordingHeader header;
    RecordingCodec *codec;
    IndexEntry *chunks;
    int chunk_count, chunk_room;
    RecordingSegment *segments;
    int segment_count;
    RecordingDamage damages[RECORDING_DAMAGES_MAX];
    int damage_count;
    uint32_t end;
    bool closed;
    RecordingChunk chunk; // decoded last
    int chunk_index;      // -1: none
};

const char *recording_damage_text(RecordingDamageKind kind) {
    switch (kind) {
    case RECORDING_DAMAGED:
        return "damaged";
    case RECORDING_MISSING:
        return "missing, as they were never written";
    case RECORDING_STATELESS:
        return "without a state to begin from";
    case RECORDING_CUT_OFF:
        return "cut off";
    }
    return "";
}

// ---- what is wrong ----

static void tell_damage(const RecordingReader *reader, const RecordingDamage *damage) {
    char from[RECORDING_TIME_BYTES], to[RECORDING_TIME_BYTES];
    int rate = reader->header.steps_per_s;
    if (damage->steps > 0)
        log_warn("%s: byte %" PRIu64 ": steps %" PRIu32 " to %" PRIu32 " (%s to %s) are %s; the replay has a gap there",
                 reader->path, damage->offset, damage->first_step, damage->first_step + damage->steps - 1,
                 recording_time_text(damage->first_step, rate, from),
                 recording_time_text(damage->first_step + damage->steps, rate, to),
                 recording_damage_text(damage->kind));
    else
        log_warn("%s: byte %" PRIu64 ": %" PRIu64 " bytes are %s; they are left out", reader->path, damage->offset,
                 damage->bytes, recording_damage_text(damage->kind));
}

static void add_damage(RecordingReader *reader, RecordingDamage damage) {
    if (reader->damage_count < DAMAGES_LOGGED)
        tell_damage(reader, &damage);
    if (reader->damage_count < RECORDING_DAMAGES_MAX)
        reader->damages[reader->damage_count] = damage;
    reader->damage_count += reader->damage_count < INT32_MAX;
}

// ---- the index ----

typedef struct Progression {
    uint64_t at;     // the next byte to look at
    uint64_t bad_at; // where what is no chunk began
    bool is_bad;
} Progression;

static uint32_t end_of(const RecordingChunkHeader *header) {
    return header->first + header->count;
}

static Result add_chunk(RecordingReader *reader, uint64_t at, const RecordingChunkHeader *header) {
    if (reader->chunk_count == CHUNKS_MAX) {
        log_error("%s: byte %" PRIu64 ": more than %d chunks; no flight of 100 hours has so many", reader->path, at,
                  CHUNKS_MAX);
        return RESULT_FORMAT;
    }
    if (reader->chunk_count == reader->chunk_room) {
        int room = reader->chunk_room ? 2 * reader->chunk_room : 1024;
        IndexEntry *grown = realloc(reader->chunks, sizeof *grown * (size_t)room);
        if (!grown) {
            log_error("%s: no memory for the index of the recording", reader->path);
            return RESULT_MEMORY;
        }
        reader->chunks = grown;
        reader->chunk_room = room;
    }
    reader->chunks[reader->chunk_count++] = (IndexEntry){at, *header};
    return RESULT_OK;
}

// What lies between the chunk before and the record that begins at `at` with step `first`.
static void account(RecordingReader *reader, Progression *p, uint64_t at, uint32_t first) {
    uint32_t expected = reader->chunk_count > 0 ? reader->end : first;
    if (p->is_bad)
        add_damage(reader, (RecordingDamage){RECORDING_DAMAGED, p->bad_at, at - p->bad_at, expected, first - expected});
    else if (first > expected)
        add_damage(reader, (RecordingDamage){RECORDING_MISSING, at, 0, expected, first - expected});
    p->is_bad = false;
}

// The header of a sound record at `at`, in its place. The frame is decoded into reader->chunk.
static bool is_sound(RecordingReader *reader, uint64_t at, RecordingChunkHeader *out) {
    const uint8_t *bytes = recording_scan_bytes(&reader->scan, at, RECORDING_CHUNK_HEADER_BYTES);
    if (!bytes || !recording_chunk_decode_header(reader->codec, bytes, out))
        return false;
    if (reader->closed || (reader->chunk_count > 0 && out->first < reader->end))
        return false;
    if (out->kind == RECORDING_CHUNK_END)
        return true;
    const uint8_t *frame = recording_scan_bytes(&reader->scan, at + RECORDING_CHUNK_HEADER_BYTES, out->payload);
    return frame && recording_chunk_decode(reader->codec, out, frame, &reader->chunk);
}

static Result take_record(RecordingReader *reader, Progression *p) {
    RecordingChunkHeader header;
    if (!is_sound(reader, p->at, &header)) {
        p->bad_at = p->is_bad ? p->bad_at : p->at;
        p->is_bad = true;
        p->at = recording_scan_find(&reader->scan, p->at + 1, RECORDING_SYNC);
        return RESULT_OK;
    }
    account(reader, p, p->at, header.first);
    reader->end = end_of(&header);
    reader->closed = header.kind == RECORDING_CHUNK_END;
    Result result = reader->closed ? RESULT_OK : add_chunk(reader, p->at, &header);
    p->at += RECORDING_CHUNK_HEADER_BYTES + header.payload;
    return result;
}

static Result read_chunks(RecordingReader *reader, uint64_t at) {
    Progression p = {.at = at};
    Result result = RESULT_OK;
    while (result == RESULT_OK && p.at < reader->scan.bytes && !reader->scan.error)
        result = take_record(reader, &p);
    if (reader->scan.error) {
        log_error("%s: byte %" PRIu64 ": cannot be read: %s", reader->path, p.at, strerror(reader->scan.error));
        return RESULT_IO;
    }
    if (p.is_bad)
        add_damage(reader, (RecordingDamage){reader->closed ? RECORDING_DAMAGED : RECORDING_CUT_OFF, p.bad_at,
                                             reader->scan.bytes - p.bad_at, 0, 0});
    return result;
}

// ---- segments ----

static void add_stateless(RecordingReader *reader, int chunk, uint32_t first, uint32_t end) {
    if (end > first)
        add_damage(reader, (RecordingDamage){RECORDING_STATELESS, reader->chunks[chunk].offset, 0, first, end - first});
}

static bool is_keyframe(const RecordingReader *reader, int chunk) {
    return reader->chunks[chunk].header.flags & RECORDING_CHUNK_KEYFRAME;
}

// From the keyframe at `chunk` on; the chunk after it.
static int add_segment(RecordingReader *reader, int chunk) {
    const RecordingChunkHeader *header = &reader->chunks[chunk].header;
    RecordingSegment *before = reader->segment_count > 0 ? &reader->segments[reader->segment_count - 1] : NULL;
    RecordingSegment segment = {
        .first = header->first, .chunk = chunk, .restart = header->flags & RECORDING_CHUNK_RESTART};
    segment.follows = before && !segment.restart && before->known_end == segment.first;
    segment.known_end = end_of(header);
    int i = chunk + 1;
    for (; i < reader->chunk_count && !is_keyframe(reader, i) && reader->chunks[i].header.first == segment.known_end;
         i++)
        segment.known_end = end_of(&reader->chunks[i].header);
    segment.chunk_end = i;
    int orphan = i;
    while (i < reader->chunk_count && !is_keyframe(reader, i))
        i++;
    if (i > orphan)
        add_stateless(reader, orphan, reader->chunks[orphan].header.first, end_of(&reader->chunks[i - 1].header));
    segment.end = i < reader->chunk_count ? reader->chunks[i].header.first : reader->end;
    reader->segments[reader->segment_count++] = segment;
    return i;
}

static Result find_segments(RecordingReader *reader) {
    int count = 0, i = 0;
    for (int chunk = 0; chunk < reader->chunk_count; chunk++)
        count += is_keyframe(reader, chunk);
    if (count == 0) {
        log_error("%s: byte %" PRIu64 ": expected a flight, found %d chunks without a state to begin from; it was cut "
                  "off before its first second, or is damaged",
                  reader->path, reader->scan.bytes, reader->chunk_count);
        return RESULT_FORMAT;
    }
    reader->segments = calloc((size_t)count, sizeof *reader->segments);
    if (!reader->segments)
        return RESULT_MEMORY;
    while (!is_keyframe(reader, i))
        i++;
    add_stateless(reader, 0, reader->chunks[0].header.first, reader->chunks[i].header.first);
    while (i < reader->chunk_count)
        i = add_segment(reader, i);
    return RESULT_OK;
}

// ---- opening ----

static Result read_header(RecordingReader *reader, size_t *header_bytes) {
    uint64_t size = reader->scan.bytes;
    size_t count = size < RECORDING_HEADER_BYTES_MAX ? (size_t)size : RECORDING_HEADER_BYTES_MAX;
    const uint8_t *bytes = recording_scan_bytes(&reader->scan, 0, count);
    uint32_t crc;
    if (!bytes) {
        log_error("%s: byte 0: cannot be read: %s", reader->path, strerror(reader->scan.error));
        return RESULT_IO;
    }
    Result result = recording_header_decode(reader->path, bytes, count, &reader->header, header_bytes, &crc);
    if (result == RESULT_OK)
        result = recording_codec_create(&reader->header, crc, &reader->codec);
    if (result != RESULT_OK)
        return result;
    reader->chunk.state = malloc(reader->header.state_bytes);
    return reader->chunk.state ? RESULT_OK : RESULT_MEMORY;
}

static void tell_whole(const RecordingReader *reader) {
    char time[RECORDING_TIME_BYTES];
    if (reader->damage_count > DAMAGES_LOGGED)
        log_warn("%s: %d damages in all", reader->path, reader->damage_count);
    if (!reader->closed)
        log_info("%s: not closed in good order, so the last second may be missing; it ends at %s", reader->path,
                 recording_time_text(reader->end, reader->header.steps_per_s, time));
}

Result recording_reader_open(const char *path, RecordingReader **out) {
    RecordingReader *reader = calloc(1, sizeof *reader);
    size_t header_bytes = 0;
    if (!reader)
        return RESULT_MEMORY;
    reader->chunk_index = -1;
    reader->scan.file = -1;
    reader->path = strdup(path);
    Result result = reader->path ? recording_scan_open(reader->path, &reader->scan) : RESULT_MEMORY;
    if (result == RESULT_OK)
        result = read_header(reader, &header_bytes);
    if (result == RESULT_OK)
        result = read_chunks(reader, header_bytes);
    if (result == RESULT_OK)
        result = find_segments(reader);
    if (result != RESULT_OK) {
        recording_reader_close(&reader);
        return result;
    }
    tell_whole(reader);
    *out = reader;
    return RESULT_OK;
}

void recording_reader_close(RecordingReader **reader) {
    RecordingReader *self = *reader;
    if (!self)
        return;
    recording_scan_close(&self->scan);
    recording_codec_destroy(&self->codec);
    free(self->chunk.state);
    free(self->segments);
    free(self->chunks);
    free(self->path);
    free(self);
    *reader = NULL;
}

// ---- questions ----

const char *recording_reader_path(const RecordingReader *reader) {
    return reader->path;
}

const RecordingHeader *recording_reader_header(const RecordingReader *reader) {
    return &reader->header;
}

uint32_t recording_reader_first(const RecordingReader *reader) {
    return reader->segments[0].first;
}

uint32_t recording_reader_end(const RecordingReader *reader) {
    return reader->end;
}

bool recording_reader_was_closed(const RecordingReader *reader) {
    return reader->closed;
}

int recording_reader_damages(const RecordingReader *reader, const RecordingDamage **out) {
    *out = reader->damages;
    return reader->damage_count;
}

int recording_reader_segment_count(const RecordingReader *reader) {
    return reader->segment_count;
}

const RecordingSegment *recording_reader_segment(const RecordingReader *reader, int index) {
    return &reader->segments[index];
}

int recording_reader_segment_at(const RecordingReader *reader, uint32_t step) {
    int low = 0, high = reader->segment_count;
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (reader->segments[middle].first <= step)
            low = middle;
        else
            high = middle;
    }
    return low;
}

int recording_reader_chunk_at(const RecordingReader *reader, uint32_t step) {
    int low = 0, high = reader->chunk_count;
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (reader->chunks[middle].header.first <= step)
            low = middle;
        else
            high = middle;
    }
    const RecordingChunkHeader *header = &reader->chunks[low].header;
    return step >= header->first && step < end_of(header) ? low : -1;
}

Result recording_reader_chunk(RecordingReader *reader, int index, const RecordingChunk **out) {
    const IndexEntry *entry = &reader->chunks[index];
    *out = &reader->chunk;
    if (index == reader->chunk_index)
        return RESULT_OK;
    reader->chunk_index = -1;
    const uint8_t *frame =
        recording_scan_bytes(&reader->scan, entry->offset + RECORDING_CHUNK_HEADER_BYTES, entry->header.payload);
    if (!frame || !recording_chunk_decode(reader->codec, &entry->header, frame, &reader->chunk)) {
        log_error("%s: byte %" PRIu64 ": what was a chunk of the flight is none any more; did something else write to "
                  "the file?",
                  reader->path, entry->offset);
        return frame ? RESULT_FORMAT : RESULT_IO;
    }
    reader->chunk_index = index;
    return RESULT_OK;
}

static Result append_events(const RecordingReader *reader, const RecordingChunk *chunk, RecordingEvent **events,
                            int *count) {
    if (chunk->event_count == 0)
        return RESULT_OK;
    RecordingEvent *grown = realloc(*events, sizeof *grown * (size_t)(*count + chunk->event_count));
    if (!grown) {
        log_error("%s: no memory for the events of the recording", reader->path);
        return RESULT_MEMORY;
    }
    memcpy(grown + *count, chunk->events, sizeof *grown * (size_t)chunk->event_count);
    *events = grown;
    *count += chunk->event_count;
    return RESULT_OK;
}

Result recording_reader_events(RecordingReader *reader, RecordingEvent **out, int *count) {
    RecordingEvent *events = NULL;
    Result result = RESULT_OK;
    *count = 0;
    for (int i = 0; i < reader->chunk_count && result == RESULT_OK; i++) {
        const RecordingChunk *chunk;
        result = recording_reader_chunk(reader, i, &chunk);
        if (result == RESULT_OK)
            result = append_events(reader, chunk, &events, count);
    }
    if (result == RESULT_OK)
        *out = events;
    else
        free(events);
    return result;
}

Result recording_reader_steps(RecordingReader *reader, uint32_t first, uint32_t count, RecordingStep *out) {
    for (uint32_t i = 0; i < count; i++) {
        const RecordingChunk *chunk;
        int index = recording_reader_chunk_at(reader, first + i);
        out[i] = (RecordingStep){.known = false};
        if (index < 0)
            continue;
        Result result = recording_reader_chunk(reader, index, &chunk);
        if (result != RESULT_OK)
            return result;
        uint32_t k = first + i - chunk->first;
        out[i] = (RecordingStep){chunk->codes[k], chunk->hashes[k], true};
    }
    return RESULT_OK;
}
