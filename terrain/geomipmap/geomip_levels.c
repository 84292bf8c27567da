// terrain/geomipmap/geomip_levels.c: de Boer 2000: the coarsest level whose distance D_m is reached. Ye, Wang,
// sections 3.1 and 3.3: the coarsest whose error the square of the ground distance allows, and the share of the way to
// the next. Our own: levels that keep every sample within the tolerance, whatever the borders.
#include "terrain/geomipmap/geomip_levels.h"

#include "terrain/geomipmap/geomip_mesh.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define GRAIN 64 // tiles at a time

typedef struct Choosing {
    const GeomipTiles *tiles;
    GeomipRule rule;
    Vec3d eye;
    Vec3d up;       // at the eye: the ground plane's normal
    double m_per_m; // tolerated metres a metre of distance: tau / px_per_rad
    GeomipLevels *levels;
    _Atomic int64_t triangles, steps; // of all tiles; below their caps
} Choosing;

// ---- distances and what they allow ----

static double centre_distance2(const Choosing *c, const GeomipTile *tile) {
    Vec3d to = vec3d_sub(tile->centre_ecef, c->eye);
    double rise = c->rule.ye ? vec3d_dot(to, c->up) : 0.0; // Ye: in the ground plane
    double d2 = vec3d_dot(to, to) - rise * rise;
    return d2 > 0.0 ? d2 : 0.0;
}

static double box_distance(const Choosing *c, const GeomipTile *tile) {
    GeomipFrame frame = geomip_frame(tile->centre_ecef);
    Vec3d to = vec3d_sub(c->eye, tile->centre_ecef);
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        double x = vec3d_dot(to, frame.axis[k]);
        double below = (double)tile->low[k] - x, above = x - (double)tile->high[k];
        double off = below > 0.0 ? below : above > 0.0 ? above : 0.0;
        sum += off * off;
    }
    return sqrt(sum);
}

// The error that a tile may have, in metres.
static double allowed_m(const Choosing *c, const GeomipTile *tile) {
    if (c->rule.bounds)
        return c->m_per_m * box_distance(c, tile);
    double d2 = centre_distance2(c, tile);
    return c->rule.ye ? c->m_per_m * c->m_per_m * d2 / c->rule.unit_m : c->m_per_m * sqrt(d2);
}

// ---- levels ----

static int morphed(double share) { // towards the finer level
    double steps = floor(share * GEOMIP_LEVEL);
    return !(steps > 0.0) ? 0 : steps < GEOMIP_LEVEL ? (int)steps : GEOMIP_LEVEL - 1;
}

// The coarsest level within what is allowed; Ye: and f = (delta - delta_n) / (delta_{n+1} - delta_n) beyond it.
static int wanted_level(const Choosing *c, int32_t i, double allowed) {
    const GeomipTiles *tiles = c->tiles;
    int level = tiles->tiles[i].cap;
    while (level > 0 && !((double)geomip_delta(tiles, i, level) <= allowed))
        level--;
    if (!c->rule.ye || level == tiles->tiles[i].cap)
        return level * GEOMIP_LEVEL;
    double fine = (double)geomip_delta(tiles, i, level), coarse = (double)geomip_delta(tiles, i, level + 1);
    return level * GEOMIP_LEVEL + morphed((allowed - fine) / (coarse - fine));
}

static void want(void *user, int64_t begin, int64_t end, int worker) {
    const Choosing *c = user;
    (void)worker;
    for (int64_t i = begin; i < end; i++) {
        c->levels->allowed_m[i] = allowed_m(c, &c->tiles->tiles[i]);
        c->levels->wanted[i] = (int16_t)wanted_level(c, (int32_t)i, c->levels->allowed_m[i]);
    }
}

// ---- what neighbours ask for ----

static double strip_at(const Choosing *c, int32_t tile, int side, int level, double f, int border) {
    double fine = (double)geomip_strip(c->tiles, tile, side, level, border);
    return f > 0.0 ? fine + f * ((double)geomip_strip(c->tiles, tile, side, level + 1, border) - fine) : fine;
}

// The bound of a tile at `own` whose side's border is drawn at `border` >= own. Each position is a linear function of
// either, so the error of a mesh between two levels is at most the mean of theirs.
static double side_bound(const Choosing *c, int32_t tile, int side, int own, int border) {
    int n = own / GEOMIP_LEVEL, m = border / GEOMIP_LEVEL;
    double f = (double)(own % GEOMIP_LEVEL) / GEOMIP_LEVEL, g = (double)(border % GEOMIP_LEVEL) / GEOMIP_LEVEL;
    if (n == m) { // both morph to the same level; the border is ahead
        double fine = (double)geomip_strip(c->tiles, tile, side, n, n);
        fine += g > f ? (g - f) * ((double)geomip_strip(c->tiles, tile, side, n, n + 1) - fine) : 0.0;
        return f > 0.0 ? fine + f * ((double)geomip_delta(c->tiles, tile, n + 1) - geomip_delta(c->tiles, tile, n))
                       : fine;
    }
    double fine = strip_at(c, tile, side, n, f, m);
    return g > 0.0 ? fine + g * (strip_at(c, tile, side, n, f, m + 1) - fine) : fine;
}

// Between two levels whose bounds are within and above what is allowed: the coarsest that is within. Bounds are linear
// in between; de Boer's levels are whole.
static int last_within(const Choosing *c, double allowed, int low, double low_m, int high, double high_m) {
    if (!c->rule.ye || !(allowed > low_m))
        return low;
    int steps = (int)floor((allowed - low_m) / (high_m - low_m) * (high - low));
    return low + (steps < high - low ? steps : high - low - 1);
}

