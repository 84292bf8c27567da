#include "terrain/dem/geotiff_tags.h"

#include "base/log.h"
#include "terrain/dem/dem.h"

#include <geo_normalize.h>
#include <geotiff.h>
#include <geovalues.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xtiffio.h>

#define TAG_GDAL_METADATA 42112
#define TAG_GDAL_NODATA 42113

// Tags need no more than this at once: DEM_SIDE_MAX strips of 8 bytes, and text.
#define TAG_BYTES_MAX (64 << 20)

typedef struct Reader {
    const char *path;
    TIFF *tiff;
    char reason[256]; // the library's first complaint
} Reader;

static int keep_reason(TIFF *tiff, void *user, const char *module, const char *format, va_list arguments) {
    (void)tiff;
    (void)module;
    Reader *reader = user;
    if (!reader->reason[0])
        vsnprintf(reader->reason, sizeof reader->reason, format, arguments);
    return 1;
}

static int drop_warning(TIFF *tiff, void *user, const char *module, const char *format, va_list arguments) {
    (void)tiff, (void)user, (void)module, (void)format, (void)arguments;
    return 1;
}

static Result open_tiff(Reader *reader) {
    XTIFFInitialize();
    TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
    if (options) {
        TIFFOpenOptionsSetMaxSingleMemAlloc(options, TAG_BYTES_MAX);
        TIFFOpenOptionsSetErrorHandlerExtR(options, keep_reason, reader);
        TIFFOpenOptionsSetWarningHandlerExtR(options, drop_warning, NULL);
        reader->tiff = TIFFOpenExt(reader->path, "rm", options); // m: not mapped, so that a shrinking file is no fault
        TIFFOpenOptionsFree(options);
    }
    if (reader->tiff)
        return RESULT_OK;
    log_error("%s: a damaged TIFF: %s; fetch it again", reader->path, reader->reason[0] ? reader->reason : "no header");
    return RESULT_FORMAT;
}

// ---- Size and layout --------------------------------------------------------------------------------------------

static Result refuse_size(const char *path, uint32_t width, uint32_t height, unsigned bands) {
    log_error("%s: its header says %u x %u samples in %u bands; expected 2 to %d a side; if that is true, cut it: "
              "gdal_translate -srcwin 0 0 %d %d %s OUT.tif",
              path, width, height, bands, DEM_SIDE_MAX, DEM_SIDE_MAX, DEM_SIDE_MAX, path);
    return RESULT_FORMAT;
}

static GeotiffFormat format_of(unsigned tag) {
    switch (tag) {
    case SAMPLEFORMAT_UINT:
    case SAMPLEFORMAT_VOID:
        return GEOTIFF_UINT;
    case SAMPLEFORMAT_INT:
        return GEOTIFF_INT;
    case SAMPLEFORMAT_IEEEFP:
        return GEOTIFF_FLOAT;
    default:
        return GEOTIFF_OTHER;
    }
}

static Result read_layout(Reader *reader, GeotiffTags *out) {
    TIFF *tiff = reader->tiff;
    uint32_t width = 0, height = 0;
    uint16_t bands = 1, bits = 1, format = SAMPLEFORMAT_UINT, photometric = PHOTOMETRIC_MINISBLACK, extra_count = 0;
    uint16_t *extra = NULL;
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &bands);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &bits);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &format);
    TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_EXTRASAMPLES, &extra_count, &extra);
    if (width < 1 || height < 1 || width > DEM_SIDE_MAX || height > DEM_SIDE_MAX || bands < 1)
        return refuse_size(reader->path, width, height, bands);
    out->width = (int)width;
    out->height = (int)height;
    out->bands = bands;
    out->bits = bits;
    out->format = format_of(format);
    out->gray = photometric == PHOTOMETRIC_MINISBLACK;
    out->alpha =
        bands == 2 && extra_count >= 1 && (extra[0] == EXTRASAMPLE_ASSOCALPHA || extra[0] == EXTRASAMPLE_UNASSALPHA);
    return RESULT_OK;
}

// How many bytes of pixels one byte of a file can stand for at most, by the design of the method.
static double expansion_limit(unsigned compression) {
    switch (compression) {
    case COMPRESSION_NONE:
        return 1.0;
    case COMPRESSION_PACKBITS:
        return 64.0;
    case COMPRESSION_LZW:
        return 4096.0;
    case COMPRESSION_DEFLATE:
    case COMPRESSION_ADOBE_DEFLATE:
        return 1040.0;
    default: // Zstandard, LZMA, LERC: whole blocks of one value
        return 65536.0;
    }
}

