#include "terrain/grid.h"

#include "base/log.h"
#include "terrain/geo.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <stdlib.h>

// Longitudes in fixed point: 2^-44 degrees (6 nm of ground) is the spacing of doubles up to 512 degrees, so a DEM
// given at 19 E and one at 379 E get the same integers, hence the same positions to the bit.
#define FIXED_BITS 44
#define FIXED_QUARTER ((int64_t)90 << FIXED_BITS)

// The spacing of the control points of a UTM grid. A cubic is off by 0.04 s^4 / R^3 at worst: 1 micrometre.
#define CONTROL_SPACING_M 8000.0

// Radii of curvature of the meridian: the smallest, at the equator, and the largest, at the poles.
#define RADIUS_MIN_M (GEODESY_A_M * (1.0 - GEODESY_E2))
#define UTM_SCALE_MIN 0.9996

typedef struct LonTrig {
    double cos, sin;
} LonTrig;

typedef struct LatTrig {
    double axis_m, z_m; // of the ellipsoid's point: distance from the polar axis, height above the equator
    double cos, sin;
} LatTrig;

// The four control points that a column or row lies between, and their Lagrange weights.
typedef struct Weights {
    double w[4];
    int64_t first;
} Weights;

typedef struct Control {
    double v[4]; // ECEF metres of the ellipsoid's point; the fourth is padding for vector loads
} Control;

struct Grid {
    DemGeoref georef;
    int width, height;
    LonTrig *lon;     // [width], geographic only
    LatTrig *lat;     // [height], geographic only
    Control *control; // [control_rows][control_cols], UTM only, as are the weights
    int64_t control_cols, control_rows;
    Weights *col_weights; // [width]
    Weights *row_weights; // [height]
};

// ---- geographic ----

static void sincos_quarters(int64_t quarters, double rest_rad, double *sin_out, double *cos_out) {
    double s = sin(rest_rad), c = cos(rest_rad);
    switch (quarters & 3) {
    case 0:
        *sin_out = s, *cos_out = c;
        break;
    case 1:
        *sin_out = c, *cos_out = -s;
        break;
    case 2:
        *sin_out = -s, *cos_out = -c;
        break;
    default:
        *sin_out = -c, *cos_out = s;
        break;
    }
    *sin_out += 0.0; // minus zero becomes zero
    *cos_out += 0.0;
}

static int64_t fixed_from_degrees(double deg) {
    return llrint(ldexp(deg, FIXED_BITS));
}

static LonTrig lon_trig(const DemGeoref *georef, int col) {
    int64_t lon = fixed_from_degrees(remainder(georef->x0, 360.0)) + fixed_from_degrees(georef->dx * col);
    int64_t half = FIXED_QUARTER / 2;
    int64_t quarters = (lon + half) / FIXED_QUARTER - ((lon + half) % FIXED_QUARTER < 0);
    double rest_deg = ldexp((double)(lon - quarters * FIXED_QUARTER), -FIXED_BITS);
    LonTrig trig;
    sincos_quarters(quarters, rest_deg * GEODESY_RAD_PER_DEG, &trig.sin, &trig.cos);
    return trig;
}

static LatTrig lat_trig(double lat_deg) {
    LatTrig trig;
    double quarters = nearbyint(lat_deg / 90.0);
    sincos_quarters((int64_t)quarters, (lat_deg - 90.0 * quarters) * GEODESY_RAD_PER_DEG, &trig.sin, &trig.cos);
    double normal_m = GEODESY_A_M / sqrt(1.0 - GEODESY_E2 * trig.sin * trig.sin);
    trig.axis_m = normal_m * trig.cos;
    trig.z_m = normal_m * (1.0 - GEODESY_E2) * trig.sin;
    return trig;
}

