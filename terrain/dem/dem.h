// terrain/dem/dem.h: an elevation model in memory, read from a file, several adjacent ones, or made by a test.
// Degrees or metres as the CRS has them; heights in metres above `datum`.
// A Dem owns its samples; dem_destroy frees them.
#pragma once
#include "base/base.h"

#define DEM_SIDE_MAX (1 << 20) // samples

typedef enum DemCrs {
    DEM_CRS_GEOGRAPHIC, // WGS84 longitude, latitude, degrees
    DEM_CRS_UTM,        // WGS84 UTM, metres
} DemCrs;

typedef enum DemDatum {
    DEM_DATUM_EGM96,     // above the geoid
    DEM_DATUM_ELLIPSOID, // above WGS84
} DemDatum;

typedef enum DemVoids {
    DEM_VOIDS_FILL,  // interpolated from the rim, the default
    DEM_VOIDS_HOLE,  // interpolated as well, but marked, and not drawn
    DEM_VOIDS_ERROR, // a void is an error
} DemVoids;

// Position of sample centres: x = x0 + col * dx, y = y0 + row * dy, with dx > 0 and dy < 0 (north up).
typedef struct DemGeoref {
    DemCrs crs;
    int utm_zone;   // 1..60 for DEM_CRS_UTM
    bool utm_north; // hemisphere
    double x0, y0;  // centre of sample (0, 0): degrees or metres
    double dx, dy;
} DemGeoref;

typedef struct Dem {
    char *file;   // as given; for display
    char **files; // every file read, those of folders one by one; file_count of them, NULL without a file
    int file_count;
    int width, height; // samples, >= 2 each
    DemGeoref georef;
    DemDatum datum;     // what height_m is measured from
    bool datum_assumed; // the file did not say
    bool pixel_is_area; // as the file had it; georef is of centres in any case
    bool georeferenced; // false: georef was made up from --spacing
    char type[16];      // sample type in the file: "int16", "uint16", "float32", "rgb8" ...
    char crs_name[64];  // "EPSG:4326", "EPSG:32610" ...; "none" where the georeference was made up
    float *height_m;    // [height][width], row 0 the northernmost; voids are filled
    uint8_t *void_bits; // with DEM_VOIDS_HOLE: bit i & 7 of byte i >> 3 for i = row * width + col; NULL: none marked
    int64_t voids;      // samples without data in the file, filled or not
    float min_m, max_m; // over the samples with data
} Dem;

typedef struct DemOptions {
    DemVoids voids;
    bool datum_given; // else what the file says, else EGM96 with datum_assumed
    DemDatum datum;
    double spacing_m; // for images without georeference; 0: not given
    bool bounds_given;
    double west_deg, south_deg, east_deg, north_deg; // of the outermost sample centres
} DemOptions;
DemOptions dem_default_options(void);

// Reads GeoTIFF (integers of 8 to 32 bits, float32), .hgt (also in .zip and .gz), 16-bit PNG, terrarium PNG; several
// paths or a folder must be adjacent tiles of one grid and become one Dem: where they overlap the first one's data
// count (a warning names two that share more than the border strip tiles have), what none covers is void. `file` is the
// first path. Longitudes are such that the DEM's middle is in -180..180. NAD83 and ETRS89 are taken as WGS84, with a
// warning. On failure one message names file, cause and remedy: NOT_FOUND, IO, FORMAT (damaged, or not elevation),
// UNSUPPORTED (CRS, rotation, band count, sample type), RANGE (too small; off the globe; nothing but voids, or any with
// DEM_VOIDS_ERROR; not adjacent), MEMORY. Nothing is allocated from an unchecked header; beyond the samples, loading
// takes at most 1.5 bytes a sample, and only where there are voids.
MUST_USE Result dem_load(const DemOptions *options, const char *const *paths, int path_count, Dem **out);

// A Dem without a file, heights zero, for tests and synthetic scenes.
MUST_USE Result dem_create(int width, int height, const DemGeoref *georef, DemDatum datum, Dem **out);
void dem_destroy(Dem **dem);
// FNV-1a over the heights' bits: to tell elevation models apart.
uint64_t dem_hash(const Dem *dem);

static inline bool dem_is_void(const Dem *dem, int col, int row) {
    size_t i = (size_t)row * (size_t)dem->width + (size_t)col;
    return dem->void_bits && (dem->void_bits[i >> 3] >> (i & 7) & 1);
}

// Bounds of the outermost sample centres in degrees; for UTM the hull of the four sides.
typedef struct DemBounds {
    double west_deg, south_deg, east_deg, north_deg;
} DemBounds;
MUST_USE Result dem_bounds(const Dem *dem, DemBounds *out);
// Ground distance between neighbouring samples at the DEM's centre, metres, along x and y.
MUST_USE Result dem_spacing_m(const Dem *dem, double out_m[2]);
