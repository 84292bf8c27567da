// app/pipeline/video.h: a film of finished frames, made by a process of ffmpeg that they are piped to, uncompressed.
// Pixels; frames a second.
// A Video owns the process. One thread adds; another may end it after that.
#pragma once
#include "base/base.h"

typedef struct VideoOptions {
    const char *path; // its ending tells the container
    int width, height;
    int fps; // frame i is shown at i / fps seconds, exactly
} VideoOptions;

typedef struct Video Video;

// USAGE, logged, unless the name has an ending that films have. `option` is named in the message.
MUST_USE Result video_check_name(const char *path, const char *option);
// Warns of an odd side. NOT_FOUND: there is no ffmpeg on the PATH; IO: it cannot be started.
MUST_USE Result video_create(const VideoOptions *options, Video **out);
// width * height * 3 bytes, RGB, top row first. An odd last column or row is left out: yuv420p has none. IO: ffmpeg has
// gone, and its own words are in the log by video_end.
MUST_USE Result video_add(Video *video, const uint8_t *rgb);
// Lets ffmpeg finish the file, which then has its name; NULL is let be. IO: it failed, and why; no file is left of it.
MUST_USE Result video_end(Video **video);