static Result create_geographic(Grid *grid) {
    const DemGeoref *georef = &grid->georef;
    grid->lon = malloc(sizeof *grid->lon * (size_t)grid->width);
    grid->lat = malloc(sizeof *grid->lat * (size_t)grid->height);
    if (!grid->lon || !grid->lat)
        return RESULT_MEMORY;
    for (int col = 0; col < grid->width; col++)
        grid->lon[col] = lon_trig(georef, col);
    for (int row = 0; row < grid->height; row++)
        grid->lat[row] = lat_trig(georef->y0 + georef->dy * row);
    return RESULT_OK;
}

// ---- UTM ----

static void fill_weights(Weights *weights, int samples, int64_t controls) {
    double scale = (double)(controls - 1) / (samples - 1);
    for (int i = 0; i < samples; i++) {
        double t = i * scale;
        int64_t first = (int64_t)t - 1;
        first = first < 0 ? 0 : first > controls - 4 ? controls - 4 : first;
        double u = t - (double)first; // 0..3
        weights[i] = (Weights){{-(u - 1) * (u - 2) * (u - 3) / 6, u * (u - 2) * (u - 3) / 2, -u * (u - 1) * (u - 3) / 2,
                                u * (u - 1) * (u - 2) / 6},
                               first};
    }
}

static int64_t control_count(int samples, double spacing_m) {
    int64_t count = (int64_t)ceil((samples - 1) * fabs(spacing_m) / CONTROL_SPACING_M) + 1;
    return count < 4 ? 4 : count;
}

static Result control_point(const DemGeoref *georef, double col, double row, Control *out) {
    double lat_deg, lon_deg;
    Result result = geo_utm_reverse(georef->utm_zone, georef->utm_north, georef->x0 + georef->dx * col,
                                    georef->y0 + georef->dy * row, &lat_deg, &lon_deg);
    if (result != RESULT_OK) {
        log_error("grid: column %.0f, row %.0f is outside UTM zone %d, %s; check the file's georeference", col, row,
                  georef->utm_zone, georef->utm_north ? "north" : "south");
        return result;
    }
    LatTrig lat = lat_trig(lat_deg);
    double lon_rad = lon_deg * GEODESY_RAD_PER_DEG;
    *out = (Control){{lat.axis_m * cos(lon_rad), lat.axis_m * sin(lon_rad), lat.z_m, 0.0}};
    return RESULT_OK;
}

static Result fill_control(Grid *grid) {
    for (int64_t j = 0; j < grid->control_rows; j++)
        for (int64_t i = 0; i < grid->control_cols; i++) {
            double col = (double)i * (grid->width - 1) / (double)(grid->control_cols - 1);
            double row = (double)j * (grid->height - 1) / (double)(grid->control_rows - 1);
            Result result = control_point(&grid->georef, col, row, &grid->control[j * grid->control_cols + i]);
            if (result != RESULT_OK)
                return result;
        }
    return RESULT_OK;
}

static Result create_utm(Grid *grid) {
    grid->control_cols = control_count(grid->width, grid->georef.dx);
    grid->control_rows = control_count(grid->height, grid->georef.dy);
    grid->control = malloc(sizeof *grid->control * (size_t)(grid->control_cols * grid->control_rows));
    grid->col_weights = malloc(sizeof *grid->col_weights * (size_t)grid->width);
    grid->row_weights = malloc(sizeof *grid->row_weights * (size_t)grid->height);
    if (!grid->control || !grid->col_weights || !grid->row_weights)
        return RESULT_MEMORY;
    fill_weights(grid->col_weights, grid->width, grid->control_cols);
    fill_weights(grid->row_weights, grid->height, grid->control_rows);
    return fill_control(grid);
}

// ---- both ----

static Result refuse(const char *what, double found, const char *expected) {
    log_error("grid: %s is %.9g, expected %s; check the file's georeference", what, found, expected);
    return RESULT_RANGE;
}

