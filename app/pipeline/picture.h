// app/pipeline/picture.h: finished frames as PNG files, and as those of a film.
// Pixels.
// Owns nothing. The thread that has the context current.
#pragma once
#include "app/pipeline/video.h"
#include "base/base.h"
#include "base/paths.h"
#include "render/render.h"

// The picture that the renderer finished last. IO names the file.
MUST_USE Result picture_write(Renderer *renderer, int width, int height, const char *path);
// The same, to a film of that size.
MUST_USE Result picture_film(Renderer *renderer, int width, int height, Video *video);
// Whether a picture can be written there, before one is made: USAGE, logged, unless the name ends in .png; errors of
// files_check_folder_of. `option` is named in the message.
MUST_USE Result picture_check_name(const char *path, const char *option);
// A name that is not taken, from the time, in the folder for pictures: "overfly-20260131-235959.png". RANGE: too long.
MUST_USE Result picture_new_name(int64_t unix_time_s, char out[PATHS_BYTES_MAX]);
