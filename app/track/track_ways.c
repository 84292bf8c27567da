// Ways are sought on a coarse grid of mean heights, by sweeping costs over it until none falls any more (Zhao 2005,
// fast sweeping, on the eight neighbours of each node).
#include "app/track/track_ways.h"

#include "base/log.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NODES_MAX 96    // a side
#define RIM 0.08        // of the sides: ways keep so far away from the edges
#define LOOKS 8         // samples a node side whose mean is its height
#define LEAST_COST 0.02 // a metre where the ground is best, in parts of the worst
#define SMOOTHINGS 6

typedef struct Nodes {
    const Terrain *terrain;
    int width, height;
    double col_step, row_step, col0, row0; // samples
    double across_m, down_m;               // between nodes
    double h_m[NODES_MAX * NODES_MAX], cost[NODES_MAX * NODES_MAX];
    int32_t from[NODES_MAX * NODES_MAX]; // the node before on the cheapest way; -1: none
} Nodes;

void track_cell_m(const Terrain *terrain, double *across_m, double *down_m) {
    const Dem *dem = terrain_dem(terrain);
    const Grid *grid = terrain_grid(terrain);
    int col = dem->width / 2 < dem->width - 1 ? dem->width / 2 : 0;
    int row = dem->height / 2 < dem->height - 1 ? dem->height / 2 : 0;
    Vec3d here = grid_ecef(grid, col, row, 0.0);
    *across_m = vec3d_distance(here, grid_ecef(grid, col + 1, row, 0.0));
    *down_m = vec3d_distance(here, grid_ecef(grid, col, row + 1, 0.0));
}

double track_ground_m(const Terrain *terrain, double col, double row) {
    const Dem *dem = terrain_dem(terrain);
    col = fmin(fmax(col, 0.0), dem->width - 1.0);
    row = fmin(fmax(row, 0.0), dem->height - 1.0);
    int i = (int)fmin(col, dem->width - 2), j = (int)fmin(row, dem->height - 2);
    const float *h = dem->height_m + (size_t)j * (size_t)dem->width + (size_t)i;
    double u = col - i, v = row - j;
    return (1.0 - v) * ((1.0 - u) * (double)h[0] + u * (double)h[1]) +
           v * ((1.0 - u) * (double)h[dem->width] + u * (double)h[dem->width + 1]);
}

// False where nothing around the node has data.
static bool mean_height(const Nodes *n, int x, int y, double *h_m) {
    const Dem *dem = terrain_dem(n->terrain);
    double sum = 0.0;
    int count = 0;
    for (int k = 0; k < LOOKS * LOOKS; k++) {
        int col = (int)(n->col0 + n->col_step * (x + (k % LOOKS + 0.5) / LOOKS - 0.5));
        int row = (int)(n->row0 + n->row_step * (y + (k / LOOKS + 0.5) / LOOKS - 0.5));
        if (col < 0 || row < 0 || col >= dem->width || row >= dem->height || dem_is_void(dem, col, row))
            continue;
        sum += dem->height_m[(size_t)row * (size_t)dem->width + (size_t)col];
        count++;
    }
    *h_m = count ? sum / count : NAN;
    return count > 0;
}

static int nodes_of(double samples) {
    return (int)fmin(fmax(samples, 2.0), NODES_MAX);
}

static bool fill_heights(Nodes *n, double *least, double *most) {
    *least = INFINITY;
    *most = -INFINITY;
    for (int i = 0; i < n->width * n->height; i++) {
        if (!mean_height(n, i % n->width, i / n->width, &n->h_m[i]))
            continue;
        *least = fmin(*least, n->h_m[i]);
        *most = fmax(*most, n->h_m[i]);
    }
    return *least <= *most;
}

// Heights become costs a metre, 1 where they are worst; where there is no data, as bad.
static bool measure_nodes(Nodes *n, TrackKeep keep) {
    const Dem *dem = terrain_dem(n->terrain);
    double cols = (dem->width - 1) * (1.0 - 2.0 * RIM), rows = (dem->height - 1) * (1.0 - 2.0 * RIM), least, most;
    n->width = nodes_of(cols);
    n->height = nodes_of(rows);
    n->col0 = (dem->width - 1) * RIM;
    n->row0 = (dem->height - 1) * RIM;
    n->col_step = cols / (n->width - 1);
    n->row_step = rows / (n->height - 1);
    track_cell_m(n->terrain, &n->across_m, &n->down_m);
    n->across_m *= n->col_step;
    n->down_m *= n->row_step;
    if (!fill_heights(n, &least, &most))
        return false;
    for (int i = 0; i < n->width * n->height; i++) {
        double share = most > least ? (n->h_m[i] - least) / (most - least) : 0.0;
        share = keep == TRACK_KEEP_HIGH ? 1.0 - share : share;
        n->h_m[i] = isnan(share) ? 1.0 : LEAST_COST + (1.0 - LEAST_COST) * share * share;
    }
    return true;
}