static Result check_geographic(const DemGeoref *georef, int width, int height) {
    // A row may overhang a pole, and a column the date line, by the cell that pixel-is-area files are off by.
    double limit = 90.0 + fabs(georef->dy) * (1.0 + 1e-9);
    double last = georef->y0 + georef->dy * (height - 1);
    if (fabs(georef->y0) > limit || fabs(last) > limit)
        return refuse("a latitude", fabs(last) > limit ? last : georef->y0, "-90 to 90 degrees");
    if (fabs(georef->x0) > 1e6)
        return refuse("the first longitude", georef->x0, "-180 to 360 degrees");
    if (fabs(georef->dx) * (width - 2) > 360.0 * (1.0 + 1e-9))
        return refuse("the span of longitudes", georef->dx * (width - 1), "at most 360 degrees");
    return RESULT_OK;
}

static Result check_utm(const DemGeoref *georef, int width, int height) {
    if (georef->utm_zone < 1 || georef->utm_zone > 60)
        return refuse("the UTM zone", georef->utm_zone, "1 to 60");
    double last_x = georef->x0 + georef->dx * (width - 1), last_y = georef->y0 + georef->dy * (height - 1);
    if (!(georef->x0 >= 0.0 && last_x <= 1e6))
        return refuse("a UTM easting", georef->x0 >= 0.0 ? last_x : georef->x0, "0 to 1000000 m");
    if (!(fabs(georef->y0) <= 1.1e7 && fabs(last_y) <= 1.1e7))
        return refuse("a UTM northing", fabs(last_y) <= 1.1e7 ? georef->y0 : last_y, "within 11000000 m");
    return RESULT_OK;
}

static Result check_georef(const DemGeoref *georef, int width, int height) {
    if (width < 2 || height < 2 || width > DEM_SIDE_MAX || height > DEM_SIDE_MAX) {
        log_error("grid: %d x %d samples, expected 2 to %d a side", width, height, DEM_SIDE_MAX);
        return RESULT_RANGE;
    }
    if (!isfinite(georef->x0) || !isfinite(georef->y0))
        return refuse("the origin", isfinite(georef->x0) ? georef->y0 : georef->x0, "a finite number");
    if (!isfinite(georef->dx) || georef->dx <= 0.0)
        return refuse("the column spacing", georef->dx, "more than 0");
    if (!isfinite(georef->dy) || georef->dy >= 0.0)
        return refuse("the row spacing", georef->dy, "less than 0 (north up)");
    return georef->crs == DEM_CRS_UTM ? check_utm(georef, width, height) : check_geographic(georef, width, height);
}

Result grid_create(const DemGeoref *georef, int width, int height, Grid **out) {
    Result result = check_georef(georef, width, height);
    if (result != RESULT_OK)
        return result;
    Grid *grid = calloc(1, sizeof *grid);
    if (!grid)
        return RESULT_MEMORY;
    grid->georef = *georef;
    grid->width = width;
    grid->height = height;
    result = georef->crs == DEM_CRS_UTM ? create_utm(grid) : create_geographic(grid);
    if (result != RESULT_OK) {
        grid_destroy(&grid);
        return result;
    }
    *out = grid;
    return RESULT_OK;
}

void grid_destroy(Grid **grid) {
    if (!*grid)
        return;
    free((*grid)->lon);
    free((*grid)->lat);
    free((*grid)->control);
    free((*grid)->col_weights);
    free((*grid)->row_weights);
    free(*grid);
    *grid = NULL;
}

static void base_geographic(const Grid *grid, int col, int row, Vec3d *point, Vec3d *normal) {
    LonTrig lon = grid->lon[col];
    LatTrig lat = grid->lat[row];
    *point = vec3d(lat.axis_m * lon.cos, lat.axis_m * lon.sin, lat.z_m);
    *normal = vec3d(lat.cos * lon.cos, lat.cos * lon.sin, lat.sin);
}

