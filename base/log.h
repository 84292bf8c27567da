// base/log.h: messages for people, on stderr, and a progress line for what takes long.
// Seconds where times occur.
// The log sink is the program's only writable global. Any thread may log.
#pragma once
#include "base/base.h"

#ifdef __cplusplus
extern "C" {
#endif

// Levels are defined by consequence: ERROR, something asked for was not done; WARN, it was done, but
// the result may surprise; INFO, worth knowing once; DEBUG, for the developer.
typedef enum LogLevel { LOG_ERROR, LOG_WARN, LOG_INFO, LOG_DEBUG } LogLevel;

// Messages above `level` are dropped. The default is LOG_INFO.
void log_set_level(LogLevel level);
LogLevel log_level(void);

// Instead of stderr: `sink` gets every kept message, without a newline; NULL restores stderr.
typedef void LogSink(void *user, LogLevel level, const char *message);
void log_set_sink(LogSink *sink, void *user);

void log_error(const char *format, ...) PRINTF_LIKE(1, 2);
void log_warn(const char *format, ...) PRINTF_LIKE(1, 2);
void log_info(const char *format, ...) PRINTF_LIKE(1, 2);
void log_debug(const char *format, ...) PRINTF_LIKE(1, 2);

// A line such as "error field  42 %" that appears on stderr once the work has lasted a second, is drawn
// again in place on a terminal, and is written once per 10 s elsewhere. Used by one thread.
typedef struct Progress {
    const char *what; // borrowed
    int64_t begin_ns;
    int64_t shown_ns;
    bool shown;
} Progress;
Progress progress_begin(const char *what);
void progress_update(Progress *progress, double share); // share in 0..1
void progress_end(Progress *progress);

#ifdef __cplusplus
}
#endif
