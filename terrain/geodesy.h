// terrain/geodesy.h: WGS84, between geodetic and Earth-centred coordinates.
// Radians, metres above the ellipsoid, ECEF metres in double.
// Pure functions, any thread; deterministic.
#pragma once
#include "base/vec.h"

#define GEODESY_A_M 6378137.0           // equatorial radius, WGS84 (NGA.STND.0036)
#define GEODESY_F (1.0 / 298.257223563) // flattening
#define GEODESY_B_M (GEODESY_A_M * (1.0 - GEODESY_F))
#define GEODESY_E2 (GEODESY_F * (2.0 - GEODESY_F)) // first eccentricity squared
#define GEODESY_PI 3.14159265358979323846
#define GEODESY_RAD_PER_DEG (GEODESY_PI / 180.0)

typedef struct Geodetic {
    double lat_rad; // -pi/2 .. pi/2
    double lon_rad; // any; geodesy_from_ecef gives -pi .. pi
    double h_m;     // above the ellipsoid
} Geodetic;

Vec3d geodesy_to_ecef(Geodetic point);
// Within 1e-9 degrees and 1e-6 m of the exact inverse from -10 km to 1e9 m (hard case 13). On the
// polar axis the longitude is 0.
Geodetic geodesy_from_ecef(Vec3d ecef);

// Unit vectors of the local frame, in ECEF. Rows of geodesy_enu_from_ecef: east, north, up (= the
// geodetic normal). At a pole the frame follows from the longitude given.
Mat3d geodesy_enu_from_ecef(double lat_rad, double lon_rad);
Vec3d geodesy_up(double lat_rad, double lon_rad);