// The normal follows from the point: the gradient of the ellipsoid's equation.
static void base_utm(const Grid *grid, int col, int row, Vec3d *point, Vec3d *normal) {
    const Weights *across = &grid->col_weights[col], *down = &grid->row_weights[row];
    const Control *corner = &grid->control[down->first * grid->control_cols + across->first];
    double sum[4] = {0};
    for (int j = 0; j < 4; j++) {
        const Control *c = corner + j * grid->control_cols;
        for (int k = 0; k < 4; k++)
            sum[k] += down->w[j] * (across->w[0] * c[0].v[k] + across->w[1] * c[1].v[k] + across->w[2] * c[2].v[k] +
                                    across->w[3] * c[3].v[k]);
    }
    *point = vec3d(sum[0], sum[1], sum[2]);
    *normal = vec3d_normalize(vec3d(sum[0], sum[1], sum[2] * (1.0 / (1.0 - GEODESY_E2))));
}

void grid_base(const Grid *grid, int col, int row, Vec3d *point, Vec3d *normal) {
    if (grid->lon)
        base_geographic(grid, col, row, point, normal);
    else
        base_utm(grid, col, row, point, normal);
}

Vec3d grid_ecef(const Grid *grid, int col, int row, double h_m) {
    Vec3d point, normal;
    grid_base(grid, col, row, &point, &normal);
    return vec3d_mad(point, normal, h_m);
}

GridPoint grid_lattice(const Grid *grid, int col, int row, double h_m) {
    Vec3d p = grid_ecef(grid, col, row, h_m);
    return (GridPoint){llrint(p.x * GRID_LATTICE_PER_M), llrint(p.y * GRID_LATTICE_PER_M),
                       llrint(p.z * GRID_LATTICE_PER_M)};
}

void grid_geodetic(const Grid *grid, double col, double row, double *lat_deg, double *lon_deg) {
    const DemGeoref *georef = &grid->georef;
    double x = georef->x0 + georef->dx * col, y = georef->y0 + georef->dy * row;
    if (georef->crs == DEM_CRS_GEOGRAPHIC) {
        *lat_deg = y;
        *lon_deg = remainder(x, 360.0);
    } else if (geo_utm_reverse(georef->utm_zone, georef->utm_north, x, y, lat_deg, lon_deg) != RESULT_OK) {
        *lat_deg = *lon_deg = NAN;
    }
}

bool grid_from_geodetic(const Grid *grid, double lat_deg, double lon_deg, double *col, double *row) {
    const DemGeoref *georef = &grid->georef;
    double x, y;
    if (!isfinite(lat_deg) || !isfinite(lon_deg) || fabs(lat_deg) > 90.0)
        return false;
    if (georef->crs == DEM_CRS_GEOGRAPHIC) {
        double middle = georef->x0 + georef->dx * 0.5 * (grid->width - 1);
        x = middle + remainder(lon_deg - middle, 360.0);
        y = lat_deg;
    } else if (geo_utm_forward(georef->utm_zone, georef->utm_north, lat_deg, lon_deg, &x, &y) != RESULT_OK) {
        return false;
    }
    *col = (x - georef->x0) / georef->dx;
    *row = (y - georef->y0) / georef->dy;
    return true;
}

// ---- bounds ----

#define ROUNDING 1.000001 // what rounding, interpolation and M' can add, generously

typedef struct LatRange {
    double cos_max, sin_max;           // absolute values
    double axis_max_m, meridian_max_m; // radius of the largest parallel; meridian radius of curvature
} LatRange;

