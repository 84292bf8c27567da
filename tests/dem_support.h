// tests/dem_support.h: elevation files made by GDAL's tools at test time, and what those tools say is in them.
// As the files have them.
// Files lie in a folder of the test's own, which dem_support_end removes.
#pragma once
#include "base/log.h"
#include "terrain/dem/dem.h"

#define SUPPORT_WIDTH 97
#define SUPPORT_HEIGHT 61
#define SUPPORT_NODATA (-9999)

bool support_has_gdal(void);
// Skips the test that calls it, by name, where gdal-bin is missing.
void support_skip_without_gdal(void);

typedef struct DemSupport {
    char folder[64];
    char source[96]; // SUPPORT_WIDTH x SUPPORT_HEIGHT text grid, EPSG:4326, with nodata, heights 0..1250 m
} DemSupport;
void dem_support_begin(DemSupport *support);
void dem_support_end(DemSupport *support);
// The same as the fixture of a cmocka group: *state is a DemSupport.
int dem_support_setup(void **state);
int dem_support_teardown(void **state);
// folder/name; `out` holds 192 bytes.
void dem_support_path(const DemSupport *support, const char *name, char *out);
// The height that the source has; SUPPORT_NODATA in its void.
int dem_support_height(int col, int row);

// Runs a shell command; fails the test unless it exits with 0.
void support_run(const char *format, ...) PRINTF_LIKE(1, 2);
// gdal_translate ARGUMENTS SOURCE folder/NAME, whose path goes to `out`.
void dem_support_translate(const DemSupport *support, const char *arguments, const char *name, char *out);
// A copy of the source under a VRT with another geotransform (GDAL's six numbers) and band elements.
void dem_support_vrt(const DemSupport *support, const char *name, const char *srs, const double transform[6],
                     const char *band_elements, char *out);

void support_write(const char *path, const void *bytes, size_t count);
void *support_read(const char *path, size_t *count); // to be freed

// All samples of the first band, as stored, and GDAL's geotransform.
typedef struct GdalRaster {
    int width, height;
    double transform[6];
    float *stored; // to be freed
} GdalRaster;
GdalRaster support_gdal_raster(const DemSupport *support, const char *path);

// Catches messages while it is set: errors and warnings are counted, the last error is kept.
typedef struct Heard {
    int errors, warnings;
    char error[2048], warning[2048];
} Heard;
Result support_load_paths(const DemOptions *options, const char *const *paths, int count, Dem **out, Heard *heard);
Result support_load(const DemOptions *options, const char *path, Dem **out, Heard *heard);
