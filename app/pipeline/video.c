#define _GNU_SOURCE // pipe2
#include "app/pipeline/video.h"

#include "base/log.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define WORDS_BYTES 600 // of ffmpeg's complaint, that are told

extern char **environ;

struct Video {
    VideoOptions options;
    char path[4096];
    char part[4096 + 32]; // what ffmpeg writes, renamed when it is whole; beside the path, or it
    pid_t process;
    int frames_to, words_from; // pipes: its input, its complaints
};

static const char *const endings[] = {".mp4", ".mkv", ".webm", ".mov"};

Result video_check_name(const char *path, const char *option) {
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < COUNT_OF(endings); i++)
        if (strcasecmp(dot, endings[i]) == 0)
            return RESULT_OK;
    log_error("%s: expected a file name that ends in .mp4, .mkv, .webm or .mov; found '%s'", option, path);
    return RESULT_USAGE;
}

static void close_end(int *end) {
    if (*end >= 0)
        close(*end);
    *end = -1;
}

// Its ends are those of the child; a group of its own, so that a Ctrl-C here lets it finish the file.
static int spawn_ffmpeg(Video *video, char *const arguments[], int frames_from, int words_to) {
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    sigset_t none;
    sigemptyset(&none);
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, frames_from, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&files, words_to, STDERR_FILENO);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
    posix_spawnattr_setsigmask(&attributes, &none);
    int error = posix_spawnp(&video->process, "ffmpeg", &files, &attributes, arguments, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    return error;
}

static int start_ffmpeg(Video *video, int frames_from, int words_to) {
    char size[32], rate[16], path[sizeof video->part + 8];
    snprintf(size, sizeof size, "%dx%d", video->options.width, video->options.height);
    snprintf(rate, sizeof rate, "%d", video->options.fps);
    snprintf(path, sizeof path, "file:%s", video->part); // a name with a colon is no protocol
    char *const arguments[] = {"ffmpeg",
                               "-hide_banner",
                               "-loglevel",
                               "error",
                               "-nostdin",
                               "-y",
                               "-f",
                               "rawvideo",
                               "-pixel_format",
                               "rgb24",
                               "-video_size",
                               size,
                               "-framerate",
                               rate,
                               "-i",
                               "pipe:0",
                               "-vf",
                               "crop=trunc(iw/2)*2:trunc(ih/2)*2,format=yuv420p",
                               path,
                               NULL};
    return spawn_ffmpeg(video, arguments, frames_from, words_to);
}

static Result start(Video *video) {
    int frames[2] = {-1, -1}, words[2] = {-1, -1};
    int error = pipe2(frames, O_CLOEXEC) != 0 || pipe2(words, O_CLOEXEC) != 0 ? errno : 0;
    if (error == 0)
        error = start_ffmpeg(video, frames[0], words[1]);
    close_end(&frames[0]);
    close_end(&words[1]);
    video->frames_to = frames[1];
    video->words_from = words[0];
    if (error == 0)
        return RESULT_OK;
    video->process = 0;
    if (error == ENOENT)
        log_error("%s: films are made by ffmpeg, which is not on the PATH; install the package ffmpeg", video->path);
    else
        log_error("%s: ffmpeg cannot be started: %s", video->path, strerror(error));
    return error == ENOENT ? RESULT_NOT_FOUND : RESULT_IO;
}

static void free_video(Video **video) {
    close_end(&(*video)->frames_to);
    close_end(&(*video)->words_from);
    free(*video);
    *video = NULL;
}

// With the same ending, by which ffmpeg knows the container. What is no regular file is written in place.
static void name_part(Video *video) {
    struct stat about;
    const char *dot = strrchr(video->path, '.');
    int length = dot ? (int)(dot - video->path) : (int)strlen(video->path);
    if (stat(video->path, &about) == 0 && !S_ISREG(about.st_mode))
        snprintf(video->part, sizeof video->part, "%s", video->path);
    else
        snprintf(video->part, sizeof video->part, "%.*s.part-%ld%s", length, video->path, (long)getpid(),
                 dot ? dot : "");
}