// The coarsest level, up to `most`, that a tile stands its side's border at. What Ye's tile may morph away is given to
// its neighbours first, up to a whole level.
static int border_limit(const Choosing *c, int32_t tile, int side, int most) {
    double allowed = c->levels->allowed_m[tile];
    int own = c->levels->wanted[tile] - (c->rule.ye ? GEOMIP_LEVEL : 0);
    own = own > 0 ? own : 0;
    int low = own;
    double low_m = side_bound(c, tile, side, own, own);
    while (low < most) {
        int high = (low / GEOMIP_LEVEL + 1) * GEOMIP_LEVEL;
        double high_m = side_bound(c, tile, side, own, high);
        if (high_m > allowed) {
            int limit = last_within(c, allowed, low, low_m, high, high_m);
            return limit < most ? limit : most;
        }
        low = high;
        low_m = high_m;
    }
    return most;
}

static int level_within_limits(const Choosing *c, int32_t i) {
    const GeomipTiles *tiles = c->tiles;
    int level = c->levels->wanted[i];
    for (int32_t k = tiles->tiles[i].first_link; k < tiles->tiles[i + 1].first_link; k++) {
        const GeomipLink *link = &tiles->links[k];
        if (link->tile == GEOMIP_OUTSIDE || c->levels->wanted[link->tile] >= level)
            continue;
        int limit = border_limit(c, link->tile, (link->side + 2) % GEOMIP_SIDES, level);
        int least = c->levels->wanted[link->tile]; // at its own level's border a tile is within anyway
        level = limit > least ? limit : least;
    }
    return level;
}

static void limit(void *user, int64_t begin, int64_t end, int worker) {
    Choosing *c = user;
    (void)worker;
    for (int64_t i = begin; i < end; i++)
        c->levels->limited[i] = c->rule.bounds ? (int16_t)level_within_limits(c, (int32_t)i) : c->levels->wanted[i];
}

// Gives back what the borders of coarser neighbours need of a tile's morph.
static int level_beside(const Choosing *c, int32_t tile, int side, int border) {
    double allowed = c->levels->allowed_m[tile];
    int high = c->levels->limited[tile];
    double high_m = high < border ? side_bound(c, tile, side, high, border) : 0.0;
    while (high > 0 && high < border && high_m > allowed) {
        int low = (high - 1) / GEOMIP_LEVEL * GEOMIP_LEVEL;
        double low_m = side_bound(c, tile, side, low, border);
        if (low_m <= allowed)
            return last_within(c, allowed, low, low_m, high, high_m);
        high = low;
        high_m = low_m;
    }
    return high;
}

static void settle(void *user, int64_t begin, int64_t end, int worker) {
    Choosing *c = user;
    const GeomipTiles *tiles = c->tiles;
    (void)worker;
    for (int64_t i = begin; i < end; i++) {
        int level = c->levels->limited[i];
        for (int32_t k = tiles->tiles[i].first_link; k < tiles->tiles[i + 1].first_link; k++) {
            const GeomipLink *link = &tiles->links[k];
            int beyond = geomip_level_beyond(c->levels->limited, link, level);
            int beside = level_beside(c, (int32_t)i, link->side, beyond);
            level = beside < level ? beside : level;
        }
        c->levels->drawn[i] = (int16_t)level;
    }
}

static void count(void *user, int64_t begin, int64_t end, int worker) {
    Choosing *c = user;
    GeomipBorder border = c->rule.ye ? GEOMIP_FANNED : GEOMIP_OMITTED;
    int64_t triangles = 0, steps = 0;
    (void)worker;
    for (int64_t i = begin; i < end; i++) {
        triangles += geomip_mesh_size(c->tiles, c->levels->drawn, (int32_t)i, border).triangles;
        steps += c->tiles->tiles[i].cap * GEOMIP_LEVEL - c->levels->drawn[i];
    }
    atomic_fetch_add(&c->triangles, triangles);
    atomic_fetch_add(&c->steps, steps);
}

void geomip_levels_choose(const GeomipTiles *tiles, GeomipRule rule, Vec3d eye_ecef, double px_per_rad, double tau_px,
                          Jobs *jobs, GeomipLevels *levels) {
    Choosing choosing = {.tiles = tiles,
                         .rule = rule,
                         .eye = eye_ecef,
                         .up = geomip_frame(eye_ecef).axis[2],
                         .m_per_m = tau_px / px_per_rad,
                         .levels = levels};
    jobs_run(jobs, tiles->squares.count, GRAIN, want, &choosing);
    jobs_run(jobs, tiles->squares.count, GRAIN, limit, &choosing);
    if (rule.bounds)
        jobs_run(jobs, tiles->squares.count, GRAIN, settle, &choosing);
    else
        memcpy(levels->drawn, levels->limited, sizeof *levels->drawn * (size_t)tiles->squares.count);
    jobs_run(jobs, tiles->squares.count, GRAIN, count, &choosing);
    levels->triangles = choosing.triangles;
    levels->coarsest = choosing.steps == 0;
}

Result geomip_levels_create(int32_t tiles, GeomipLevels *out) {
    size_t n = (size_t)tiles;
    *out = (GeomipLevels){.drawn = calloc(n, sizeof *out->drawn),
                          .wanted = calloc(n, sizeof *out->wanted),
                          .limited = calloc(n, sizeof *out->limited),
                          .allowed_m = calloc(n, sizeof *out->allowed_m)};
    if (out->drawn && out->wanted && out->limited && out->allowed_m)
        return RESULT_OK;
    geomip_levels_destroy(out);
    return RESULT_MEMORY;
}

void geomip_levels_destroy(GeomipLevels *levels) {
    free(levels->drawn);
    free(levels->wanted);
    free(levels->limited);
    free(levels->allowed_m);
    *levels = (GeomipLevels){0};
}
