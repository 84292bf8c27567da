#include "terrain/dem/dem_mosaic.h"

#include "base/log.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Files of one grid may be off by rounding: a hundredth of a sample.
#define GRID_TOLERANCE 0.01
// Neighbouring tiles may share so many rows or columns on purpose: SRTM has 1, USGS 12.
#define BORDER_STRIP 16

static Result refuse_other_grid(const DemSource *a, const DemSource *b, const char *what) {
    log_error("%s: %s than %s; files given together must be tiles of one grid; merge them first: gdalwarp -t_srs "
              "EPSG:4326 -r "
              "bilinear %s %s OUT.tif",
              b->path, what, a->path, a->path, b->path);
    return RESULT_RANGE;
}

static bool same_step(double a, double b, int samples) {
    return fabs(a - b) * samples <= GRID_TOLERANCE * fabs(a);
}

static Result check_same_kind(const DemSource *a, const DemSource *b) {
    const DemHeader *ha = &a->header, *hb = &b->header;
    const DemGeoref *ga = &ha->georef, *gb = &hb->georef;
    if (ga->crs != gb->crs || ga->utm_zone != gb->utm_zone || ga->utm_north != gb->utm_north)
        return refuse_other_grid(a, b, "it is in another coordinate system");
    if (!same_step(ga->dx, gb->dx, hb->width) || !same_step(ga->dy, gb->dy, hb->height))
        return refuse_other_grid(a, b, "its samples lie at another distance");
    if (ha->datum != hb->datum)
        return refuse_other_grid(a, b, "its heights are above another datum");
    return RESULT_OK;
}

// Samples from `a` to `b` along one axis; false where that is no whole number, or too many.
static bool whole_offset(double a, double b, double step, int *out) {
    double offset = (b - a) / step;
    *out = fabs(offset) < DEM_SIDE_MAX ? (int)lround(offset) : 0;
    return fabs(offset) < DEM_SIDE_MAX && fabs(offset - *out) <= GRID_TOLERANCE;
}

static Result find_place(const DemSource *first, const DemSource *source, DemPlace *out) {
    Result result = check_same_kind(first, source);
    if (result != RESULT_OK)
        return result;
    const DemGeoref *origin = &first->header.georef, *georef = &source->header.georef;
    // Tiles on both sides of the antimeridian are neighbours.
    double turns = origin->crs == DEM_CRS_GEOGRAPHIC ? round((georef->x0 - origin->x0) / 360.0) : 0.0;
    if (!whole_offset(origin->x0, georef->x0 - 360.0 * turns, origin->dx, &out->col) ||
        !whole_offset(origin->y0, georef->y0, origin->dy, &out->row))
        return refuse_other_grid(first, source, "its samples lie between those of the other, or farther");
    return RESULT_OK;
}

static bool touch_along(int a, int a_length, int b, int b_length) {
    return b <= a + a_length && a <= b + b_length;
}

// Sharing samples, or side by side without a gap; corners count.
static bool touch(const DemSource *a, DemPlace pa, const DemSource *b, DemPlace pb) {
    return touch_along(pa.col, a->header.width, pb.col, b->header.width) &&
           touch_along(pa.row, a->header.height, pb.row, b->header.height);
}

// A flood from the first file: whom it does not reach lies apart. `queue` and `reached`: `count` elements.
static int flood(const DemSource *sources, const DemPlace *places, int count, int *queue, bool *reached) {
    int found = 1;
    queue[0] = 0;
    reached[0] = true;
    for (int next = 0; next < found; next++)
        for (int i = 0; i < count; i++)
            if (!reached[i] && touch(&sources[queue[next]], places[queue[next]], &sources[i], places[i])) {
                reached[i] = true;
                queue[found++] = i;
            }
    return found;
}

