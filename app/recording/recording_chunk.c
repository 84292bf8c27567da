#include "app/recording/recording_chunk.h"

#include "app/recording/recording_bytes.h"
#include "app/recording/recording_column.h"
#include "app/recording/recording_zstd.h"

#include <stdlib.h>
#include <string.h>

#define CRC_AT 16
#define EVENT_HEAD_BYTES 4
#define FIXED_BYTES (8 + 8 + 2) // two running hashes, number of events
#define EVENTS_BYTES (RECORDING_CHUNK_EVENTS_MAX * (EVENT_HEAD_BYTES + RECORDING_EVENT_DATA_MAX))
#define COLUMNS (RECORDING_WIDE_COUNT + RECORDING_NARROW_COUNT)
#define HASH_BYTES 2        // a step
#define INPUT_BYTES_USUAL 4 // a step
_Static_assert(sizeof(ControlsCode) == 2 * RECORDING_WIDE_COUNT + RECORDING_NARROW_COUNT, "every field has its column");

struct RecordingCodec {
    RecordingZstd *zstd;
    uint32_t crc, state_bytes;
    int chunk_steps;
    size_t content_max, bound;
    uint8_t *content;
};

static size_t inputs_bound(int steps) {
    return (COLUMNS * (RECORDING_COLUMN_HEAD_BITS + (size_t)steps * RECORDING_COLUMN_STEP_BITS) + 7) / 8;
}

Result recording_codec_create(const RecordingHeader *header, uint32_t crc, RecordingCodec **out) {
    RecordingCodec *codec = calloc(1, sizeof *codec);
    if (!codec)
        return RESULT_MEMORY;
    codec->crc = crc;
    codec->state_bytes = header->state_bytes;
    codec->chunk_steps = header->chunk_steps;
    codec->content_max = FIXED_BYTES + EVENTS_BYTES + header->state_bytes + inputs_bound(header->chunk_steps) +
                         (size_t)header->chunk_steps * HASH_BYTES;
    codec->bound = RECORDING_CHUNK_HEADER_BYTES + recording_zstd_bound(codec->content_max, 2);
    codec->content = malloc(codec->content_max);
    size_t usual = FIXED_BYTES + header->state_bytes + (size_t)header->chunk_steps * (INPUT_BYTES_USUAL + HASH_BYTES);
    if (codec->content && recording_zstd_create(usual, &codec->zstd) == RESULT_OK) {
        *out = codec;
        return RESULT_OK;
    }
    recording_codec_destroy(&codec);
    return RESULT_MEMORY;
}

void recording_codec_destroy(RecordingCodec **codec) {
    if (!*codec)
        return;
    recording_zstd_destroy(&(*codec)->zstd);
    free((*codec)->content);
    free(*codec);
    *codec = NULL;
}

size_t recording_codec_bound(const RecordingCodec *codec) {
    return codec->bound;
}

// ---- headers ----

static void encode_header(const RecordingCodec *codec, const RecordingChunkHeader *header, uint8_t *out) {
    recording_put32(out, RECORDING_SYNC);
    out[4] = header->kind;
    out[5] = header->flags;
    recording_put16(out + 6, header->count);
    recording_put32(out + 8, header->first);
    recording_put32(out + 12, header->payload);
    recording_put32(out + CRC_AT, recording_crc32(codec->crc, out, CRC_AT));
}

void recording_chunk_encode_end(const RecordingCodec *codec, uint32_t steps,
                                uint8_t out[RECORDING_CHUNK_HEADER_BYTES]) {
    encode_header(codec, &(RecordingChunkHeader){.kind = RECORDING_CHUNK_END, .first = steps}, out);
}

static bool is_sane(const RecordingCodec *codec, const RecordingChunkHeader *header) {
    if (header->kind == RECORDING_CHUNK_END)
        return header->payload == 0 && header->count == 0;
    bool keyframe = header->flags & RECORDING_CHUNK_KEYFRAME, restart = header->flags & RECORDING_CHUNK_RESTART;
    return header->kind == RECORDING_CHUNK_FLIGHT && header->count <= codec->chunk_steps &&
           header->first <= RECORDING_STEPS_MAX && header->payload <= codec->bound && (keyframe || !restart);
}

