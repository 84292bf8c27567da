#include "terrain/dem/dem_source.h"

#include "base/log.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define VOID_SRTM -32768.0 // even where the file does not declare it

// Far beyond any height, far within a float: the caller refuses it, and nothing overflows on the way.
#define ABSURD 1e15

static inline float metres(const DemCoding *coding, double value) {
    double clamped = value > ABSURD ? ABSURD : value < -ABSURD ? -ABSURD : value;
    return (float)(clamped * coding->scale_m + coding->offset_m);
}

// One loop per stored type: the compiler keeps the conversion out of the loop's way.
#define DEFINE_DECODE(name, Type)                                                                                      \
    static void name(const DemCoding *coding, const Type *stored, int count, float *height_m) {                        \
        double nodata = coding->has_nodata ? coding->nodata : VOID_SRTM;                                               \
        for (int i = 0; i < count; i++, stored += coding->channels) {                                                  \
            double value = (double)stored[0];                                                                          \
            bool data =                                                                                                \
                value != nodata && value != VOID_SRTM && isfinite(value) && !(coding->alpha && stored[1] == 0);        \
            height_m[i] = data ? metres(coding, value) : NAN;                                                          \
        }                                                                                                              \
    }
DEFINE_DECODE(decode_uint8, uint8_t)
DEFINE_DECODE(decode_int8, int8_t)
DEFINE_DECODE(decode_uint16, uint16_t)
DEFINE_DECODE(decode_int16, int16_t)
DEFINE_DECODE(decode_uint32, uint32_t)
DEFINE_DECODE(decode_int32, int32_t)
DEFINE_DECODE(decode_float32, float)

// Red 256 m, green 1 m, blue 1/256 m, from 32768 m below; transparent is no data.
static void decode_terrarium(const DemCoding *coding, const uint8_t *stored, int count, float *height_m) {
    for (int i = 0; i < count; i++, stored += coding->channels) {
        double value = stored[0] * 256.0 + stored[1] + stored[2] / 256.0 - 32768.0;
        bool data = value != VOID_SRTM && !(coding->alpha && stored[3] == 0);
        height_m[i] = data ? (float)value : NAN;
    }
}

void dem_coding_decode(const DemCoding *coding, const void *stored, int count, float *height_m) {
    if (coding->terrarium) {
        decode_terrarium(coding, stored, count, height_m);
        return;
    }
    switch (coding->type) {
#define DECODE(TYPE, name)                                                                                             \
    case IMAGE_##TYPE:                                                                                                 \
        decode_##name(coding, stored, count, height_m);                                                                \
        return;
        DECODE(UINT8, uint8)
        DECODE(INT8, int8)
        DECODE(UINT16, uint16)
        DECODE(INT16, int16)
        DECODE(UINT32, uint32)
        DECODE(INT32, int32)
        DECODE(FLOAT32, float32)
#undef DECODE
    case IMAGE_OTHER:
        break;
    }
    for (int i = 0; i < count; i++)
        height_m[i] = NAN;
}

// What the pixel reader found must be what the header's reader promised: memory was sized by the latter.
static Result check_spec(const DemSource *source, const ImageSpec *spec) {
    const DemHeader *header = &source->header;
    if (spec->width == header->width && spec->height == header->height && spec->channels >= source->coding.channels &&
        spec->type == source->coding.type && spec->block_rows >= 1 && spec->block_rows <= DEM_SIDE_MAX)
        return RESULT_OK;
    log_error("%s: the header promises %d x %d samples of %s, the pixels are %d x %d of %s in %d bands; rewrite it: "
              "gdal_translate -b 1 %s OUT.tif",
              source->path, header->width, header->height, image_type_name(source->coding.type), spec->width,
              spec->height, image_type_name(spec->type), spec->channels, source->path);
    return RESULT_FORMAT;
}

typedef struct Block {
    void *stored;
    float *row_m;
    size_t row_bytes;
} Block;

static Result put_block(const DemSource *source, const Block *block, int row_begin, int row_end,
                        const DemTarget *target) {
    Result result = RESULT_OK;
    for (int row = row_begin; row < row_end && result == RESULT_OK; row++) {
        const char *stored = (const char *)block->stored + (size_t)(row - row_begin) * block->row_bytes;
        dem_coding_decode(&source->coding, stored, source->header.width, block->row_m);
        result = dem_source_put_row(source, target, row, block->row_m);
    }
    return result;
}

static Result read_blocks(const DemSource *source, ImageFile *file, const Block *block, const DemTarget *target) {
    int height = source->header.height, step = image_spec(file)->block_rows;
    Progress progress = progress_begin("reading elevation");
    Result result = RESULT_OK;
    for (int row = 0; row < height && result == RESULT_OK; row += step) {
        int end = step < height - row ? row + step : height;
        result = image_read_rows(file, row, end, source->coding.channels, block->stored);
        if (result == RESULT_OK)
            result = put_block(source, block, row, end, target);
        progress_update(&progress, (double)end / height);
    }
    progress_end(&progress);
    return result;
}

Result dem_raster_read(const DemSource *source, const char *format, const DemTarget *target) {
    Block block = {0};
    ImageFile *file = NULL;
    Result result = image_open(source->path, format, &file);
    if (result == RESULT_OK)
        result = check_spec(source, image_spec(file));
    if (result != RESULT_OK)
        goto done;
    const ImageSpec *spec = image_spec(file);
    size_t width = (size_t)spec->width,
           rows = (size_t)(spec->block_rows < spec->height ? spec->block_rows : spec->height);
    block.row_bytes = width * (size_t)source->coding.channels * image_type_bytes(spec->type);
    block.stored = malloc(rows * block.row_bytes);
    block.row_m = malloc(width * sizeof *block.row_m);
    if (block.stored && block.row_m) {
        result = read_blocks(source, file, &block, target);
    } else {
        log_error(
            "%s: no memory to read %zu rows of %zu samples; rewrite it in smaller tiles: gdal_translate -co TILED=YES "
            "%s OUT.tif",
            source->path, rows, width, source->path);
        result = RESULT_MEMORY;
    }
done:
    free(block.row_m);
    free(block.stored);
    image_close(&file);
    return result;
}
