#define _POSIX_C_SOURCE 200809L
#include "app/recording/recording_writer.h"

#include "app/recording/recording_disk.h"
#include "app/recording/recording_ring.h"
#include "app/signals.h"
#include "base/clock.h"
#include "base/log.h"

#include <errno.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#define KEPT_SEGMENTS (RECORDING_KEPT_STEPS / RECORDING_KEYFRAME_STEPS + 2)
#define SYNC_NS INT64_C(10000000000) // what a power failure may take; a killed program loses none of it
#define KEPT_CHUNKS (KEPT_SEGMENTS * RECORDING_KEYFRAME_STEPS / RECORDING_CHUNK_STEPS)

// A file to be written whole; its bytes are taken when it is asked for.
typedef struct Save {
    RecordingSaving state;
    char *path;
    uint8_t *bytes;
    size_t count;
    uint32_t steps;
} Save;

struct RecordingWriter {
    // Of the simulation's thread.
    RecordingHeader header;
    uint8_t file_header[RECORDING_HEADER_BYTES_MAX];
    size_t file_header_bytes;
    RecordingCodec *codec;
    RecordingChunk chunk; // not full yet
    uint32_t steps, since_keyframe;
    uint64_t hash;
    uint8_t *encoded; // room for a chunk
    bool told_full, told_encode;

    // Of both; under the lock.
    pthread_mutex_t lock;
    pthread_cond_t changed;
    RecordingRing *ring;
    Save save;
    bool closing, failing;
    uint64_t file_bytes;

    // Of the thread.
    pthread_t thread;
    int64_t synced_ns;
    bool lock_lives, thread_runs;
    RecordingDisk disk;
    int64_t next, tried_until; // numbers of chunks: to be written; there was no more when writing failed
    uint32_t written_steps;    // the end of the last chunk written
    uint64_t lost_steps;
    bool told_failed;
    uint8_t *unwritten; // room for a chunk
};

// ---- the thread ----

// What no longer is in memory will never be in the file.
static void skip_forgotten(RecordingWriter *writer) {
    int64_t oldest = recording_ring_oldest(writer->ring);
    if (writer->next >= oldest)
        return;
    writer->next = oldest;
    uint32_t first = recording_ring_entry(writer->ring, oldest)->first;
    writer->lost_steps += first - writer->written_steps;
    writer->written_steps = first;
}

// There is a chunk to be written that was not tried in vain already.
static bool is_behind(const RecordingWriter *writer) {
    int64_t end = recording_ring_end(writer->ring);
    return writer->disk.file >= 0 && writer->next < end && (!writer->failing || writer->tried_until < end);
}

static void tell_failed(RecordingWriter *writer, int error) {
    char time[RECORDING_TIME_BYTES];
    if (writer->told_failed)
        return;
    writer->told_failed = true;
    log_error("%s: byte %" PRIu64 ": cannot be written: %s; it ends at %s of the flight, which goes on. Room made "
              "within ten minutes lets the file catch up; F5 saves the last ten minutes elsewhere",
              writer->disk.path, writer->disk.bytes, strerror(error),
              recording_time_text(writer->written_steps, writer->header.steps_per_s, time));
}

static bool sync_when_due(RecordingWriter *writer) {
    int64_t now_ns = clock_now_ns();
    if (now_ns - writer->synced_ns < SYNC_NS)
        return true;
    writer->synced_ns = now_ns;
    return recording_disk_sync(&writer->disk);
}

