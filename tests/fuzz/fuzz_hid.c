// Fuzz target of the HID report descriptor parser and the decoding of reports, for libFuzzer.
//   cmake --build --preset fuzz && build/fuzz/tests/fuzz_hid CORPUS_FOLDER
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/log.h"
#include "tests/hid_support.h"

static void drop_message(void *user, LogLevel level, const char *message) {
    (void)user, (void)level, (void)message;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
    log_set_sink(drop_message, NULL);
    const char *broken = hid_exercise(bytes, count, count);
    if (broken) {
        fprintf(stderr, "%s\n", broken);
        abort();
    }
    return 0;
}