static void warn_of_odd_size(const VideoOptions *options) {
    int width = options->width & ~1, height = options->height & ~1;
    if (width != options->width || height != options->height)
        log_warn("%s: a film has even sides: of %dx%d the last column or row is left out, %dx%d are kept; take an even "
                 "--size to have all of it",
                 options->path, options->width, options->height, width, height);
}

Result video_create(const VideoOptions *options, Video **out) {
    Video *video = calloc(1, sizeof *video);
    if (!video) {
        log_error("%s: no memory for a film", options->path);
        return RESULT_MEMORY;
    }
    video->options = *options;
    video->frames_to = video->words_from = -1;
    int length = snprintf(video->path, sizeof video->path, "%s", options->path);
    name_part(video);
    Result result = length < (int)sizeof video->path ? start(video) : RESULT_RANGE;
    if (result == RESULT_OK)
        warn_of_odd_size(options);
    if (result == RESULT_OK)
        *out = video;
    else
        free_video(&video);
    return result;
}

// A pipe whose reader has gone raises SIGPIPE in the thread that writes: it is held back, and taken.
static ssize_t write_quietly(int to, const uint8_t *bytes, size_t count) {
    const struct timespec now = {0};
    sigset_t pipe_signal, before;
    sigemptyset(&pipe_signal);
    sigaddset(&pipe_signal, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipe_signal, &before);
    ssize_t written = write(to, bytes, count);
    int error = errno;
    if (written < (ssize_t)count) // also where a part was taken before the reader went
        while (sigtimedwait(&pipe_signal, NULL, &now) < 0 && errno == EINTR) {
        }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    errno = error;
    return written;
}

Result video_add(Video *video, const uint8_t *rgb) {
    size_t left = (size_t)video->options.width * (size_t)video->options.height * 3;
    while (left > 0) {
        ssize_t written = write_quietly(video->frames_to, rgb, left);
        if (written < 0 && errno == EINTR)
            continue;
        if (written < 0) {
            log_error("%s: a frame cannot be handed to ffmpeg: %s", video->path, strerror(errno));
            return RESULT_IO;
        }
        rgb += written;
        left -= (size_t)written;
    }
    return RESULT_OK;
}

// The first of what it says, on one line; the rest is read and let go, so that it can end.
static void hear_words(Video *video, char words[WORDS_BYTES]) {
    char more[512];
    size_t count = 0;
    for (ssize_t got; (got = read(video->words_from, more, sizeof more)) != 0 && (got > 0 || errno == EINTR);)
        for (ssize_t i = 0; i < got; i++)
            if (count + 1 < WORDS_BYTES)
                words[count++] = more[i] == '\n' ? ' ' : more[i];
    words[count] = '\0';
}

// Without its end most of a film cannot be played; one that was there before stays.
static Result give_up(const Video *video, int status, const char *words) {
    if (WIFSIGNALED(status))
        log_error("%s: ffmpeg was ended by signal %d (%s): no film is written; make it again%s%s", video->path,
                  WTERMSIG(status), strsignal(WTERMSIG(status)), words[0] ? "; it said: " : "", words);
    else
        log_error("%s: ffmpeg has failed, no film is written: %s", video->path,
                  words[0] ? words : "it does not say why");
    if (strcmp(video->part, video->path) != 0)
        unlink(video->part);
    return RESULT_IO;
}

static Result keep_film(const Video *video) {
    if (strcmp(video->part, video->path) == 0 || rename(video->part, video->path) == 0)
        return RESULT_OK;
    log_error("%s: the film cannot be named so: %s; it is there as %s", video->path, strerror(errno), video->part);
    return RESULT_IO;
}

static Result finish(Video *video) {
    char words[WORDS_BYTES];
    int status = 0;
    close_end(&video->frames_to); // the end of the film
    hear_words(video, words);
    while (waitpid(video->process, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? keep_film(video) : give_up(video, status, words);
}

Result video_end(Video **video) {
    if (!*video)
        return RESULT_OK;
    Result result = finish(*video);
    free_video(video);
    return result;
}