static LatRange lat_range(const Grid *grid, int row_begin, int row_end) {
    double a = grid->georef.y0 + grid->georef.dy * row_begin, b = grid->georef.y0 + grid->georef.dy * row_end;
    bool equator = (a < 0.0) != (b < 0.0), pole = fmax(fabs(a), fabs(b)) >= 90.0;
    LatTrig begin = lat_trig(a), end = lat_trig(b), nearest = lat_trig(0.0);
    if (!equator)
        nearest = fabs(begin.cos) > fabs(end.cos) ? begin : end;
    double sin_max = pole ? 1.0 : fmax(fabs(begin.sin), fabs(end.sin));
    double w = 1.0 - GEODESY_E2 * sin_max * sin_max;
    return (LatRange){.cos_max = fabs(nearest.cos),
                      .sin_max = sin_max,
                      .axis_max_m = fabs(nearest.axis_m),
                      .meridian_max_m = GEODESY_A_M * (1.0 - GEODESY_E2) / (w * sqrt(w))};
}

// The norm of s P_ll + 2 sqrt(s (1-s)) P_lp + (1-s) P_pp, largest over s in 0..1, where the second derivatives have the
// norms a, b, c, P_lp is perpendicular to the other two, and the product of P_ll and P_pp is at most `dot`.
// Its square is a quadratic in s that grows with each of a, b, c and dot.
static double largest_second_derivative(double a, double b, double c, double dot) {
    double quadratic = a * a + c * c - 2.0 * dot - 4.0 * b * b;
    double linear = 2.0 * dot + 4.0 * b * b - 2.0 * c * c;
    double most = fmax(a * a, c * c);
    if (quadratic < 0.0) {
        double s = -linear / (2.0 * quadratic);
        if (s > 0.0 && s < 1.0)
            most = fmax(most, (quadratic * s + linear) * s + c * c);
    }
    return sqrt(most);
}

// With l the longitude, p the latitude, M and N the radii of curvature: P_ll = -(N+h) cos p towards the axis,
// P_lp = -(M+h) sin p east, P_pp = -(M+h) up + M' north, and M' = 3 M e^2 sin p cos p / (1 - e^2 sin^2 p).
static GridBounds bounds_geographic(const Grid *grid, int row_begin, int row_end, double h_m) {
    LatRange range = lat_range(grid, row_begin, row_end);
    double dl = grid->georef.dx * GEODESY_RAD_PER_DEG, dp = fabs(grid->georef.dy) * GEODESY_RAD_PER_DEG;
    double axis_m = range.axis_max_m + h_m * range.cos_max, meridian_m = range.meridian_max_m + h_m;
    double change_m = 1.5 * GEODESY_E2 / (1.0 - GEODESY_E2) * range.meridian_max_m;
    double a = axis_m * dl * dl, b = meridian_m * range.sin_max * dl * dp;
    double c = hypot(meridian_m, change_m) * dp * dp;
    double dot = a * (meridian_m * range.cos_max + change_m) * dp * dp;
    return (GridBounds){.across_m = ROUNDING * axis_m * dl,
                        .down_m = ROUNDING * meridian_m * dp,
                        .bend_m = ROUNDING * largest_second_derivative(a, b, c, dot)};
}

// A conformal map of scale k >= 0.9996 turns a metre of grid into 1/k metres of ellipsoid. Along a straight line
// of the grid the second derivative has a normal part of at most 1 / (k^2 R) and a tangential one of |grad ln k| / k^2,
// which is x / R^2 at x from the central meridian: with x <= 500 km together less than 1.005 / R.
static GridBounds bounds_utm(const Grid *grid, double h_m) {
    double dx = grid->georef.dx, dy = fabs(grid->georef.dy);
    double raised = ROUNDING * (1.0 + h_m / RADIUS_MIN_M), longest = fmax(dx, dy) / UTM_SCALE_MIN;
    return (GridBounds){.across_m = raised * dx / UTM_SCALE_MIN,
                        .down_m = raised * dy / UTM_SCALE_MIN,
                        .bend_m = raised * 1.02 / RADIUS_MIN_M * longest * longest};
}

GridBounds grid_bounds(const Grid *grid, int row_begin, int row_end, double h_max_m) {
    double h_m = fmax(h_max_m, 0.0);
    return grid->lon ? bounds_geographic(grid, row_begin, row_end, h_m) : bounds_utm(grid, h_m);
}