bool recording_chunk_decode_header(const RecordingCodec *codec, const uint8_t bytes[RECORDING_CHUNK_HEADER_BYTES],
                                   RecordingChunkHeader *out) {
    if (recording_get32(bytes) != RECORDING_SYNC ||
        recording_get32(bytes + CRC_AT) != recording_crc32(codec->crc, bytes, CRC_AT))
        return false;
    *out = (RecordingChunkHeader){bytes[4], bytes[5], recording_get16(bytes + 6), recording_get32(bytes + 8),
                                  recording_get32(bytes + 12)};
    return is_sane(codec, out);
}

// ---- inputs, column after column ----

static const uint8_t WIDE_AT[RECORDING_WIDE_COUNT] = {
#define WIDE_FIELD(field, name, least, greatest, per_unit) offsetof(ControlsCode, field),
    RECORDING_WIDE_TABLE(WIDE_FIELD)
#undef WIDE_FIELD
};

static const uint8_t NARROW_AT[RECORDING_NARROW_COUNT] = {
#define NARROW_FIELD(field, name, least, greatest, per_unit) offsetof(ControlsCode, field),
    RECORDING_NARROW_TABLE(NARROW_FIELD) offsetof(ControlsCode, bits)
#undef NARROW_FIELD
};

static void gather(const RecordingChunk *chunk, int column, int16_t *out) {
    for (int i = 0; i < chunk->count; i++) {
        const uint8_t *code = (const uint8_t *)&chunk->codes[i];
        if (column < RECORDING_WIDE_COUNT)
            memcpy(&out[i], code + WIDE_AT[column], sizeof out[i]);
        else
            out[i] = code[NARROW_AT[column - RECORDING_WIDE_COUNT]];
    }
}

static void scatter(RecordingChunk *chunk, int column, const int16_t *values) {
    for (int i = 0; i < chunk->count; i++) {
        uint8_t *code = (uint8_t *)&chunk->codes[i];
        if (column < RECORDING_WIDE_COUNT)
            memcpy(code + WIDE_AT[column], &values[i], sizeof values[i]);
        else
            code[NARROW_AT[column - RECORDING_WIDE_COUNT]] = (uint8_t)values[i];
    }
}

static size_t encode_inputs(const RecordingChunk *chunk, uint8_t *out) {
    int16_t values[RECORDING_CHUNK_STEPS_MAX];
    RecordingBits bits = {.bytes = out, .bits = 8 * inputs_bound(chunk->count)};
    memset(out, 0, inputs_bound(chunk->count));
    for (int i = 0; i < COLUMNS; i++) {
        gather(chunk, i, values);
        recording_column_write(&bits, values, chunk->count);
    }
    return (bits.bit + 7) / 8;
}

// Exactly `count` bytes, or false.
static bool decode_inputs(RecordingChunk *chunk, uint8_t *from, size_t count) {
    int16_t values[RECORDING_CHUNK_STEPS_MAX];
    RecordingBits bits = {.bytes = from, .bits = 8 * count};
    for (int i = 0; i < COLUMNS; i++) {
        if (!recording_column_read(&bits, values, chunk->count))
            return false;
        scatter(chunk, i, values);
    }
    return bits.bits - bits.bit < 8;
}
_Static_assert(RECORDING_CHUNK_STEPS_MAX <= RECORDING_COLUMN_STEPS_MAX, "a column takes a chunk's steps");

// ---- the rest ----

static size_t encode_events(const RecordingChunk *chunk, uint8_t *out) {
    uint8_t *at = out;
    for (int i = 0; i < chunk->event_count; i++) {
        const RecordingEvent *event = &chunk->events[i];
        recording_put16(at, (uint16_t)(event->step - chunk->first));
        at[2] = event->kind;
        at[3] = event->bytes;
        memcpy(at + EVENT_HEAD_BYTES, event->data, event->bytes);
        at += EVENT_HEAD_BYTES + event->bytes;
    }
    return (size_t)(at - out);
}

static bool decode_event(RecordingChunk *chunk, int i, const uint8_t **at, const uint8_t *end) {
    if (end - *at < EVENT_HEAD_BYTES)
        return false;
    uint16_t after = recording_get16(*at);
    RecordingEvent *event = &chunk->events[i];
    *event = (RecordingEvent){.step = chunk->first + after, .kind = (*at)[2], .bytes = (*at)[3]};
    *at += EVENT_HEAD_BYTES;
    bool in_order = i == 0 || event->step >= chunk->events[i - 1].step;
    if (after > chunk->count || !in_order || event->bytes > RECORDING_EVENT_DATA_MAX || end - *at < event->bytes)
        return false;
    memcpy(event->data, *at, event->bytes);
    *at += event->bytes;
    return true;
}

