#include "terrain/geodesy.h"

#define EP2 (GEODESY_E2 / (1.0 - GEODESY_E2)) // second eccentricity squared

// From the first guess below, each step gains four digits and more at any height.
#define STEPS 4

Vec3d geodesy_to_ecef(Geodetic point) {
    double sin_lat = sin(point.lat_rad), cos_lat = cos(point.lat_rad);
    double normal_m = GEODESY_A_M / sqrt(1.0 - GEODESY_E2 * sin_lat * sin_lat);
    double across_m = (normal_m + point.h_m) * cos_lat;
    return (Vec3d){across_m * cos(point.lon_rad), across_m * sin(point.lon_rad),
                   (normal_m * (1.0 - GEODESY_E2) + point.h_m) * sin_lat};
}

// Bowring's iteration (Survey Review 23, 1976; first guess: 28, 1985) on the reduced latitude, kept as sine and cosine
// so that poles and equator are ordinary points. The height is taken along the normal, where an error of the latitude
// counts only squared; the customary p / cos(lat) - N fails near the poles.
Geodetic geodesy_from_ecef(Vec3d ecef) {
    double p = hypot(ecef.x, ecef.y), r = hypot(p, ecef.z);
    double up = ecef.z * (1.0 - GEODESY_F) * (1.0 + EP2 * GEODESY_B_M / r), across = p;
    double sin_lat = 0.0, cos_lat = 1.0;
    for (int step = 0; step < STEPS; step++) {
        double scale = 1.0 / hypot(up, across), s = up * scale, c = across * scale;
        double z = ecef.z + EP2 * GEODESY_B_M * s * s * s, x = p - GEODESY_E2 * GEODESY_A_M * c * c * c;
        double length = hypot(z, x);
        sin_lat = z / length;
        cos_lat = x / length;
        up = (1.0 - GEODESY_F) * sin_lat;
        across = cos_lat;
    }
    double w = sqrt(1.0 - GEODESY_E2 * sin_lat * sin_lat);
    // p cos + z sin - a w with w = 1 - e^2 sin^2 / (1 + w), of which a stays small beside a far point.
    double h_m = p * cos_lat + ecef.z * sin_lat - GEODESY_A_M * w;
    return (Geodetic){atan2(sin_lat, cos_lat), p > 0.0 ? atan2(ecef.y, ecef.x) : 0.0, h_m};
}

Vec3d geodesy_up(double lat_rad, double lon_rad) {
    double cos_lat = cos(lat_rad);
    return (Vec3d){cos_lat * cos(lon_rad), cos_lat * sin(lon_rad), sin(lat_rad)};
}

Mat3d geodesy_enu_from_ecef(double lat_rad, double lon_rad) {
    double sin_lat = sin(lat_rad), cos_lat = cos(lat_rad), sin_lon = sin(lon_rad), cos_lon = cos(lon_rad);
    return (Mat3d){{{-sin_lon, cos_lon, 0.0},
                    {-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat},
                    {cos_lat * cos_lon, cos_lat * sin_lon, sin_lat}}};
}
