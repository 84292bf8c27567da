#define _GNU_SOURCE
#include "tests/dem_support.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

bool support_has_gdal(void) {
    return system("gdal_translate --version > /dev/null 2>&1 && gdalinfo --version > /dev/null 2>&1") == 0;
}

void support_run(const char *format, ...) {
    char command[2048];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(command, sizeof command, format, arguments);
    va_end(arguments);
    if (system(command) != 0)
        fail_msg("failed: %s", command);
}

int dem_support_height(int col, int row) {
    if (col >= 20 && col < 31 && row >= 40 && row < 47)
        return SUPPORT_NODATA;
    return (int)lround(600.0 + 400.0 * sin(col * 0.13) * cos(row * 0.21) + 2.0 * row + ((col * 7 + row * 13) % 11));
}

static void write_source(const char *path) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "ncols %d\nnrows %d\nxllcorner 10\nyllcorner 45\ncellsize 0.0009765625\nNODATA_value %d\n",
            SUPPORT_WIDTH, SUPPORT_HEIGHT, SUPPORT_NODATA);
    for (int row = 0; row < SUPPORT_HEIGHT; row++, fputc('\n', file))
        for (int col = 0; col < SUPPORT_WIDTH; col++)
            fprintf(file, "%d ", dem_support_height(col, row));
    assert_int_equal(fclose(file), 0);
}

void dem_support_begin(DemSupport *support) {
    snprintf(support->folder, sizeof support->folder, "/tmp/overfly-dem-XXXXXX");
    assert_non_null(mkdtemp(support->folder));
    snprintf(support->source, sizeof support->source, "%s/source.asc", support->folder);
    write_source(support->source);
}

void dem_support_end(DemSupport *support) {
    support_run("rm -rf '%s'", support->folder);
}

void dem_support_path(const DemSupport *support, const char *name, char *out) {
    snprintf(out, 192, "%s/%s", support->folder, name);
}

void dem_support_translate(const DemSupport *support, const char *arguments, const char *name, char *out) {
    dem_support_path(support, name, out);
    support_run("gdal_translate -q %s %s %s %s", strstr(arguments, "-a_srs") ? "" : "-a_srs EPSG:4326", arguments,
                support->source, out);
}

void dem_support_vrt(const DemSupport *support, const char *name, const char *srs, const double transform[6],
                     const char *band_elements, char *out) {
    dem_support_path(support, name, out);
    FILE *file = fopen(out, "w");
    assert_non_null(file);
    fprintf(file, "<VRTDataset rasterXSize=\"%d\" rasterYSize=\"%d\"><SRS>%s</SRS><GeoTransform>", SUPPORT_WIDTH,
            SUPPORT_HEIGHT, srs);
    for (int i = 0; i < 6; i++)
        fprintf(file, "%s%.17g", i ? ", " : "", transform[i]);
    fprintf(file,
            "</GeoTransform><VRTRasterBand dataType=\"Int16\" band=\"1\"><NoDataValue>%d</NoDataValue>%s"
            "<SimpleSource><SourceFilename>%s</SourceFilename><SourceBand>1</SourceBand></SimpleSource>"
            "</VRTRasterBand></VRTDataset>\n",
            SUPPORT_NODATA, band_elements, support->source);
    assert_int_equal(fclose(file), 0);
}

void support_write(const char *path, const void *bytes, size_t count) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, count, file), count);
    assert_int_equal(fclose(file), 0);
}

void *support_read(const char *path, size_t *count) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *count = (size_t)ftell(file);
    rewind(file);
    void *bytes = malloc(*count + 1);
    assert_int_equal(fread(bytes, 1, *count, file), *count);
    fclose(file);
    return bytes;
}

static void read_transform(const char *info, double transform[6]) {
    const char *text = strstr(info, "\"geoTransform\":");
    assert_non_null(text);
    text = strchr(text, '[') + 1;
    for (int i = 0; i < 6; i++) {
        char *end;
        transform[i] = strtod(text, &end);
        text = strchr(end, i < 5 ? ',' : ']') + 1;
    }
}

GdalRaster support_gdal_raster(const DemSupport *support, const char *path) {
    GdalRaster raster = {0};
    size_t count;
    char info[192], samples[192];
    dem_support_path(support, "info.json", info);
    dem_support_path(support, "samples.bin", samples);
    support_run("gdalinfo -json '%s' > %s && gdal_translate -q -b 1 -of ENVI -ot Float32 '%s' %s 2> /dev/null", path,
                info, path, samples);
    char *text = support_read(info, &count);
    text[count] = '\0';
    const char *size = strstr(text, "\"size\":");
    assert_non_null(size);
    size = strchr(size, '[') + 1;
    raster.width = atoi(size);
    raster.height = atoi(strchr(size, ',') + 1);
    if (strstr(text, "\"geoTransform\":"))
        read_transform(text, raster.transform);
    free(text);
    raster.stored = support_read(samples, &count);
    assert_int_equal(count, (size_t)raster.width * (size_t)raster.height * sizeof(float));
    return raster;
}

static void hear(void *user, LogLevel level, const char *message) {
    Heard *heard = user;
    if (level == LOG_ERROR) {
        heard->errors++;
        snprintf(heard->error, sizeof heard->error, "%s", message);
    } else if (level == LOG_WARN) {
        heard->warnings++;
        snprintf(heard->warning, sizeof heard->warning, "%s", message);
    }
}

Result support_load_paths(const DemOptions *options, const char *const *paths, int count, Dem **out, Heard *heard) {
    *out = NULL;
    *heard = (Heard){0};
    log_set_sink(hear, heard);
    Result result = dem_load(options, paths, count, out);
    log_set_sink(NULL, NULL);
    return result;
}

Result support_load(const DemOptions *options, const char *path, Dem **out, Heard *heard) {
    return support_load_paths(options, &path, 1, out, heard);
}

void support_skip_without_gdal(void) {
    if (support_has_gdal())
        return;
    print_message("skipped: gdal-bin is not installed\n");
    skip();
}

int dem_support_setup(void **state) {
    DemSupport *support = malloc(sizeof *support);
    if (!support)
        return -1;
    dem_support_begin(support);
    *state = support;
    return 0;
}

int dem_support_teardown(void **state) {
    dem_support_end(*state);
    free(*state);
    return 0;
}
