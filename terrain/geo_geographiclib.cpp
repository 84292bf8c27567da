// The only file that knows GeographicLib, whose errors are exceptions: none gets out.
#include "terrain/geo.h"

#include "base/log.h"

#include <GeographicLib/Constants.hpp>
#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/Geoid.hpp>
#include <GeographicLib/UTMUPS.hpp>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <new>
#include <string>

using GeographicLib::Geocentric;
using GeographicLib::UTMUPS;

struct Geoid {
    GeographicLib::Geoid grid;
};

extern "C" Result geo_utm_forward(int zone, bool north, double lat_deg, double lon_deg, double *easting_m,
                                  double *northing_m) {
    try {
        int zone_out;
        bool north_out;
        double x, y;
        UTMUPS::Forward(lat_deg, lon_deg, zone_out, north_out, x, y, zone);
        // The southern false northing is the only difference between the hemispheres.
        *easting_m = x;
        *northing_m = y + (north_out == north ? 0.0 : north ? -1e7 : 1e7);
        return zone_out == zone && std::isfinite(x) ? RESULT_OK : RESULT_RANGE;
    } catch (...) {
        return RESULT_RANGE;
    }
}

extern "C" Result geo_utm_reverse(int zone, bool north, double easting_m, double northing_m, double *lat_deg,
                                  double *lon_deg) {
    if (zone < UTMUPS::MINUTMZONE || zone > UTMUPS::MAXUTMZONE)
        return RESULT_RANGE;
    try {
        UTMUPS::Reverse(zone, north, easting_m, northing_m, *lat_deg, *lon_deg);
        return std::isfinite(*lat_deg) && std::isfinite(*lon_deg) ? RESULT_OK : RESULT_RANGE;
    } catch (...) {
        return RESULT_RANGE;
    }
}

extern "C" void geo_ecef_forward(double lat_deg, double lon_deg, double h_m, double ecef_m[3]) {
    Geocentric::WGS84().Forward(lat_deg, lon_deg, h_m, ecef_m[0], ecef_m[1], ecef_m[2]);
}

extern "C" void geo_ecef_reverse(const double ecef_m[3], double *lat_deg, double *lon_deg, double *h_m) {
    Geocentric::WGS84().Reverse(ecef_m[0], ecef_m[1], ecef_m[2], *lat_deg, *lon_deg, *h_m);
}

// GeographicLib wants the folder and the name without ".pgm".
static bool split_path(const std::string &path, std::string *folder, std::string *name) {
    const std::string ending = ".pgm";
    if (path.size() <= ending.size() || path.compare(path.size() - ending.size(), ending.size(), ending) != 0)
        return false;
    std::string::size_type slash = path.rfind('/');
    *folder = slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
    *name = path.substr(slash == std::string::npos ? 0 : slash + 1);
    name->resize(name->size() - ending.size());
    return !name->empty();
}

static Result check_geoid_file(const char *path) {
    FILE *file = fopen(path, "rb");
    if (!file) {
        Result result = errno == ENOENT ? RESULT_NOT_FOUND : RESULT_IO;
        log_error("%s: the geoid cannot be read: %s; it is needed to turn heights above the sea into heights above the "
                  "ellipsoid; install overfly again",
                  path, strerror(errno));
        return result;
    }
    fclose(file);
    return RESULT_OK;
}

extern "C" Result geoid_open(const char *path, Geoid **out) {
    Result result = check_geoid_file(path);
    if (result != RESULT_OK)
        return result;
    try {
        std::string folder, name;
        if (!split_path(path, &folder, &name))
            throw GeographicLib::GeographicErr("expected a .pgm file");
        // Thread safety means that the whole grid is read now.
        *out = new Geoid{GeographicLib::Geoid(name, folder, true, true)};
        return RESULT_OK;
    } catch (const std::bad_alloc &) {
        log_error("%s: no memory for the geoid", path);
        return RESULT_MEMORY;
    } catch (const std::exception &exception) {
        log_error("%s: not a geoid grid, or damaged: %s; install overfly again", path, exception.what());
    } catch (...) {
        log_error("%s: not a geoid grid, or damaged; install overfly again", path);
    }
    return RESULT_FORMAT;
}

extern "C" void geoid_close(Geoid **geoid) {
    delete *geoid;
    *geoid = nullptr;
}

extern "C" double geoid_undulation_m(const Geoid *geoid, double lat_deg, double lon_deg) {
    try {
        return geoid->grid(lat_deg, lon_deg);
    } catch (...) {
        return NAN;
    }
}
