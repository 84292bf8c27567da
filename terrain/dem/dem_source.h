// terrain/dem/dem_source.h: one elevation file whose header is known and checked, and how its rows become heights.
// Private to terrain/dem/dem_*.c. Units of the CRS; heights in metres above the header's datum; NaN is a void. Row 0 is
// the northernmost. A DemSource is a value that holds no file open; it borrows the path. One thread at a time may read
// it.
#pragma once
#include "assets/image.h"
#include "terrain/dem/dem.h"

// Beyond this no Earth has heights: another unit, an undeclared nodata value, or another kind of data.
#define DEM_HEIGHT_MAX_M 1e5
// Of terrarium tiles, which may be pictures just as well: from below the deepest trench to above the highest summit.
#define DEM_TERRARIUM_MIN_M (-12000.0)
#define DEM_TERRARIUM_MAX_M 9500.0

typedef struct DemHeader {
    int width, height; // samples, 2..DEM_SIDE_MAX
    DemGeoref georef;
    DemDatum datum;
    bool datum_assumed, pixel_is_area, georeferenced;
    char type[16], crs_name[64];
} DemHeader;

// How stored samples become metres: stored * scale_m + offset_m.
typedef struct DemCoding {
    ImageType type;
    int channels; // in the file; the first is read, or the first three for terrarium
    bool alpha;   // the second channel is 0 where there are no data
    bool terrarium;
    bool has_nodata;
    double nodata; // as stored
    double scale_m, offset_m;
    bool south_up; // the file's first row is the southernmost
} DemCoding;

// Where rows go: part of a larger grid that starts as NaN. What is there stays: the first of overlapping files wins,
// a void never does.
typedef struct DemTarget {
    float *height_m; // of the source's sample (0, 0)
    size_t stride;   // samples from row to row
} DemTarget;

typedef struct DemSource DemSource;
struct DemSource {
    const char *path;
    DemHeader header;
    DemCoding coding;
    Result (*read)(const DemSource *source, const DemTarget *target);
};

// Recognises the file by its contents, reads and checks its header. Errors as dem_load.
MUST_USE Result dem_source_open(const DemOptions *options, const char *path, DemSource *out);

// One per format; `bytes`: the size of the file.
MUST_USE Result dem_geotiff_open(const DemOptions *options, const char *path, DemSource *out);
MUST_USE Result dem_png_open(const DemOptions *options, const char *path, int64_t bytes, DemSource *out);
MUST_USE Result dem_hgt_open(const char *path, DemSource *out);

// Whether the name ends so, in any case of letters.
bool dem_name_ends(const char *name, const char *ending);

// Sets the georeference of an image that has none from options->spacing_m or the bounds; UNSUPPORTED without either.
MUST_USE Result dem_source_place(const DemOptions *options, const char *path, DemHeader *header);
// Takes longitudes to where the DEM's middle is in -180..180; RANGE where it leaves the globe or the CRS.
MUST_USE Result dem_source_check_georef(const char *path, DemHeader *header);

// Reads through assets/image; a DemSource's `read` for "tiff" and "png".
MUST_USE Result dem_raster_read(const DemSource *source, const char *format, const DemTarget *target);
// Turns `count` stored samples into metres, NaN for voids.
void dem_coding_decode(const DemCoding *coding, const void *stored, int count, float *height_m);
// Refuses heights no Earth has, naming the sample; else puts the row, counted from the file's first.
MUST_USE Result dem_source_put_row(const DemSource *source, const DemTarget *target, int file_row,
                                   const float *height_m);
