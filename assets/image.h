// assets/image.h: pixels in and out of image files, through OpenImageIO in a module that is loaded on first use.
// Samples in the file's own type and scale; rows from the top; nothing is premultiplied, gamma-corrected or rotated.
// An ImageFile is owned by whoever opened it; one thread at a time may use it, several threads may have one each.
#pragma once
#include "base/base.h"

#define IMAGE_SIDE_MAX (1 << 20) // pixels

typedef enum ImageType {
    IMAGE_OTHER, // half floats, anything of 64 bits
    IMAGE_UINT8,
    IMAGE_INT8,
    IMAGE_UINT16,
    IMAGE_INT16,
    IMAGE_UINT32,
    IMAGE_INT32,
    IMAGE_FLOAT32,
} ImageType;

// "int16"; "unsupported" for IMAGE_OTHER. Static storage.
const char *image_type_name(ImageType type);
size_t image_type_bytes(ImageType type); // 0 for IMAGE_OTHER

typedef struct ImageSpec {
    int width, height, channels; // pixels, >= 1
    ImageType type;              // of all channels, as stored
    int alpha_channel;           // -1: none
    bool tiled;
    int block_rows; // rows that are best read at a time; for tiled images, the only possible row_begin are multiples
} ImageSpec;

typedef struct ImageFile ImageFile;

// `format`: "tiff", "png" ... as OpenImageIO names its readers, or NULL for whatever the file turns out to be. Of files
// that hold several images this is the first one. Every failure is logged with the file and the cause. DEVICE: the
// module or one of its libraries is missing; FORMAT: not such a file, or damaged. The caller compares what the
// header promises with the size of the file before it allocates.
MUST_USE Result image_open(const char *path, const char *format, ImageFile **out);
void image_close(ImageFile **file);
const ImageSpec *image_spec(const ImageFile *file); // lives as long as the file

// Rows row_begin .. row_end - 1, channels 0 .. channels - 1, interleaved, in the native type, into
// (row_end - row_begin) * width * channels samples at `out`. FORMAT: truncated or damaged; `out` is then undefined.
MUST_USE Result image_read_rows(ImageFile *file, int row_begin, int row_end, int channels, void *out);

// A whole picture as 8-bit RGBA, for drawing: gray is spread, missing alpha is 255, wider types are reduced.
// `out` is freed by the caller with free(). RANGE: a side above `side_max`; FORMAT also when the header
// promises more pixels than a file of that size can hold.
typedef struct ImagePicture {
    int width, height; // pixels
    uint8_t *rgba;     // [height][width][4], row 0 at the top
} ImagePicture;
MUST_USE Result image_read_picture(const char *path, int side_max, ImagePicture *out);

// `channels` 1 (gray), 3 (RGB) or 4 (RGBA) of 8 bits; rows from the top, without padding. IO: the file could not
// be written, and was removed.
MUST_USE Result image_write_png(const char *path, int width, int height, int channels, const uint8_t *pixels);
