#define _POSIX_C_SOURCE 200809L
#include "app/pipeline/picture.h"

#include "assets/image.h"
#include "base/log.h"
#include "config/files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

#define SAME_SECOND_MAX 100

// To be freed; of the caller, also where it fails.
static Result read_picture(Renderer *renderer, int width, int height, uint8_t **rgb) {
    *rgb = malloc((size_t)width * (size_t)height * 3);
    if (*rgb)
        return render_read_pixels(renderer, *rgb);
    log_error("no memory for a picture of %d x %d", width, height);
    return RESULT_MEMORY;
}

Result picture_write(Renderer *renderer, int width, int height, const char *path) {
    uint8_t *rgb;
    Result result = read_picture(renderer, width, height, &rgb);
    if (result == RESULT_OK)
        result = image_write_png(path, width, height, 3, rgb);
    free(rgb);
    return result;
}

Result picture_film(Renderer *renderer, int width, int height, Video *video) {
    uint8_t *rgb;
    Result result = read_picture(renderer, width, height, &rgb);
    if (result == RESULT_OK)
        result = video_add(video, rgb);
    free(rgb);
    return result;
}

Result picture_check_name(const char *path, const char *option) {
    const char *dot = strrchr(path, '.');
    if (dot && strcasecmp(dot, ".png") == 0)
        return files_check_folder_of(path);
    log_error("%s: expected a file name that ends in .png; found '%s'", option, path);
    return RESULT_USAGE;
}

Result picture_new_name(int64_t unix_time_s, char out[PATHS_BYTES_MAX]) {
    char folder[PATHS_BYTES_MAX], when[32];
    time_t seconds = (time_t)unix_time_s;
    struct tm local;
    files_pictures_folder(folder);
    if (!localtime_r(&seconds, &local) || strftime(when, sizeof when, "%Y%m%d-%H%M%S", &local) == 0)
        return RESULT_RANGE;
    for (int i = 0; i < SAME_SECOND_MAX; i++) {
        char suffix[16] = "";
        if (i > 0)
            snprintf(suffix, sizeof suffix, "-%d", i + 1);
        int printed = snprintf(out, PATHS_BYTES_MAX, "%s/overfly-%s%s.png", folder, when, suffix);
        if (printed < 0 || printed >= PATHS_BYTES_MAX)
            return RESULT_RANGE;
        if (!files_exists(out))
            return RESULT_OK;
    }
    return RESULT_RANGE;
}
