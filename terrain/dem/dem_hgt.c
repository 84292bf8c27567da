// SRTM tiles: big-endian 16-bit samples without a header, north first; the name says where the south-west corner lies.
// Source: The SRTM Collection User Guide, LP DAAC, version 3, section 2.
#include "base/log.h"
#include "terrain/dem/byte_stream.h"
#include "terrain/dem/dem_source.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct { int width, height; } SIZES[] = {{1201, 1201}, {3601, 3601}, {1801, 3601}};

static Result find_size(const char *path, int64_t bytes, DemHeader *header) {
    for (size_t i = 0; i < COUNT_OF(SIZES); i++)
        if (bytes == 2LL * SIZES[i].width * SIZES[i].height) {
            header->width = SIZES[i].width;
            header->height = SIZES[i].height;
            return RESULT_OK;
        }
    log_error("%s: %lld bytes of samples; expected 2884802 (1201 x 1201), 25934402 (3601 x 3601) or 12970802 (1801 x "
              "3601); truncated, or no SRTM tile: fetch it again",
              path, (long long)bytes);
    return RESULT_FORMAT;
}

static bool parse_number(const char *text, int digits, int *out) {
    *out = 0;
    for (int i = 0; i < digits; i++) {
        if (!isdigit((unsigned char)text[i]))
            return false;
        *out = *out * 10 + (text[i] - '0');
    }
    return true;
}

// "N49E020" anywhere in the name.
static bool parse_corner(const char *name, int *lat, int *lon) {
    for (; *name; name++) {
        int ns = toupper((unsigned char)name[0]);
        if ((ns != 'N' && ns != 'S') || !parse_number(name + 1, 2, lat))
            continue;
        int ew = toupper((unsigned char)name[3]);
        if ((ew != 'E' && ew != 'W') || !parse_number(name + 4, 3, lon) || *lat > 90 || *lon > 180)
            continue;
        *lat = ns == 'S' ? -*lat : *lat;
        *lon = ew == 'W' ? -*lon : *lon;
        return true;
    }
    return false;
}

static Result set_header(const char *path, const ByteStream *stream, DemHeader *header) {
    Result result = find_size(path, byte_stream_size(stream), header);
    if (result != RESULT_OK)
        return result;
    int lat, lon;
    if (!parse_corner(byte_stream_name(stream), &lat, &lon)) {
        log_error("%s: the name \"%s\" does not say where the tile lies; expected one like N49E020.hgt; rename it",
                  path, byte_stream_name(stream));
        return RESULT_FORMAT;
    }
    header->georef = (DemGeoref){.crs = DEM_CRS_GEOGRAPHIC,
                                 .x0 = lon,
                                 .y0 = lat + 1,
                                 .dx = 1.0 / (header->width - 1),
                                 .dy = -1.0 / (header->height - 1)};
    header->datum = DEM_DATUM_EGM96; // by definition of the data set
    header->georeferenced = true;
    snprintf(header->type, sizeof header->type, "int16");
    snprintf(header->crs_name, sizeof header->crs_name, "EPSG:4326");
    return RESULT_OK;
}

static void swap_to_host(const uint8_t *big_endian, int count, int16_t *out) {
    for (int i = 0; i < count; i++)
        out[i] = (int16_t)(uint16_t)(big_endian[2 * i] << 8 | big_endian[2 * i + 1]);
}

static Result read_row(const DemSource *source, ByteStream *stream, int row, const DemTarget *target) {
    uint8_t bytes[2 * 3601];
    int16_t stored[3601];
    float height_m[3601];
    int width = source->header.width;
    Result result = byte_stream_read(stream, bytes, 2 * (size_t)width);
    if (result != RESULT_OK)
        return result;
    swap_to_host(bytes, width, stored);
    dem_coding_decode(&source->coding, stored, width, height_m);
    return dem_source_put_row(source, target, row, height_m);
}

static Result read_hgt(const DemSource *source, const DemTarget *target) {
    ByteStream *stream = NULL;
    Result result = byte_stream_open(source->path, ".hgt", &stream);
    for (int row = 0; row < source->header.height && result == RESULT_OK; row++)
        result = read_row(source, stream, row, target);
    if (result == RESULT_OK)
        result = byte_stream_finish(stream);
    byte_stream_close(&stream);
    return result;
}

Result dem_hgt_open(const char *path, DemSource *out) {
    ByteStream *stream = NULL;
    Result result = byte_stream_open(path, ".hgt", &stream);
    if (result == RESULT_OK)
        result = set_header(path, stream, &out->header);
    out->coding = (DemCoding){.type = IMAGE_INT16, .channels = 1, .scale_m = 1.0};
    out->read = read_hgt;
    byte_stream_close(&stream);
    return result;
}
