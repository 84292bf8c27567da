// terrain/grid.h: from grid positions of one DEM to Earth-centred positions. One function per DEM: everything that
// is drawn, measured or collided with goes through it.
// Columns east, rows south, from sample (0, 0); metres above the ellipsoid; ECEF metres, and the lattice:
// integers in units of GRID_LATTICE_M, in which positions are exact in any patch.
// A Grid owns its tables; after creation any thread may read it.
#pragma once
#include "base/base.h"
#include "base/vec.h"
#include "terrain/dem/dem.h"

#define GRID_LATTICE_PER_M 4096 // 2^12: an int32 offset reaches 524 km
#define GRID_LATTICE_M (1.0 / GRID_LATTICE_PER_M)

typedef struct Grid Grid;
typedef struct GridPoint {
    int64_t x, y, z; // ECEF in units of GRID_LATTICE_M
} GridPoint;

// RANGE, with a message: not 2..DEM_SIDE_MAX samples a side, spacing not dx > 0 > dy, latitudes more than a row beyond
// a pole, more than 360 degrees, or outside the UTM zone's domain; MEMORY.
MUST_USE Result grid_create(const DemGeoref *georef, int width, int height, Grid **out);
void grid_destroy(Grid **grid);

// Exact for geographic grids, up to double rounding (1e-8 m); for UTM an interpolant within 1 mm of GeographicLib.
// The same arguments give the same bits, and so does a geographic DEM shifted by 360 degrees.
Vec3d grid_ecef(const Grid *grid, int col, int row, double h_m);
// The point of the ellipsoid and the unit normal there; grid_ecef is point + h * normal.
void grid_base(const Grid *grid, int col, int row, Vec3d *point, Vec3d *normal);
// grid_ecef rounded to the lattice: the position that is drawn and decided upon.
GridPoint grid_lattice(const Grid *grid, int col, int row, double h_m);
static inline Vec3d grid_point_ecef(GridPoint p) {
    return (Vec3d){(double)p.x * GRID_LATTICE_M, (double)p.y * GRID_LATTICE_M, (double)p.z * GRID_LATTICE_M};
}
// Towards zero, to whole metres: the origin of a page near by. Pages of one neighbourhood may share one, none needs to.
static inline GridPoint grid_whole_metres(GridPoint p) {
    return (GridPoint){p.x / GRID_LATTICE_PER_M * GRID_LATTICE_PER_M, p.y / GRID_LATTICE_PER_M * GRID_LATTICE_PER_M,
                       p.z / GRID_LATTICE_PER_M * GRID_LATTICE_PER_M};
}

// Degrees of a fractional grid position (longitude -180..180; NaN outside the projection's domain), and back;
// longitudes are taken modulo 360 towards the DEM's middle. False outside the projection's domain; the result may
// lie outside the grid.
void grid_geodetic(const Grid *grid, double col, double row, double *lat_deg, double *lon_deg);
bool grid_from_geodetic(const Grid *grid, double lat_deg, double lon_deg, double *col, double *row);

// Upper bounds over rows row_begin..row_end (inclusive) and heights up to h_max_m, for the error fields: the
// distance between horizontal neighbours (across, metres a column) and vertical ones (down, metres a row) at one
// height, and the norm of the second derivative of the map along any unit direction of (col, row), metres per squared
// cell: between vertices within a circle of rho cells, linear interpolation is off by at most bend_m rho^2 / 2.
typedef struct GridBounds {
    double across_m, down_m, bend_m;
} GridBounds;
GridBounds grid_bounds(const Grid *grid, int row_begin, int row_end, double h_max_m);