static Result refuse_sparse(const char *path, uint32_t block) {
    log_error(
        "%s: block %u has no data (a sparse file); write it in full: gdal_translate -co SPARSE_OK=FALSE %s OUT.tif",
        path, block, path);
    return RESULT_UNSUPPORTED;
}

static Result check_codec(const char *path, unsigned compression) {
    if (TIFFIsCODECConfigured((uint16_t)compression))
        return RESULT_OK;
    log_error("%s: compressed by method %u, which libtiff here cannot read; convert it: gdal_translate -co "
              "COMPRESS=DEFLATE %s OUT.tif",
              path, compression, path);
    return RESULT_UNSUPPORTED;
}

static Result refuse_beyond_end(const char *path, uint32_t block, uint64_t offset, uint64_t bytes, uint64_t end) {
    log_error("%s: truncated or damaged: block %u takes %llu bytes from byte %llu on, but the file ends at %llu; fetch "
              "it again",
              path, block, (unsigned long long)bytes, (unsigned long long)offset, (unsigned long long)end);
    return RESULT_FORMAT;
}

static Result check_block(Reader *reader, uint32_t block, uint64_t file_bytes, uint64_t *bytes) {
    int failed_offset = 0, failed_bytes = 0;
    uint64_t offset = TIFFGetStrileOffsetWithErr(reader->tiff, block, &failed_offset);
    *bytes = TIFFGetStrileByteCountWithErr(reader->tiff, block, &failed_bytes);
    if (failed_offset || failed_bytes) {
        log_error("%s: truncated or damaged: block %u is not in the file's list of blocks; fetch it again",
                  reader->path, block);
        return RESULT_FORMAT;
    }
    if (*bytes == 0)
        return refuse_sparse(reader->path, block);
    if (offset > file_bytes || *bytes > file_bytes - offset)
        return refuse_beyond_end(reader->path, block, offset, *bytes, file_bytes);
    return RESULT_OK;
}

// Bytes of pixels that the reader will unpack: whole tiles, or the image's strips. 0: too many to count.
static double unpacked_bytes(TIFF *tiff, const GeotiffTags *tags) {
    if (TIFFIsTiled(tiff))
        return (double)TIFFNumberOfTiles(tiff) * (double)TIFFTileSize64(tiff);
    return (double)tags->width * tags->height * tags->bands * tags->bits / 8.0;
}

// Every strip or tile must lie within the file, and together they must be able to hold the pixels.
static Result check_storage(Reader *reader, const GeotiffTags *tags) {
    TIFF *tiff = reader->tiff;
    uint16_t compression = COMPRESSION_NONE;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
    Result result = check_codec(reader->path, compression);
    uint32_t count = TIFFIsTiled(tiff) ? TIFFNumberOfTiles(tiff) : TIFFNumberOfStrips(tiff);
    uint64_t file_bytes = (uint64_t)TIFFGetSizeProc(tiff)(TIFFClientdata(tiff));
    double stored = 0.0, unpacked = unpacked_bytes(tiff, tags);
    for (uint32_t i = 0; i < count && result == RESULT_OK; i++) {
        uint64_t bytes = 0;
        result = check_block(reader, i, file_bytes, &bytes);
        stored += (double)bytes;
    }
    if (result == RESULT_OK && (unpacked <= 0.0 || unpacked > stored * expansion_limit(compression))) {
        log_error("%s: truncated or damaged: its header promises %.0f bytes of samples, its %u blocks hold %.0f bytes "
                  "in all; "
                  "fetch it again",
                  reader->path, unpacked, count, stored);
        result = RESULT_FORMAT;
    }
    return result;
}

// ---- Tags -------------------------------------------------------------------------------------------------------

