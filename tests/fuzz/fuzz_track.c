// Fuzz target of the readers of tracks, for libFuzzer: the first byte chooses the format, the others are the file,
// which must be read or refused.
//   cmake --build --preset fuzz && build/fuzz/tests/fuzz_track CORPUS_FOLDER
// The readers take paths, so the bytes go to one file of the process's own, in memory.
#define _GNU_SOURCE
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "app/track/track_format.h"
#include "base/log.h"

static void drop_message(void *user, LogLevel level, const char *message) {
    (void)user, (void)level, (void)message;
}

static const TrackFormat *choose(uint8_t number) {
    int count = 0;
    while (track_formats[count].name)
        count++;
    return &track_formats[number % count];
}

// What was read can be flown and written.
static void use(const Track *track) {
    for (int i = 0; i <= 10; i++) {
        TrackState state = track_state_at(track, track_duration_s(track) * i / 10.0);
        if (!isfinite(state.at.lat_deg) || !isfinite(state.at.heading_deg) || !isfinite(state.bank_deg))
            abort();
    }
    FILE *nowhere = fopen("/dev/null", "w");
    for (const TrackFormat *f = track_formats; f->name && nowhere; f++)
        if (f->write && (!f->wants_start || isfinite(track->start_unix_s)))
            f->write(track, NULL, nowhere);
    if (nowhere)
        fclose(nowhere);
}

static void load(const TrackFormat *format, const char *path) {
    TrackReading how = track_reading_default();
    Track track;
    how.igc_alt = TRACK_IGC_GEOID;
    if (format->read(path, &how, &track) != RESULT_OK)
        return;
    use(&track);
    track_clear(&track);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
    int file = memfd_create("track", 0);
    char path[64];
    log_set_sink(drop_message, NULL);
    if (file < 0)
        return 0;
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    if (count > 0 && write(file, bytes + 1, count - 1) == (ssize_t)(count - 1))
        load(choose(bytes[0]), path);
    close(file);
    return 0;
}