static Result check_connected(const DemSource *sources, const DemPlace *places, int count) {
    int *queue = malloc((size_t)count * sizeof *queue);
    bool *reached = calloc((size_t)count, sizeof *reached);
    Result result = queue && reached ? RESULT_OK : RESULT_MEMORY;
    if (result == RESULT_OK && flood(sources, places, count, queue, reached) < count) {
        int apart = 0;
        while (reached[apart])
            apart++;
        log_error(
            "%s: it touches none of the other files, %s among them; give adjacent tiles, or fly over one at a time",
            sources[apart].path, sources[0].path);
        result = RESULT_RANGE;
    }
    free(reached);
    free(queue);
    return result;
}

static Result set_extent(const DemSource *sources, int count, DemHeader *out, DemPlace *places) {
    int col0 = 0, row0 = 0, col1 = 0, row1 = 0;
    for (int i = 0; i < count; i++) {
        int right = places[i].col + sources[i].header.width, bottom = places[i].row + sources[i].header.height;
        col0 = places[i].col < col0 ? places[i].col : col0;
        row0 = places[i].row < row0 ? places[i].row : row0;
        col1 = right > col1 ? right : col1;
        row1 = bottom > row1 ? bottom : row1;
    }
    if (col1 - col0 > DEM_SIDE_MAX || row1 - row0 > DEM_SIDE_MAX) {
        log_error("%s: together the files span %d x %d samples; at most %d a side; give fewer", sources[0].path,
                  col1 - col0, row1 - row0, DEM_SIDE_MAX);
        return RESULT_RANGE;
    }
    for (int i = 0; i < count; i++)
        places[i] = (DemPlace){places[i].col - col0, places[i].row - row0};
    out->width = col1 - col0;
    out->height = row1 - row0;
    out->georef.x0 += col0 * out->georef.dx;
    out->georef.y0 += row0 * out->georef.dy;
    return RESULT_OK;
}

static int shared_along(int a, int a_length, int b, int b_length) {
    int end = a + a_length < b + b_length ? a + a_length : b + b_length;
    return end - (a > b ? a : b);
}

// More than a border, or all of one.
static bool overlap(const DemSource *a, DemPlace pa, const DemSource *b, DemPlace pb) {
    int cols = shared_along(pa.col, a->header.width, pb.col, b->header.width);
    int rows = shared_along(pa.row, a->header.height, pb.row, b->header.height);
    if (cols <= 0 || rows <= 0)
        return false;
    bool within =
        (cols == a->header.width && rows == a->header.height) || (cols == b->header.width && rows == b->header.height);
    return within || (cols > BORDER_STRIP && rows > BORDER_STRIP);
}

// Harmless, but hardly meant: one message, however many there are.
static void warn_of_overlaps(const DemSource *sources, const DemPlace *places, int count) {
    for (int i = 0; i < count; i++)
        for (int j = i + 1; j < count; j++) {
            if (!overlap(&sources[i], places[i], &sources[j], places[j]))
                continue;
            if (strcmp(sources[i].path, sources[j].path) == 0)
                log_warn("%s: given more than once", sources[i].path);
            else
                log_warn("%s and %s overlap; where they do, the heights of %s are taken", sources[i].path,
                         sources[j].path, sources[i].path);
            return;
        }
}

Result dem_mosaic_layout(const DemSource *sources, int count, DemHeader *out, DemPlace *places) {
    Result result = RESULT_OK;
    *out = sources[0].header;
    for (int i = 0; i < count && result == RESULT_OK; i++) {
        result = find_place(&sources[0], &sources[i], &places[i]);
        out->datum_assumed |= sources[i].header.datum_assumed;
    }
    if (result == RESULT_OK)
        result = check_connected(sources, places, count);
    if (result == RESULT_OK)
        result = set_extent(sources, count, out, places);
    if (result == RESULT_OK)
        warn_of_overlaps(sources, places, count);
    return result == RESULT_OK ? dem_source_check_georef(sources[0].path, out) : result;
}
