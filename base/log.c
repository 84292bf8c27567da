#define _POSIX_C_SOURCE 200809L
#include "base/log.h"

#include "base/clock.h"

#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static struct {
    pthread_mutex_t lock;
    LogLevel level;
    LogSink *sink;
    void *user;
    bool line_open; // a progress line without its newline is on the terminal
} state = {.lock = PTHREAD_MUTEX_INITIALIZER, .level = LOG_INFO};

static const struct {
    const char *word, *colour;
} LOOKS[] = {
    [LOG_ERROR] = {"error: ", "\033[31m"},
    [LOG_WARN] = {"warning: ", "\033[33m"},
    [LOG_INFO] = {"", ""},
    [LOG_DEBUG] = {"debug: ", "\033[2m"},
};

void log_set_level(LogLevel level) {
    pthread_mutex_lock(&state.lock);
    state.level = level;
    pthread_mutex_unlock(&state.lock);
}

LogLevel log_level(void) {
    pthread_mutex_lock(&state.lock);
    LogLevel level = state.level;
    pthread_mutex_unlock(&state.lock);
    return level;
}

void log_set_sink(LogSink *sink, void *user) {
    pthread_mutex_lock(&state.lock);
    state.sink = sink;
    state.user = user;
    pthread_mutex_unlock(&state.lock);
}

static bool wants_colour(void) {
    const char *no_color = getenv("NO_COLOR");
    return isatty(STDERR_FILENO) && !(no_color && no_color[0]);
}

static void close_progress_line(void) {
    if (state.line_open) {
        fputc('\n', stderr);
        state.line_open = false;
    }
}

static void emit(LogLevel level, const char *format, va_list arguments) {
    char message[2048];
    vsnprintf(message, sizeof message, format, arguments);
    pthread_mutex_lock(&state.lock);
    if (level <= state.level) {
        if (state.sink) {
            state.sink(state.user, level, message);
        } else {
            bool colour = wants_colour() && LOOKS[level].colour[0];
            close_progress_line();
            fprintf(stderr, "%s%s%s%s\n", colour ? LOOKS[level].colour : "", LOOKS[level].word, colour ? "\033[0m" : "",
                    message);
        }
    }
    pthread_mutex_unlock(&state.lock);
}

#define DEFINE_LOG(name, level)                                                                                        \
    void name(const char *format, ...) {                                                                               \
        va_list arguments;                                                                                             \
        va_start(arguments, format);                                                                                   \
        emit(level, format, arguments);                                                                                \
        va_end(arguments);                                                                                             \
    }
DEFINE_LOG(log_error, LOG_ERROR)
DEFINE_LOG(log_warn, LOG_WARN)
DEFINE_LOG(log_info, LOG_INFO)
DEFINE_LOG(log_debug, LOG_DEBUG)

#define PROGRESS_AFTER_NS 1000000000
#define PROGRESS_EVERY_TERMINAL_NS 100000000
#define PROGRESS_EVERY_FILE_NS 10000000000

Progress progress_begin(const char *what) {
    return (Progress){.what = what, .begin_ns = clock_now_ns()};
}

static void show_progress(const Progress *progress, double share, double seconds, bool last) {
    pthread_mutex_lock(&state.lock);
    if (state.level >= LOG_INFO && !state.sink) {
        bool terminal = isatty(STDERR_FILENO);
        fprintf(stderr, "%s%s %3.0f %%  %.1f s%s", terminal ? "\r" : "", progress->what, share * 100.0, seconds,
                terminal && !last ? "" : "\n");
        fflush(stderr);
        state.line_open = terminal && !last;
    }
    pthread_mutex_unlock(&state.lock);
}

void progress_update(Progress *progress, double share) {
    if (share >= 1.0) // progress_end tells
        return;
    int64_t now = clock_now_ns();
    int64_t every = isatty(STDERR_FILENO) ? PROGRESS_EVERY_TERMINAL_NS : PROGRESS_EVERY_FILE_NS;
    if (now - progress->begin_ns < PROGRESS_AFTER_NS || (progress->shown && now - progress->shown_ns < every))
        return;
    progress->shown = true;
    progress->shown_ns = now;
    show_progress(progress, share, (double)(now - progress->begin_ns) * 1e-9, false);
}

void progress_end(Progress *progress) {
    if (progress->shown)
        show_progress(progress, 1.0, (double)(clock_now_ns() - progress->begin_ns) * 1e-9, true);
}