// The doubles of a tag, at most `most`; how many there are in the file, 0 without such a tag.
static int get_doubles(TIFF *tiff, uint32_t tag, double *out, int most) {
    const TIFFField *field = TIFFFindField(tiff, tag, TIFF_ANY);
    if (!field || TIFFFieldDataType(field) != TIFF_DOUBLE || !TIFFFieldPassCount(field))
        return 0;
    uint16_t short_count = 0;
    uint32_t count = 0;
    double *values = NULL;
    bool is_short = TIFFFieldReadCount(field) == TIFF_VARIABLE;
    if (!(is_short ? TIFFGetField(tiff, tag, &short_count, &values) : TIFFGetField(tiff, tag, &count, &values)))
        return 0;
    int found = is_short ? short_count : count < INT32_MAX ? (int)count : INT32_MAX;
    for (int i = 0; values && i < found && i < most; i++)
        out[i] = values[i];
    return values ? found : 0;
}

// A text tag as a string of its own, to be freed; NULL without one.
static char *get_text(TIFF *tiff, uint32_t tag) {
    const TIFFField *field = TIFFFindField(tiff, tag, TIFF_ANY);
    uint32_t count = 0;
    char *text = NULL;
    if (!field || TIFFFieldDataType(field) != TIFF_ASCII || !TIFFFieldPassCount(field) ||
        TIFFFieldReadCount(field) != TIFF_VARIABLE2 || !TIFFGetField(tiff, tag, &count, &text) || !text)
        return NULL;
    char *copy = malloc((size_t)count + 1);
    if (copy) {
        memcpy(copy, text, count);
        copy[count] = '\0';
    }
    return copy;
}

static void read_placement(Reader *reader, GeotiffTags *out) {
    TIFF *tiff = reader->tiff;
    out->has_scale = get_doubles(tiff, TIFFTAG_GEOPIXELSCALE, out->scale, 3) >= 2;
    out->tie_count = get_doubles(tiff, TIFFTAG_GEOTIEPOINTS, out->tie, 6) / 6;
    out->has_matrix = get_doubles(tiff, TIFFTAG_GEOTRANSMATRIX, out->matrix, 16) == 16;
}

static void copy_text(char *out, size_t size, const char *text, size_t length) {
    snprintf(out, size, "%.*s", (int)(length < size ? length : size), text);
}

// <Item name="..." sample="0" role="scale">0.1</Item>: the text of the first band's item with this role.
static const char *find_item(const char *metadata, const char *role, size_t *length) {
    char wanted[40];
    snprintf(wanted, sizeof wanted, "role=\"%s\"", role);
    for (const char *item = strstr(metadata, "<Item "); item; item = strstr(item + 1, "<Item ")) {
        const char *begin = strchr(item, '>'), *end = begin ? strchr(begin, '<') : NULL;
        if (!end)
            return NULL;
        const char *found = strstr(item, wanted), *sample = strstr(item, "sample=\"");
        bool first_band = !sample || sample > begin || sample[8] == '0';
        if (found && found < begin && first_band) {
            *length = (size_t)(end - begin - 1);
            return begin + 1;
        }
    }
    return NULL;
}

static double item_number(const char *metadata, const char *role, double otherwise) {
    size_t length;
    const char *text = find_item(metadata, role, &length);
    return text ? strtod(text, NULL) : otherwise;
}

static void read_gdal(Reader *reader, GeotiffTags *out) {
    char *nodata = get_text(reader->tiff, TAG_GDAL_NODATA);
    if (nodata) {
        char *end = nodata;
        out->nodata = strtod(nodata, &end);
        out->has_nodata = end != nodata;
    }
    free(nodata);
    out->gdal_scale = 1.0;
    char *metadata = get_text(reader->tiff, TAG_GDAL_METADATA);
    if (metadata) {
        size_t length;
        const char *unit = find_item(metadata, "unittype", &length);
        if (unit)
            copy_text(out->gdal_unit, sizeof out->gdal_unit, unit, length);
        out->gdal_scale = item_number(metadata, "scale", 1.0);
        out->gdal_offset = item_number(metadata, "offset", 0.0);
    }
    free(metadata);
}

// ---- GeoKeys ----------------------------------------------------------------------------------------------------

static void drop_key_message(struct gtiff *gtif, int level, const char *message, ...) {
    (void)gtif, (void)level, (void)message;
}

static int get_code(GTIF *gtif, geokey_t key) {
    unsigned short value = 0;
    return GTIFKeyGetSHORT(gtif, key, &value, 0, 1) == 1 ? value : GEOTIFF_CODE_NONE;
}

