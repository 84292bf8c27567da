#define _GNU_SOURCE
#include "assets/image.h"

#include "assets/image_module.h"
#include "base/log.h"
#include "base/paths.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct ImageFile {
    const ImageModule *module;
    ImageReader *reader;
    ImageSpec spec;
    char path[];
};

static const struct {
    const char *name;
    size_t bytes;
} TYPES[] = {
    [IMAGE_OTHER] = {"unsupported", 0}, [IMAGE_UINT8] = {"uint8", 1},     [IMAGE_INT8] = {"int8", 1},
    [IMAGE_UINT16] = {"uint16", 2},     [IMAGE_INT16] = {"int16", 2},     [IMAGE_UINT32] = {"uint32", 4},
    [IMAGE_INT32] = {"int32", 4},       [IMAGE_FLOAT32] = {"float32", 4},
};

const char *image_type_name(ImageType type) {
    return TYPES[type].name;
}

size_t image_type_bytes(ImageType type) {
    return TYPES[type].bytes;
}

// ---- The module -------------------------------------------------------------------------------------------------

static ImageModuleEntry *find_entry(const char *path) {
    // Never unloaded: its libraries register destructors and thread pools that don't survive that. So only the first
    // image waits for them.
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (!library)
        return NULL;
    ImageModuleEntry *entry = NULL;
    void *symbol = dlsym(library, IMAGE_MODULE_ENTRY);
    memcpy(&entry, &symbol, sizeof entry); // ISO C has no cast from dlsym's object pointer to a function
    dlclose(library);
    return entry;
}

static Result load_module(const ImageModule **out) {
    char path[PATHS_BYTES_MAX];
    Result result = paths_find_module(IMAGE_MODULE_FILE, path);
    if (result != RESULT_OK)
        return RESULT_DEVICE;
    ImageModuleEntry *entry = find_entry(path);
    const ImageModule *module = entry ? entry() : NULL;
    if (!module || module->version != IMAGE_MODULE_VERSION) {
        const char *reason = module ? "it is of another version" : dlerror();
        log_error("%s: images cannot be read: %s; install overfly again", path, reason ? reason : "no entry point");
        return RESULT_DEVICE;
    }
    *out = module;
    return RESULT_OK;
}

// ---- Files ------------------------------------------------------------------------------------------------------

static Result check_readable(const char *path, int64_t *bytes) {
    struct stat status;
    if (stat(path, &status) || (S_ISREG(status.st_mode) && access(path, R_OK))) {
        int cause = errno;
        log_error("%s: %s; %s", path, strerror(cause), cause == EACCES ? "make it readable" : "check the path");
        return cause == ENOENT || cause == ENOTDIR ? RESULT_NOT_FOUND : RESULT_IO;
    }
    if (!S_ISREG(status.st_mode)) {
        log_error("%s: not a file; give the path of an image", path);
        return RESULT_FORMAT;
    }
    *bytes = status.st_size;
    return RESULT_OK;
}

Result image_open(const char *path, const char *format, ImageFile **out) {
    const ImageModule *module;
    int64_t bytes;
    Result result = check_readable(path, &bytes);
    if (result == RESULT_OK)
        result = load_module(&module);
    if (result != RESULT_OK)
        return result;
    ImageFile *file = calloc(1, sizeof *file + strlen(path) + 1);
    if (!file) {
        log_error("%s: out of memory", path);
        return RESULT_MEMORY;
    }
    ImageError error;
    file->module = module;
    strcpy(file->path, path);
    result = module->open(path, format, &file->reader, &file->spec, &error);
    if (result != RESULT_OK) {
        log_error("%s: cannot be opened as %s: %s; %s", path, format ? format : "an image", error.text,
                  format ? "fetch or export it again" : "give a PNG, a JPEG or a GeoTIFF, or fetch it again");
        free(file);
        return result;
    }
    *out = file;
    return RESULT_OK;
}

void image_close(ImageFile **file) {
    if (!*file)
        return;
    (*file)->module->close((*file)->reader);
    free(*file);
    *file = NULL;
}

const ImageSpec *image_spec(const ImageFile *file) {
    return &file->spec;
}