// Called with the lock, which is open while the disk works.
static void write_chunk(RecordingWriter *writer) {
    skip_forgotten(writer);
    RecordingRingEntry entry = *recording_ring_entry(writer->ring, writer->next);
    memcpy(writer->unwritten, recording_ring_bytes(writer->ring, &entry), entry.bytes);
    pthread_mutex_unlock(&writer->lock);
    bool written = recording_disk_append(&writer->disk, writer->unwritten, entry.bytes);
    if (!written || !sync_when_due(writer))
        tell_failed(writer, errno);
    pthread_mutex_lock(&writer->lock);
    pthread_cond_broadcast(&writer->changed);
    writer->failing = !written;
    writer->file_bytes = writer->disk.bytes;
    if (written) {
        writer->next++;
        writer->written_steps = entry.first + (uint32_t)entry.count;
    } else {
        writer->tried_until = recording_ring_end(writer->ring);
    }
}

static void write_save(RecordingWriter *writer) {
    Save save = writer->save;
    char time[RECORDING_TIME_BYTES];
    pthread_mutex_unlock(&writer->lock);
    Result result = recording_disk_write_whole(save.path, save.bytes, save.count);
    if (result == RESULT_OK)
        log_info("%s: the last %s of the flight, %zu bytes", save.path,
                 recording_time_text(save.steps, writer->header.steps_per_s, time), save.count);
    free(save.path);
    free(save.bytes);
    pthread_mutex_lock(&writer->lock);
    writer->save = (Save){.state = result == RESULT_OK ? RECORDING_SAVING_DONE : RECORDING_SAVING_FAILED};
}

static void *write_until_closed(void *user) {
    RecordingWriter *writer = user;
    pthread_mutex_lock(&writer->lock);
    for (;;) {
        if (writer->save.state == RECORDING_SAVING_GOES_ON)
            write_save(writer);
        else if (is_behind(writer))
            write_chunk(writer);
        else if (writer->closing)
            break;
        else
            pthread_cond_wait(&writer->changed, &writer->lock);
    }
    pthread_mutex_unlock(&writer->lock);
    return NULL;
}

// ---- the chunk in hand ----

static void begin_chunk(RecordingWriter *writer, const void *state) {
    RecordingChunk *chunk = &writer->chunk;
    chunk->first = writer->steps;
    chunk->count = chunk->event_count = 0;
    chunk->restart = false;
    chunk->keyframe = state != NULL;
    if (!state)
        return;
    memcpy(chunk->state, state, writer->header.state_bytes);
    chunk->hash_before = writer->hash;
    writer->since_keyframe = 0;
}

static size_t encode(RecordingWriter *writer, uint8_t *out) {
    writer->chunk.hash_after = writer->hash;
    return recording_chunk_encode(writer->codec, &writer->chunk, out, recording_codec_bound(writer->codec));
}

static void end_chunk(RecordingWriter *writer) {
    size_t count = encode(writer, writer->encoded);
    if (count == 0) {
        if (!writer->told_encode)
            log_error("the recording loses its steps from %" PRIu32 " on: they could not be compressed",
                      writer->chunk.first);
        writer->told_encode = true;
        return;
    }
    pthread_mutex_lock(&writer->lock);
    recording_ring_push(writer->ring, &writer->chunk, writer->encoded, count);
    pthread_cond_broadcast(&writer->changed);
    pthread_mutex_unlock(&writer->lock);
}

// Steps until the chunk ends: when it is full, or a keyframe is due.
static uint32_t steps_left(const RecordingWriter *writer) {
    uint32_t full = (uint32_t)(writer->header.chunk_steps - writer->chunk.count);
    uint32_t due = RECORDING_KEYFRAME_STEPS - writer->since_keyframe;
    return full < due ? full : due;
}

bool recording_writer_wants_state(const RecordingWriter *writer) {
    return writer->since_keyframe + 1 == RECORDING_KEYFRAME_STEPS;
}

static bool is_full(RecordingWriter *writer) {
    if (writer->steps < RECORDING_STEPS_MAX)
        return false;
    if (!writer->told_full)
        log_error("the recording ends here: %d hours are the most",
                  RECORDING_STEPS_MAX / 3600 / writer->header.steps_per_s);
    writer->told_full = true;
    return true;
}