static size_t encode_head(const RecordingCodec *codec, const RecordingChunk *chunk, uint8_t *out) {
    uint8_t *at = out;
    recording_put64(at, chunk->hash_after);
    recording_put16(at + 8, (uint16_t)chunk->event_count);
    at += 10;
    at += encode_events(chunk, at);
    if (chunk->keyframe) {
        recording_put64(at, chunk->hash_before);
        memcpy(at + 8, chunk->state, codec->state_bytes);
        at += 8 + codec->state_bytes;
    }
    return (size_t)(at - out);
}

// Where the inputs begin; NULL: it is damaged.
static const uint8_t *decode_head(const RecordingCodec *codec, RecordingChunk *chunk, const uint8_t *at,
                                  const uint8_t *end) {
    if (end - at < 10)
        return NULL;
    chunk->hash_after = recording_get64(at);
    chunk->event_count = recording_get16(at + 8);
    at += 10;
    if (chunk->event_count > RECORDING_CHUNK_EVENTS_MAX)
        return NULL;
    for (int i = 0; i < chunk->event_count; i++)
        if (!decode_event(chunk, i, &at, end))
            return NULL;
    if (!chunk->keyframe)
        return at;
    if (end - at < 8 + (ptrdiff_t)codec->state_bytes)
        return NULL;
    chunk->hash_before = recording_get64(at);
    memcpy(chunk->state, at + 8, codec->state_bytes);
    return at + 8 + codec->state_bytes;
}

size_t recording_chunk_encode(RecordingCodec *codec, const RecordingChunk *chunk, uint8_t *out, size_t capacity) {
    size_t head = encode_head(codec, chunk, codec->content);
    size_t inputs = encode_inputs(chunk, codec->content + head);
    uint8_t *hashes = codec->content + head + inputs;
    for (int i = 0; i < chunk->count; i++)
        recording_put16(hashes + 2 * i, chunk->hashes[i]);
    size_t rest = inputs + (size_t)chunk->count * HASH_BYTES;
    const RecordingSpan spans[] = {{codec->content, head}, {codec->content + head, rest}},
                        whole = {codec->content, head + rest};
    size_t payload =
        capacity < RECORDING_CHUNK_HEADER_BYTES
            ? 0
            : recording_zstd_compress(codec->zstd, chunk->keyframe ? spans : &whole, chunk->keyframe ? 2 : 1,
                                      out + RECORDING_CHUNK_HEADER_BYTES, capacity - RECORDING_CHUNK_HEADER_BYTES);
    if (payload == 0)
        return 0;
    encode_header(codec,
                  &(RecordingChunkHeader){.kind = RECORDING_CHUNK_FLIGHT,
                                          .flags = (uint8_t)((chunk->keyframe ? RECORDING_CHUNK_KEYFRAME : 0) |
                                                             (chunk->restart ? RECORDING_CHUNK_RESTART : 0)),
                                          .count = (uint16_t)chunk->count,
                                          .first = chunk->first,
                                          .payload = (uint32_t)payload},
                  out);
    return RECORDING_CHUNK_HEADER_BYTES + payload;
}

bool recording_chunk_decode(RecordingCodec *codec, const RecordingChunkHeader *header, const uint8_t *frame,
                            RecordingChunk *chunk) {
    size_t size;
    if (!recording_zstd_decompress(codec->zstd, frame, header->payload, codec->content, codec->content_max, &size))
        return false;
    chunk->first = header->first;
    chunk->count = header->count;
    chunk->keyframe = header->flags & RECORDING_CHUNK_KEYFRAME;
    chunk->restart = header->flags & RECORDING_CHUNK_RESTART;
    const uint8_t *end = codec->content + size, *inputs = decode_head(codec, chunk, codec->content, end);
    size_t hash_bytes = (size_t)chunk->count * HASH_BYTES;
    if (!inputs || (size_t)(end - inputs) < hash_bytes)
        return false;
    const uint8_t *hashes = end - hash_bytes;
    if (!decode_inputs(chunk, codec->content + (inputs - codec->content), (size_t)(hashes - inputs)))
        return false;
    for (int i = 0; i < chunk->count; i++)
        chunk->hashes[i] = recording_get16(hashes + 2 * i);
    return true;
}