static void read_citation(GTIF *gtif, GeotiffTags *out) {
    static const geokey_t KEYS[] = {GTCitationGeoKey, GeogCitationGeoKey};
    for (size_t k = 0; k < COUNT_OF(KEYS) && !out->citation[0]; k++)
        if (GTIFKeyGetASCII(gtif, KEYS[k], out->citation, (int)sizeof out->citation) <= 0)
            out->citation[0] = '\0';
    for (char *c = out->citation; *c; c++)
        if (*c < 32 || *c > 126)
            *c = '?';
}

static bool near(double a, double b, double tolerance) {
    return fabs(a - b) <= tolerance;
}

static double projection_value(const GTIFDefn *definition, int key, double otherwise) {
    for (int i = 0; i < definition->nParms; i++)
        if (definition->ProjParmId[i] == key)
            return definition->ProjParm[i];
    return otherwise;
}

// The UTM zone that a transverse Mercator's parameters amount to, as EPSG code; 0: none.
static int utm_code_of(const GTIFDefn *definition) {
    double zone = (projection_value(definition, ProjNatOriginLongGeoKey, NAN) + 183.0) / 6.0;
    double north_m = projection_value(definition, ProjFalseNorthingGeoKey, 0.0);
    bool utm = definition->CTProjection == CT_TransverseMercator && near(zone, round(zone), 1e-9) && zone >= 1.0 &&
               zone <= 60.0 && near(projection_value(definition, ProjScaleAtNatOriginGeoKey, 1.0), 0.9996, 1e-12) &&
               near(projection_value(definition, ProjNatOriginLatGeoKey, 0.0), 0.0, 1e-12) &&
               near(projection_value(definition, ProjFalseEastingGeoKey, 0.0), 500000.0, 1e-6) &&
               near(definition->UOMLengthInMeters, 1.0, 1e-12);
    if (utm && near(north_m, 0.0, 1e-6))
        return 32600 + (int)round(zone);
    return utm && near(north_m, 1e7, 1e-6) ? 32700 + (int)round(zone) : 0;
}

static void read_definition(GTIF *gtif, GeotiffTags *out) {
    GTIFDefn *definition = GTIFAllocDefn();
    if (definition && GTIFGetDefn(gtif, definition)) {
        out->defined_wgs84 =
            near(definition->SemiMajor, 6378137.0, 1e-6) && near(definition->SemiMinor, 6356752.314245179, 1e-3) &&
            (definition->Datum == Datum_WGS84 || definition->GCS == GCS_WGS_84) &&
            near(definition->PMLongToGreenwich, 0.0, 1e-12) && near(definition->UOMAngleInDegrees, 1.0, 1e-12);
        out->defined_utm = out->defined_wgs84 ? utm_code_of(definition) : 0;
    }
    if (definition)
        GTIFFreeDefn(definition);
}

static void read_keys(Reader *reader, GeotiffTags *out) {
    GTIF *gtif = GTIFNewEx(reader->tiff, drop_key_message, NULL);
    if (!gtif)
        return;
    out->model = get_code(gtif, GTModelTypeGeoKey);
    out->has_keys = out->model != GEOTIFF_CODE_NONE;
    out->is_point = get_code(gtif, GTRasterTypeGeoKey) == RasterPixelIsPoint;
    out->geographic = get_code(gtif, GeographicTypeGeoKey);
    out->projected = get_code(gtif, ProjectedCSTypeGeoKey);
    out->vertical = get_code(gtif, VerticalCSTypeGeoKey);
    out->vertical_datum = get_code(gtif, VerticalDatumGeoKey);
    out->vertical_units = get_code(gtif, VerticalUnitsGeoKey);
    read_citation(gtif, out);
    int code = out->model == ModelTypeProjected ? out->projected : out->geographic;
    if (out->has_keys && code == GEOTIFF_CODE_USER_DEFINED)
        read_definition(gtif, out);
    GTIFFree(gtif);
}

Result geotiff_read_tags(const char *path, GeotiffTags *out) {
    Reader reader = {.path = path};
    *out = (GeotiffTags){0};
    Result result = open_tiff(&reader);
    if (result != RESULT_OK)
        return result;
    result = read_layout(&reader, out);
    if (result == RESULT_OK)
        result = check_storage(&reader, out);
    if (result == RESULT_OK) {
        read_placement(&reader, out);
        read_keys(&reader, out);
        read_gdal(&reader, out);
    }
    XTIFFClose(reader.tiff);
    return result;
}
