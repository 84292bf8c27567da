// tests/heard.h: what the program said, for tests of messages.
// No units.
// A Heard is the test's; it listens from heard_begin to heard_end.
#pragma once
#include "base/log.h"

#include <stdio.h>
#include <string.h>

typedef struct Heard {
    char text[4096]; // all messages since heard_begin, one a line
    int errors, warnings;
} Heard;

static inline void heard_listen(void *user, LogLevel level, const char *message) {
    Heard *heard = user;
    size_t used = strlen(heard->text);
    snprintf(heard->text + used, sizeof heard->text - used, "%s\n", message);
    heard->errors += level == LOG_ERROR;
    heard->warnings += level == LOG_WARN;
}

static inline void heard_begin(Heard *heard) {
    *heard = (Heard){.errors = 0};
    log_set_sink(heard_listen, heard);
}

static inline void heard_end(void) {
    log_set_sink(NULL, NULL);
}