static Result read_block(ImageFile *file, int row_begin, int row_end, int channels, bool as_uint8, void *out) {
    ImageError error;
    Result result = file->module->read_rows(file->reader, row_begin, row_end, channels, as_uint8, out, &error);
    if (result != RESULT_OK)
        log_error("%s: rows %d to %d cannot be read: %s; the file is truncated or damaged: fetch it again", file->path,
                  row_begin, row_end - 1, error.text);
    return result;
}

Result image_read_rows(ImageFile *file, int row_begin, int row_end, int channels, void *out) {
    return read_block(file, row_begin, row_end, channels, false, out);
}

// ---- Pictures ---------------------------------------------------------------------------------------------------

// No common picture format packs pixels more tightly than this, flat ones included.
#define PICTURE_PIXELS_PER_BYTE 4096

static Result check_picture(const char *path, const ImageSpec *spec, int64_t file_bytes, int side_max) {
    if (spec->width > side_max || spec->height > side_max) {
        log_error("%s: %d x %d pixels; at most %d a side can be used; reduce it: gdal_translate -outsize %d 0", path,
                  spec->width, spec->height, side_max, side_max);
        return RESULT_RANGE;
    }
    if ((int64_t)spec->width * spec->height > file_bytes * PICTURE_PIXELS_PER_BYTE) {
        log_error("%s: its header promises %d x %d pixels, more than its %lld bytes can hold; fetch it again", path,
                  spec->width, spec->height, (long long)file_bytes);
        return RESULT_FORMAT;
    }
    return RESULT_OK;
}

static void spread_to_rgba(const uint8_t *in, int channels, size_t count, uint8_t *rgba) {
    bool gray = channels < 3;
    for (size_t i = 0; i < count; i++, in += channels, rgba += 4) {
        rgba[0] = in[0];
        rgba[1] = in[gray ? 0 : 1];
        rgba[2] = in[gray ? 0 : 2];
        rgba[3] = channels == 2 ? in[1] : channels == 4 ? in[3] : 255;
    }
}

static Result read_picture_rows(ImageFile *file, uint8_t *rgba) {
    const ImageSpec *spec = &file->spec;
    int channels = spec->channels < 4 ? spec->channels : 4;
    size_t width = (size_t)spec->width;
    uint8_t *block = malloc((size_t)spec->block_rows * width * (size_t)channels);
    Result result = block ? RESULT_OK : RESULT_MEMORY;
    for (int row = 0; row < spec->height && result == RESULT_OK; row += spec->block_rows) {
        int end = row + spec->block_rows < spec->height ? row + spec->block_rows : spec->height;
        result = read_block(file, row, end, channels, true, block);
        if (result == RESULT_OK)
            spread_to_rgba(block, channels, (size_t)(end - row) * width, rgba + (size_t)row * width * 4);
    }
    free(block);
    return result;
}

Result image_read_picture(const char *path, int side_max, ImagePicture *out) {
    int64_t bytes = 0;
    ImageFile *file = NULL;
    ImagePicture picture = {0};
    Result result = check_readable(path, &bytes);
    if (result == RESULT_OK)
        result = image_open(path, NULL, &file);
    if (result == RESULT_OK)
        result = check_picture(path, &file->spec, bytes, side_max);
    if (result != RESULT_OK)
        goto done;
    picture = (ImagePicture){.width = file->spec.width, .height = file->spec.height};
    picture.rgba = malloc((size_t)picture.width * (size_t)picture.height * 4);
    result = picture.rgba ? read_picture_rows(file, picture.rgba) : RESULT_MEMORY;
    if (result == RESULT_MEMORY)
        log_error("%s: no memory for %d x %d pixels; reduce it with gdal_translate -outsize", path, picture.width,
                  picture.height);
    if (result == RESULT_OK)
        *out = picture;
    else
        free(picture.rgba);
done:
    image_close(&file);
    return result;
}

Result image_write_png(const char *path, int width, int height, int channels, const uint8_t *pixels) {
    const ImageModule *module;
    Result result = load_module(&module);
    if (result != RESULT_OK)
        return result;
    ImageError error;
    result = module->write_png(path, width, height, channels, pixels, &error);
    if (result != RESULT_OK) {
        log_error("%s: cannot be written: %s; is the folder there, writable, and not full?", path, error.text);
        remove(path);
    }
    return result;
}
