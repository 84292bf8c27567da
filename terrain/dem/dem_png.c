// PNG (ISO/IEC 15948): 16-bit gray holds metres; 8-bit RGB holds metres as the terrarium tiles encode them.
#include "base/log.h"
#include "terrain/dem/dem_source.h"

#include <stdio.h>
#include <string.h>

#define COLOUR_GRAY 0
#define COLOUR_RGB 2
#define COLOUR_GRAY_ALPHA 4
#define COLOUR_RGB_ALPHA 6

#define INFLATE_RATIO_MAX 1040.0 // DEFLATE cannot pack more tightly

typedef struct PngHeader {
    uint32_t width, height;
    int depth, colour;
    bool transparency; // one colour stands for no data: the pixel reader turns that into an alpha channel
} PngHeader;

static uint32_t big_endian(const uint8_t *bytes) {
    return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

// Whether a chunk tRNS comes before the pixels.
static bool find_transparency(FILE *file) {
    uint8_t chunk[8];
    while (fread(chunk, 1, sizeof chunk, file) == sizeof chunk && memcmp(chunk + 4, "IDAT", 4) != 0) {
        if (memcmp(chunk + 4, "tRNS", 4) == 0)
            return true;
        uint32_t length = big_endian(chunk);
        if (length > INT32_MAX || fseek(file, (long)length + 4, SEEK_CUR))
            return false;
    }
    return false;
}

static Result read_header(const char *path, PngHeader *out) {
    uint8_t head[33]; // signature 8, length 4, "IHDR", 13 bytes, checksum 4
    FILE *file = fopen(path, "rb");
    bool whole = file && fread(head, 1, sizeof head, file) == sizeof head && memcmp(head + 12, "IHDR", 4) == 0;
    if (whole)
        *out = (PngHeader){.width = big_endian(head + 16),
                           .height = big_endian(head + 20),
                           .depth = head[24],
                           .colour = head[25],
                           .transparency = find_transparency(file)};
    if (file)
        fclose(file);
    if (whole)
        return RESULT_OK;
    log_error("%s: a truncated or damaged PNG: no header; fetch it again", path);
    return RESULT_FORMAT;
}

static Result check_promise(const char *path, const PngHeader *png, int64_t bytes) {
    static const int CHANNELS[] = {1, 0, 3, 0, 2, 0, 4};
    double promised = (double)png->width * png->height * CHANNELS[png->colour] * png->depth / 8.0;
    if (png->width >= 1 && png->height >= 1 && png->width <= DEM_SIDE_MAX && png->height <= DEM_SIDE_MAX &&
        promised <= (double)bytes * INFLATE_RATIO_MAX)
        return RESULT_OK;
    log_error(
        "%s: its header promises %u x %u samples, more than its %lld bytes can hold, or more than %d a side; fetch it "
        "again",
        path, png->width, png->height, (long long)bytes, DEM_SIDE_MAX);
    return RESULT_FORMAT;
}

static Result set_coding(const char *path, const PngHeader *png, DemSource *out) {
    bool gray = png->colour == COLOUR_GRAY || png->colour == COLOUR_GRAY_ALPHA;
    bool rgb = png->colour == COLOUR_RGB || png->colour == COLOUR_RGB_ALPHA;
    bool alpha = png->colour == COLOUR_GRAY_ALPHA || png->colour == COLOUR_RGB_ALPHA || png->transparency;
    if (!(gray && png->depth == 16) && !(rgb && png->depth == 8)) {
        log_error(
            "%s: %d bits of PNG colour type %d; elevation is read from 16-bit gray (metres) or 8-bit RGB (terrarium); "
            "export it as 16-bit gray, or drape a picture with --image",
            path, png->depth, png->colour);
        return RESULT_FORMAT;
    }
    out->coding = (DemCoding){.type = gray ? IMAGE_UINT16 : IMAGE_UINT8,
                              .channels = (gray ? 1 : 3) + (alpha ? 1 : 0),
                              .alpha = alpha,
                              .terrarium = rgb,
                              .scale_m = 1.0};
    snprintf(out->header.type, sizeof out->header.type, "%s", gray ? "uint16" : "rgb8");
    return RESULT_OK;
}

static Result read_png(const DemSource *source, const DemTarget *target) {
    return dem_raster_read(source, "png", target);
}

Result dem_png_open(const DemOptions *options, const char *path, int64_t bytes, DemSource *out) {
    PngHeader png;
    Result result = read_header(path, &png);
    if (result == RESULT_OK)
        result = set_coding(path, &png, out);
    if (result == RESULT_OK)
        result = check_promise(path, &png, bytes);
    if (result != RESULT_OK)
        return result;
    out->header.width = (int)png.width;
    out->header.height = (int)png.height;
    out->header.datum = DEM_DATUM_EGM96;
    out->header.datum_assumed = true;
    out->read = read_png;
    return out->header.width < 2 || out->header.height < 2 ? RESULT_OK // refused by size, with a better message
                                                           : dem_source_place(options, path, &out->header);
}