void recording_writer_step(RecordingWriter *writer, ControlsCode code, uint64_t state_hash, const void *state) {
    RecordingChunk *chunk = &writer->chunk;
    if (is_full(writer))
        return;
    bool keyframe_next = recording_writer_wants_state(writer), last = steps_left(writer) == 1;
    writer->hash = recording_hash_next(writer->hash, state_hash);
    chunk->codes[chunk->count] = code;
    chunk->hashes[chunk->count] = recording_hash_short(writer->hash);
    chunk->count++;
    writer->steps++;
    writer->since_keyframe++;
    if (!last)
        return;
    end_chunk(writer);
    begin_chunk(writer, keyframe_next ? state : NULL);
}

// One of the same kind before the same step has had no effect: a pilot may try winds for long while time stands still.
static void forget_same(RecordingChunk *chunk, uint32_t step, RecordingEventKind kind) {
    for (int i = 0; i < chunk->event_count; i++) {
        if (chunk->events[i].step != step || chunk->events[i].kind != kind)
            continue;
        memmove(&chunk->events[i], &chunk->events[i + 1],
                sizeof chunk->events[0] * (size_t)(chunk->event_count - i - 1));
        chunk->event_count--;
        return;
    }
}

// Those before the coming step go with it: a chunk's events are before its own steps.
static void begin_chunk_for_events(RecordingWriter *writer) {
    RecordingEvent pending[RECORDING_CHUNK_EVENTS_MAX];
    RecordingChunk *chunk = &writer->chunk;
    int kept = chunk->event_count, count = 0;
    while (kept > 0 && chunk->events[kept - 1].step == writer->steps)
        kept--;
    for (int i = kept; i < chunk->event_count; i++)
        pending[count++] = chunk->events[i];
    chunk->event_count = kept;
    end_chunk(writer);
    begin_chunk(writer, NULL);
    memcpy(chunk->events, pending, sizeof pending[0] * (size_t)count);
    chunk->event_count = count;
}

void recording_writer_event(RecordingWriter *writer, RecordingEventKind kind, const void *data, size_t bytes) {
    if (is_full(writer))
        return;
    forget_same(&writer->chunk, writer->steps, kind);
    if (writer->chunk.event_count == RECORDING_CHUNK_EVENTS_MAX)
        begin_chunk_for_events(writer);
    RecordingEvent *event = &writer->chunk.events[writer->chunk.event_count++];
    *event = (RecordingEvent){.step = writer->steps, .kind = (uint8_t)kind, .bytes = (uint8_t)bytes};
    if (bytes > 0)
        memcpy(event->data, data, bytes);
}

void recording_writer_restart(RecordingWriter *writer, RecordingEventKind kind, const void *state) {
    if (is_full(writer))
        return;
    if (writer->chunk.count > 0 || writer->chunk.event_count > 0)
        end_chunk(writer);
    begin_chunk(writer, state);
    writer->chunk.restart = true;
    recording_writer_event(writer, kind, NULL, 0);
}

// ---- saving ----

// Everything but the chunk in hand, which is not in the ring, and the end.
static size_t save_bytes(const RecordingWriter *writer, int64_t from) {
    size_t count = writer->file_header_bytes + recording_codec_bound(writer->codec) + RECORDING_CHUNK_HEADER_BYTES;
    for (int64_t i = from; i < recording_ring_end(writer->ring); i++)
        count += recording_ring_entry(writer->ring, i)->bytes;
    return count;
}

static size_t append(Save *save, const void *bytes, size_t count) {
    memcpy(save->bytes + save->count, bytes, count);
    return save->count + count;
}