static bool relax(Nodes *n, int x, int y) {
    int here = y * n->width + x;
    bool fell = false;
    for (int k = 0; k < 9; k++) {
        int dx = k % 3 - 1, dy = k / 3 - 1, nx = x + dx, ny = y + dy, there = ny * n->width + nx;
        if (nx < 0 || ny < 0 || nx >= n->width || ny >= n->height || there == here)
            continue;
        double way = hypot(dx * n->across_m, dy * n->down_m);
        double cost = n->cost[there] + 0.5 * way * (n->h_m[here] + n->h_m[there]);
        if (cost < n->cost[here]) {
            n->cost[here] = cost;
            n->from[here] = there;
            fell = true;
        }
    }
    return fell;
}

static bool sweep(Nodes *n, bool eastward, bool southward) {
    bool fell = false;
    for (int j = 0; j < n->height; j++)
        for (int i = 0; i < n->width; i++)
            fell |= relax(n, eastward ? i : n->width - 1 - i, southward ? j : n->height - 1 - j);
    return fell;
}

static bool is_wide(const Nodes *n) {
    return n->width * n->across_m >= n->height * n->down_m;
}

// Any node of the first side is a start, each at the cost of its own ground: so the best place to begin is found too.
static void spread_costs(Nodes *n) {
    for (int i = 0; i < n->width * n->height; i++) {
        bool start = is_wide(n) ? i % n->width == 0 : i / n->width == 0;
        n->cost[i] = start ? n->h_m[i] * (n->across_m + n->down_m) : INFINITY;
        n->from[i] = -1;
    }
    for (bool fell = true; fell;) {
        fell = false;
        for (int direction = 0; direction < 4; direction++)
            fell |= sweep(n, direction & 1, direction & 2);
    }
}

static int cheapest_end(const Nodes *n) {
    int best = n->width * n->height - 1;
    int count = is_wide(n) ? n->height : n->width;
    for (int k = 0; k < count; k++) {
        int i = is_wide(n) ? k * n->width + n->width - 1 : (n->height - 1) * n->width + k;
        best = n->cost[i] < n->cost[best] ? i : best;
    }
    return best;
}

// From the end to the start, then turned round.
static void trace(const Nodes *n, TrackWay *out) {
    int nodes[TRACK_WAY_MAX], count = 0;
    for (int i = cheapest_end(n); i >= 0 && count < TRACK_WAY_MAX; i = n->from[i])
        nodes[count++] = i;
    out->count = count;
    for (int i = 0; i < count; i++) {
        out->col[i] = n->col0 + n->col_step * (nodes[count - 1 - i] % n->width);
        out->row[i] = n->row0 + n->row_step * (nodes[count - 1 - i] / n->width);
    }
}

static void smooth(double *values, int count) {
    double before = values[0];
    for (int i = 1; i + 1 < count; i++) {
        double here = values[i];
        values[i] = 0.25 * before + 0.5 * here + 0.25 * values[i + 1];
        before = here;
    }
}

static double leg_m(const TrackWay *way, int i, double across_m, double down_m) {
    return hypot((way->col[i + 1] - way->col[i]) * across_m, (way->row[i + 1] - way->row[i]) * down_m);
}

double track_way_m(const Terrain *terrain, const TrackWay *way) {
    double across, down, sum = 0.0;
    track_cell_m(terrain, &across, &down);
    for (int i = 0; i + 1 < way->count; i++)
        sum += leg_m(way, i, across, down);
    return sum;
}

// TRACK_WAY_MAX points at equal distances.
static void spread_evenly(const Terrain *terrain, const TrackWay *way, TrackWay *out) {
    double across, down, passed = 0.0, whole = track_way_m(terrain, way);
    int leg = 0;
    track_cell_m(terrain, &across, &down);
    out->count = TRACK_WAY_MAX;
    for (int i = 0; i < TRACK_WAY_MAX; i++) {
        double at = whole * i / (TRACK_WAY_MAX - 1);
        while (leg + 2 < way->count && passed + leg_m(way, leg, across, down) < at)
            passed += leg_m(way, leg++, across, down);
        double length = leg_m(way, leg, across, down);
        double share = length > 0.0 ? fmin((at - passed) / length, 1.0) : 0.0;
        out->col[i] = way->col[leg] + share * (way->col[leg + 1] - way->col[leg]);
        out->row[i] = way->row[leg] + share * (way->row[leg + 1] - way->row[leg]);
    }
}

// Corners are rounded over about an eighth of the way's points, then points are spread once more.
void track_way_through(const Terrain *terrain, const TrackWay *points, TrackWay *out) {
    TrackWay fine;
    spread_evenly(terrain, points, &fine);
    for (int k = 0; k < SMOOTHINGS * 16; k++) {
        smooth(fine.col, fine.count);
        smooth(fine.row, fine.count);
    }
    spread_evenly(terrain, &fine, out);
}

Result track_way_across(const Terrain *terrain, TrackKeep keep, TrackWay *out) {
    Nodes *nodes = calloc(1, sizeof *nodes);
    if (!nodes) {
        log_error("no memory to plan a flight");
        return RESULT_MEMORY;
    }
    nodes->terrain = terrain;
    bool has_data = measure_nodes(nodes, keep);
    if (has_data) {
        TrackWay traced;
        spread_costs(nodes);
        trace(nodes, &traced);
        track_way_through(terrain, &traced, out);
    } else {
        log_error("%s: not one sample has data; nowhere to fly", terrain_dem(terrain)->file);
    }
    free(nodes);
    return has_data ? RESULT_OK : RESULT_RANGE;
}
