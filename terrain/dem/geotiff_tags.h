// terrain/dem/geotiff_tags.h: a TIFF's tags and GeoKeys, as plain numbers. The pixels are assets/image's matter.
// Units as the file has them.
// Values; nothing owned. Any thread.
#pragma once
#include "base/base.h"

#define GEOTIFF_CODE_NONE 0 // the key is missing
#define GEOTIFF_CODE_USER_DEFINED 32767

typedef enum GeotiffFormat { GEOTIFF_UINT, GEOTIFF_INT, GEOTIFF_FLOAT, GEOTIFF_OTHER } GeotiffFormat;

typedef struct GeotiffTags {
    int width, height, bands; // 1..DEM_SIDE_MAX each
    int bits;                 // per sample
    GeotiffFormat format;
    bool gray;  // not a palette, not colours
    bool alpha; // the second band is one

    bool has_scale, has_matrix;
    double scale[3];
    int tie_count; // tie points in the file; the first is in `tie`
    double tie[6];
    double matrix[16];

    bool has_keys;
    int model;                                                           // 1 projected, 2 geographic, 3 geocentric
    bool is_point;                                                       // GTRasterType PixelIsPoint
    int geographic, projected, vertical, vertical_datum, vertical_units; // EPSG codes, or GEOTIFF_CODE_*
    char citation[80];                                                   // printable, may be empty
    // For user-defined codes, from their definition:
    bool defined_wgs84; // ellipsoid and prime meridian are WGS84's, angles degrees
    int defined_utm;    // EPSG code 326zz or 327zz; 0: not UTM

    bool has_nodata;
    double nodata;
    double gdal_scale, gdal_offset; // 1, 0 where the file has none
    char gdal_unit[24];             // of heights; may be empty
} GeotiffTags;

// Reads the first image's tags, and checks that the file is as long as they promise. Logs the failure: FORMAT
// (damaged, lying), UNSUPPORTED (compression, sparse), IO. Memory is taken for tags the file is long enough to hold.
MUST_USE Result geotiff_read_tags(const char *path, GeotiffTags *out);
