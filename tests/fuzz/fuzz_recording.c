// Fuzz target of the reader of recorded flights and their replay, for libFuzzer.
//   cmake --build --preset fuzz && build/fuzz/tests/fuzz_recording CORPUS_FOLDER
// The first byte chooses: the bytes are a file whose outer checksums are made right, or the contents of its chunks.
#define _GNU_SOURCE
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "app/recording/recording_player.h"
#include "base/log.h"
#include "tests/recording_wrap.h"

#define STATE_BYTES 24
#define CHUNK_CONTENT 200
#define FILE_BYTES (1 << 18)

static void drop_message(void *user, LogLevel level, const char *message) {
    (void)user, (void)level, (void)message;
}

// A simulation for states of any size: their first byte is summed up.
static bool load(void *user, const void *state) {
    memcpy(user, state, 1);
    return true;
}
static void save(void *user, void *state) {
    memcpy(state, user, 1);
}
static void step(void *user, const Controls *controls) {
    *(uint8_t *)user = (uint8_t)(*(uint8_t *)user + (controls->elevator > 0.0));
}
static uint64_t hash(void *user) {
    return *(uint8_t *)user;
}
static void event(void *user, const RecordingEvent *happened) {
    for (int i = 0; i < happened->bytes; i++)
        *(uint8_t *)user ^= happened->data[i];
}

static void replay(RecordingReader *reader) {
    uint8_t state = 0;
    const RecordingHeader *header = recording_reader_header(reader);
    RecordingSim sim = {&state, header->state_bytes, header->state_layout, load, save, step, hash, event};
    RecordingVerdict verdict;
    RecordingPlayer *player;
    if (recording_verify(reader, &sim, &verdict) != RESULT_OK)
        abort(); // what opens can be flown
    uint32_t first = recording_reader_first(reader), end = recording_reader_end(reader);
    if (verdict.steps + verdict.steps_missing != end - first)
        abort();
    if (recording_player_create(reader, &sim, &player) != RESULT_OK)
        return;
    for (int i = 8; i >= 0; i--)
        if (recording_player_seek(player, first + (int64_t)(end - first) * i / 8) != RESULT_OK)
            abort();
    recording_player_destroy(&player);
}

static void open_and_replay(const uint8_t *bytes, size_t count) {
    char path[64];
    int file = memfd_create("recording", 0);
    RecordingReader *reader;
    if (file < 0)
        return;
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    if (write(file, bytes, count) == (ssize_t)count && recording_reader_open(path, &reader) == RESULT_OK) {
        replay(reader);
        recording_reader_close(&reader);
    }
    close(file);
}

// Each chunk: flags, steps, a step up or down, then its contents.
static size_t wrap_contents(const uint8_t *bytes, size_t count, uint8_t *out) {
    RecordingHeader header = recording_header_create(STATE_BYTES, 1);
    RecordingZstd *zstd;
    uint32_t crc, first = 0;
    size_t used = recording_header_encode(&header, out, &crc);
    if (recording_zstd_create(CHUNK_CONTENT, &zstd) != RESULT_OK)
        return 0;
    while (count > 3 && used + 2048 < FILE_BYTES) {
        RecordingChunkHeader chunk = {1, bytes[0] & 3, bytes[1], first, 0};
        size_t length = count - 3 < CHUNK_CONTENT ? count - 3 : CHUNK_CONTENT;
        used += wrap_chunk(zstd, crc, chunk, bytes + 3, length, out + used, FILE_BYTES - used);
        first += (uint32_t)(bytes[1] + (int8_t)bytes[2] / 64);
        bytes += 3 + length;
        count -= 3 + length;
    }
    recording_zstd_destroy(&zstd);
    return used;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
    uint8_t *file = malloc(FILE_BYTES);
    log_set_sink(drop_message, NULL);
    if (!file || count < 1 || count > FILE_BYTES)
        goto done;
    if (bytes[0] & 1) {
        open_and_replay(file, wrap_contents(bytes + 1, count - 1, file));
    } else {
        memcpy(file, bytes + 1, count - 1);
        wrap_correct(file, count - 1);
        open_and_replay(file, count - 1);
    }
done:
    free(file);
    return 0;
}