static void fill_save(RecordingWriter *writer, int64_t from, Save *save) {
    uint32_t first = writer->chunk.first;
    save->count = append(save, writer->file_header, writer->file_header_bytes);
    for (int64_t i = from; i < recording_ring_end(writer->ring); i++) {
        const RecordingRingEntry *entry = recording_ring_entry(writer->ring, i);
        first = entry->first < first ? entry->first : first;
        save->count = append(save, recording_ring_bytes(writer->ring, entry), entry->bytes);
    }
    if (writer->chunk.count > 0)
        save->count += encode(writer, save->bytes + save->count);
    recording_chunk_encode_end(writer->codec, writer->steps, save->bytes + save->count);
    save->count += RECORDING_CHUNK_HEADER_BYTES;
    save->steps = writer->steps - first;
}

Result recording_writer_save(RecordingWriter *writer, const char *path) {
    if (writer->steps == 0) {
        log_error("%s: nothing is recorded yet", path);
        return RESULT_RANGE;
    }
    if (recording_writer_saving(writer) == RECORDING_SAVING_GOES_ON) {
        log_error("%s: not written, as the last ten minutes are being written already; wait a moment", path);
        return RESULT_BUDGET;
    }
    // Nobody but this thread changes the ring: reading it needs no lock.
    int64_t from = recording_ring_find(writer->ring, RECORDING_KEPT_STEPS - (uint32_t)writer->chunk.count);
    Save save = {RECORDING_SAVING_GOES_ON, strdup(path), malloc(save_bytes(writer, from)), 0, 0};
    if (!save.path || !save.bytes) {
        free(save.path);
        free(save.bytes);
        log_error("%s: no memory to save the last ten minutes", path);
        return RESULT_MEMORY;
    }
    fill_save(writer, from, &save);
    pthread_mutex_lock(&writer->lock);
    writer->save = save;
    pthread_cond_broadcast(&writer->changed);
    pthread_mutex_unlock(&writer->lock);
    return RESULT_OK;
}

RecordingSaving recording_writer_saving(RecordingWriter *writer) {
    pthread_mutex_lock(&writer->lock);
    RecordingSaving saving = writer->save.state;
    pthread_mutex_unlock(&writer->lock);
    return saving;
}

bool recording_writer_failed(RecordingWriter *writer) {
    pthread_mutex_lock(&writer->lock);
    bool failing = writer->failing;
    pthread_mutex_unlock(&writer->lock);
    return failing;
}

void recording_writer_wait(RecordingWriter *writer) {
    pthread_mutex_lock(&writer->lock);
    while (is_behind(writer))
        pthread_cond_wait(&writer->changed, &writer->lock);
    pthread_mutex_unlock(&writer->lock);
}

uint64_t recording_writer_file_bytes(RecordingWriter *writer) {
    pthread_mutex_lock(&writer->lock);
    uint64_t bytes = writer->file_bytes;
    pthread_mutex_unlock(&writer->lock);
    return bytes;
}

uint32_t recording_writer_steps(const RecordingWriter *writer) {
    return writer->steps;
}

uint64_t recording_writer_hash(const RecordingWriter *writer) {
    return writer->hash;
}

// ---- begin and end ----

static Result make_memory(RecordingWriter *writer) {
    uint32_t crc;
    writer->file_header_bytes = recording_header_encode(&writer->header, writer->file_header, &crc);
    Result result = recording_codec_create(&writer->header, crc, &writer->codec);
    if (result != RESULT_OK)
        return result;
    size_t bound = recording_codec_bound(writer->codec), state_bytes = writer->header.state_bytes;
    writer->encoded = malloc(bound);
    writer->unwritten = malloc(bound);
    writer->chunk.state = malloc(state_bytes);
    if (!writer->encoded || !writer->unwritten || !writer->chunk.state)
        return RESULT_MEMORY;
    return recording_ring_create(KEPT_CHUNKS * (bound - state_bytes) + KEPT_SEGMENTS * bound, &writer->ring);
}

