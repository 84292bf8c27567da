// Fuzz target of the elevation readers, for libFuzzer: the bytes become a file, which must be read or refused.
//   cmake --build --preset fuzz && build/fuzz/tests/fuzz_dem CORPUS_FOLDER
// The readers take paths, so the bytes go to one file of the process's own, in shared memory where there is any.
#define _GNU_SOURCE
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/log.h"
#include "terrain/dem/dem.h"

static void drop_message(void *user, LogLevel level, const char *message) {
    (void)user, (void)level, (void)message;
}

// What the reader would be chosen by: contents, except for raw samples.
static void load(const char *path) {
    DemOptions options = dem_default_options();
    Dem *dem = NULL;
    options.spacing_m = 30.0;
    if (dem_load(&options, &path, 1, &dem) == RESULT_OK)
        dem_destroy(&dem);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
    int file = memfd_create("dem", 0);
    char path[64];
    log_set_sink(drop_message, NULL);
    if (file < 0)
        return 0;
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    if (write(file, bytes, count) == (ssize_t)count)
        load(path);
    close(file);
    return 0;
}
