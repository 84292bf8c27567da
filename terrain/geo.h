// terrain/geo.h: the parts of GeographicLib we use, as C: UTM and the geoid.
// Degrees and metres, as GeographicLib has them.
// A Geoid is owned by whoever opened it; after opening, any thread may read it.
#pragma once
#include "base/base.h"

#ifdef __cplusplus
extern "C" {
#endif

// UTM on WGS84. `zone` 1..60. RESULT_RANGE where GeographicLib refuses.
MUST_USE Result geo_utm_forward(int zone, bool north, double lat_deg, double lon_deg, double *easting_m,
                                double *northing_m);
MUST_USE Result geo_utm_reverse(int zone, bool north, double easting_m, double northing_m, double *lat_deg,
                                double *lon_deg);
// Geocentric, as the oracle of terrain/geodesy.
void geo_ecef_forward(double lat_deg, double lon_deg, double h_m, double ecef_m[3]);
void geo_ecef_reverse(const double ecef_m[3], double *lat_deg, double *lon_deg, double *h_m);

typedef struct Geoid Geoid;
// `path`: a GeographicLib geoid file (.pgm). NOT_FOUND and FORMAT name the file in the log.
MUST_USE Result geoid_open(const char *path, Geoid **out);
void geoid_close(Geoid **geoid);
// Height of the geoid above the ellipsoid, metres; within 1 cm of GeographicLib's cubic interpolation.
double geoid_undulation_m(const Geoid *geoid, double lat_deg, double lon_deg);

#ifdef __cplusplus
}
#endif