static Result open_file(RecordingWriter *writer, const char *path) {
    Result result = recording_disk_open(&writer->disk, path);
    if (result != RESULT_OK)
        return result;
    if (!recording_disk_append(&writer->disk, writer->file_header, writer->file_header_bytes)) {
        log_error("%s: byte 0: cannot be written: %s; record to a disk with room", path, strerror(errno));
        return RESULT_IO;
    }
    writer->file_bytes = writer->disk.bytes;
    return RESULT_OK;
}

// Without signals in the thread a limit on the file's size is an error as others, not the program's end (SIGXFSZ).
static Result start_thread(RecordingWriter *writer) {
    sigset_t before;
    pthread_mutex_init(&writer->lock, NULL);
    pthread_cond_init(&writer->changed, NULL);
    writer->lock_lives = true;
    signals_hold_all(&before);
    writer->thread_runs = pthread_create(&writer->thread, NULL, write_until_closed, writer) == 0;
    signals_restore(&before);
    if (!writer->thread_runs)
        log_error("a thread cannot be started; is the limit of processes reached (ulimit -u)?");
    return writer->thread_runs ? RESULT_OK : RESULT_MEMORY;
}

static void destroy(RecordingWriter *writer) {
    if (writer->disk.file >= 0)
        (void)recording_disk_close(&writer->disk);
    if (writer->lock_lives) {
        pthread_cond_destroy(&writer->changed);
        pthread_mutex_destroy(&writer->lock);
    }
    recording_ring_destroy(&writer->ring);
    recording_codec_destroy(&writer->codec);
    free(writer->chunk.state);
    free(writer->unwritten);
    free(writer->encoded);
    free(writer);
}

Result recording_writer_create(const RecordingHeader *header, const char *path, const void *state,
                               RecordingWriter **out) {
    if (header->state_bytes < 1 || header->state_bytes > RECORDING_STATE_BYTES_MAX) {
        log_error("a simulation state of %" PRIu32 " bytes cannot be recorded; 1 to %d can", header->state_bytes,
                  RECORDING_STATE_BYTES_MAX);
        return RESULT_RANGE;
    }
    RecordingWriter *writer = calloc(1, sizeof *writer);
    if (!writer)
        return RESULT_MEMORY;
    writer->header = *header;
    writer->synced_ns = clock_now_ns();
    writer->disk.file = -1;
    writer->hash = RECORDING_HASH_BEGIN;
    Result result = make_memory(writer);
    if (result == RESULT_OK && path)
        result = open_file(writer, path);
    if (result == RESULT_OK)
        begin_chunk(writer, state);
    if (result == RESULT_OK)
        result = start_thread(writer);
    if (result == RESULT_OK)
        *out = writer;
    else
        destroy(writer);
    return result;
}

static Result finish_file(RecordingWriter *writer) {
    uint8_t end[RECORDING_CHUNK_HEADER_BYTES];
    recording_chunk_encode_end(writer->codec, writer->steps, end);
    bool whole = !writer->failing;
    if (whole && !(recording_disk_append(&writer->disk, end, sizeof end) && recording_disk_sync(&writer->disk))) {
        tell_failed(writer, errno);
        whole = false;
    }
    uint64_t missing = writer->lost_steps + (writer->steps - writer->written_steps);
    if (missing > 0)
        log_error("%s: %" PRIu64 " of %" PRIu32 " steps are missing in it", writer->disk.path, missing, writer->steps);
    return whole && missing == 0 ? RESULT_OK : RESULT_IO;
}

Result recording_writer_close(RecordingWriter **writer) {
    RecordingWriter *self = *writer;
    if (!self)
        return RESULT_OK;
    if (self->chunk.count > 0 || self->chunk.event_count > 0)
        end_chunk(self);
    pthread_mutex_lock(&self->lock);
    self->closing = true;
    pthread_cond_broadcast(&self->changed);
    pthread_mutex_unlock(&self->lock);
    pthread_join(self->thread, NULL);
    Result result = self->disk.file >= 0 ? finish_file(self) : RESULT_OK;
    destroy(self);
    *writer = NULL;
    return result;
}
