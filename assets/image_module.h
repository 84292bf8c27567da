// assets/image_module.h: what the image module (image_oiio.cpp) offers its loader (image.c). Private to the two.
// As assets/image.h.
// Errors come back as text in a buffer of the caller's, because the module must not hold a log of its own.
#pragma once
#include "assets/image.h"

#ifdef __cplusplus
extern "C" {
#endif

#define IMAGE_MODULE_VERSION 1
#define IMAGE_MODULE_FILE "overfly_image.so"
#define IMAGE_MODULE_ENTRY "overfly_image_module"

typedef struct ImageError {
    char text[512];
} ImageError;

typedef struct ImageReader ImageReader;

typedef struct ImageModule {
    int version;
    Result (*open)(const char *path, const char *format, ImageReader **out, ImageSpec *spec, ImageError *error);
    Result (*read_rows)(ImageReader *reader, int row_begin, int row_end, int channels, bool as_uint8, void *out,
                        ImageError *error);
    void (*close)(ImageReader *reader);
    Result (*write_png)(const char *path, int width, int height, int channels, const uint8_t *pixels,
                        ImageError *error);
} ImageModule;

typedef const ImageModule *ImageModuleEntry(void);

#ifdef __cplusplus
}
#endif
