#include "app/recording/recording_zstd.h"

#include "base/log.h"

#include <stdlib.h>
#include <zstd.h>

#define LEVEL 1 // docs/recording.md: higher ones save nothing on so short frames
#define BLOCK_BYTES_EXTRA 32
#define DESCRIPTOR_AT 4 // after the magic number; RFC 8878 3.1.1.1.1
#define DESCRIPTOR_CHECKSUM 0x04

struct RecordingZstd {
    ZSTD_CCtx *compressor;
    ZSTD_DCtx *decompressor;
};

static bool prepare(RecordingZstd *zstd) {
    return zstd->compressor && zstd->decompressor &&
           !ZSTD_isError(ZSTD_CCtx_setParameter(zstd->compressor, ZSTD_c_compressionLevel, LEVEL)) &&
           !ZSTD_isError(ZSTD_CCtx_setParameter(zstd->compressor, ZSTD_c_checksumFlag, 1));
}

// The library takes its memory with the first frame of a size, and gives it back after 128 frames of a third.
static bool warm_up(RecordingZstd *zstd, size_t usual) {
    size_t bound = recording_zstd_bound(usual, 1);
    void *content = calloc(1, usual), *frame = malloc(bound);
    bool ok = content && frame && recording_zstd_compress(zstd, &(RecordingSpan){content, usual}, 1, frame, bound) > 0;
    free(content);
    free(frame);
    return ok;
}

Result recording_zstd_create(size_t usual, RecordingZstd **out) {
    RecordingZstd *zstd = calloc(1, sizeof *zstd);
    if (!zstd)
        goto fail;
    zstd->compressor = ZSTD_createCCtx();
    zstd->decompressor = ZSTD_createDCtx();
    if (!prepare(zstd) || !warm_up(zstd, usual))
        goto fail;
    *out = zstd;
    return RESULT_OK;
fail:
    recording_zstd_destroy(&zstd);
    log_error("no memory for the compression of a recording");
    return RESULT_MEMORY;
}

void recording_zstd_destroy(RecordingZstd **zstd) {
    if (!*zstd)
        return;
    ZSTD_freeCCtx((*zstd)->compressor);
    ZSTD_freeDCtx((*zstd)->decompressor);
    free(*zstd);
    *zstd = NULL;
}

size_t recording_zstd_bound(size_t count, int spans) {
    return ZSTD_compressBound(count) + (size_t)spans * BLOCK_BYTES_EXTRA;
}

static bool add_span(ZSTD_CCtx *compressor, const RecordingSpan *span, bool last, ZSTD_outBuffer *to) {
    ZSTD_inBuffer from = {span->bytes, span->count, 0};
    size_t left = ZSTD_compressStream2(compressor, to, &from, last ? ZSTD_e_end : ZSTD_e_flush);
    return !ZSTD_isError(left) && left == 0 && from.pos == from.size;
}

size_t recording_zstd_compress(RecordingZstd *zstd, const RecordingSpan *spans, int count, void *out, size_t capacity) {
    ZSTD_outBuffer to = {out, capacity, 0};
    size_t total = 0;
    for (int i = 0; i < count; i++)
        total += spans[i].count;
    bool ok = !ZSTD_isError(ZSTD_CCtx_reset(zstd->compressor, ZSTD_reset_session_only)) &&
              !ZSTD_isError(ZSTD_CCtx_setPledgedSrcSize(zstd->compressor, total));
    for (int i = 0; ok && i < count; i++)
        ok = add_span(zstd->compressor, &spans[i], i == count - 1, &to);
    return ok ? to.pos : 0;
}

bool recording_zstd_decompress(RecordingZstd *zstd, const void *bytes, size_t count, void *out, size_t capacity,
                               size_t *out_count) {
    const uint8_t *frame = bytes;
    if (count <= DESCRIPTOR_AT || !(frame[DESCRIPTOR_AT] & DESCRIPTOR_CHECKSUM))
        return false;
    unsigned long long content = ZSTD_getFrameContentSize(bytes, count);
    if (content == ZSTD_CONTENTSIZE_UNKNOWN || content == ZSTD_CONTENTSIZE_ERROR || content > capacity ||
        ZSTD_findFrameCompressedSize(bytes, count) != count)
        return false;
    *out_count = ZSTD_decompressDCtx(zstd->decompressor, out, capacity, bytes, count);
    return !ZSTD_isError(*out_count) && *out_count == content;
}
