// Static patches of one tile agree along their borders by the nesting of their errors; with a remainder of smaller
// tiles beside, whose pages are deeper than a cell, they do not. There the cut is closed instead, as Yalcin, Weiss, De
// Floriani close selections that are not nested: upward, a level at a time, finest first.
#include "terrain/lod/lod_patch_seam.h"

#include "terrain/lod/lod_patch_tables.h"
#include "terrain/terrain_parts.h"

#include <stdlib.h>

#define SHOWN 4 // by a static patch on the border

typedef struct Place {
    int32_t col, row;
} Place;

static int step_log2(Place p) {
    return __builtin_ctz((unsigned)(p.col | p.row) | 1u << FOREST_LEVEL_MAX);
}

static bool is_centre(Place p, int k) {
    return p.col >> k & p.row >> k & 1;
}

static size_t sample_of(const PatchSeam *seam, Place p) {
    return (size_t)p.row * (size_t)seam->width + (size_t)p.col;
}

static Place place_of(const PatchSeam *seam, int32_t sample) {
    return (Place){sample % seam->width, sample / seam->width};
}

// Of the tile that holds a cell; 0 outside the DEM.
static int32_t side_at(const PatchSeam *seam, int32_t col, int32_t row) {
    int32_t square = square_grid_at(&seam->squares, col, row);
    return square < 0 ? 0 : seam->tile_sides[square];
}

static void add(PatchSeam *seam, SeamList *list, int32_t sample) {
    if (!seam_list_add(list, sample))
        seam->out_of_memory = true;
}

#define TOUCHED_NOW 1
#define TOUCHED_BEFORE 2

static void touch(PatchSeam *seam, Place p) {
    for (int c = 0; c < 4; c++) {
        int32_t square = square_grid_at(&seam->squares, p.col - (c & 1), p.row - (c >> 1));
        if (square >= 0)
            seam->touched[square] |= TOUCHED_NOW;
    }
}

bool seam_is_touched(const PatchSeam *seam, int32_t square) {
    return seam->touched[square];
}

void seam_settle(PatchSeam *seam) {
    for (int32_t i = 0; i < seam->squares.count; i++)
        seam->touched[i] &= TOUCHED_NOW;
}

void seam_set_by_error(PatchSeam *seam, int32_t col, int32_t row, bool active) {
    uint8_t *mark = &seam->marks[sample_of(seam, (Place){col, row})];
    *mark = (uint8_t)(active ? *mark | SEAM_BY_ERROR : *mark & ~SEAM_BY_ERROR);
}

// What is active by its error has its ancestors active, and static patches that show it: errors are nested.
static void activate(PatchSeam *seam, Place p, uint8_t bits) {
    int k = step_log2(p);
    if (k >= FOREST_LEVEL_MAX) // a corner of every tile around it
        return;
    size_t sample = sample_of(seam, p);
    if (!bits && seam->marks[sample] & SEAM_BY_ERROR)
        return;
    touch(seam, p);
    if (!(seam->marks[sample] & SEAM_ACTIVE))
        add(seam, &seam->vertices[2 * k + is_centre(p, k)], (int32_t)sample);
    seam->marks[sample] |= SEAM_ACTIVE | bits;
}

void seam_activate(PatchSeam *seam, int32_t col, int32_t row) {
    activate(seam, (Place){col, row}, 0);
}

static uint8_t *split_at(const PatchSeam *seam, Place p) {
    int k = step_log2(p), plane = k - forest_log2(seam->side);
    return &seam->split[plane][seam_plane_entry(seam, plane, p.col, p.row)];
}

static void split(PatchSeam *seam, Place p) {
    uint8_t *bit = split_at(seam, p);
    int k = step_log2(p);
    if (!*bit)
        add(seam, &seam->patches[2 * (k - forest_log2(seam->side)) + is_centre(p, k)], (int32_t)sample_of(seam, p));
    *bit = 1;
}

void seam_begin(PatchSeam *seam) {
    for (int32_t i = 0; i < seam->squares.count; i++)
        seam->touched[i] = seam->touched[i] ? TOUCHED_BEFORE : 0;
    for (int level = 0; level < SEAM_LEVELS; level++) {
        SeamList *vertices = &seam->vertices[level], *patches = &seam->patches[level];
        for (int32_t i = 0; i < vertices->count; i++)
            seam->marks[vertices->samples[i]] &= (uint8_t) ~(SEAM_ACTIVE | SHOWN);
        for (int32_t i = 0; i < patches->count; i++)
            *split_at(seam, place_of(seam, patches->samples[i])) = 0;
        vertices->count = patches->count = 0;
    }
    for (int32_t i = 0; i < seam->shown.count; i++)
        activate(seam, place_of(seam, seam->shown.samples[i]), SHOWN);
    for (int32_t i = 0; i < seam->corners.count; i++)
        split(seam, place_of(seam, seam->corners.samples[i]));
}

// Closing ------------------------------------------------------------------------------------------------------

// The parents of a vertex: the apexes of its two triangles; and for each a cell of that triangle's side.
typedef struct Parents {
    Place at[2], cell[2];
} Parents;

static Parents parents_of(Place p, int k) {
    int32_t s = 1 << k;
    if (!is_centre(p, k)) {
        bool along_row = p.col >> k & 1;
        Place a = along_row ? (Place){p.col, p.row - s} : (Place){p.col - s, p.row};
        Place b = along_row ? (Place){p.col, p.row + s} : (Place){p.col + s, p.row};
        return (Parents){{a, b}, {along_row ? (Place){p.col, p.row - 1} : (Place){p.col - 1, p.row}, p}};
    }
    bool falling = !((p.col >> (k + 1) ^ p.row >> (k + 1)) & 1); // hypotenuse from (-s, -s) to (s, s)
    int32_t turn = falling ? s : -s;
    return (Parents){{{p.col + turn, p.row - s}, {p.col - turn, p.row + s}}, {p, p}};
}

static void close_patch(PatchSeam *seam, Place m) {
    int k = step_log2(m);
    Parents parents = parents_of(m, k);
    int32_t sides[2];
    for (int i = 0; i < 2; i++) {
        sides[i] = side_at(seam, parents.cell[i].col, parents.cell[i].row);
        bool splits_there = sides[i] >= seam->static_side && sides[i] > 1 << k;
        if (splits_there && 1 << step_log2(parents.at[i]) < sides[i])
            split(seam, parents.at[i]);
    }
    if (is_centre(m, k) || sides[0] == sides[1]) // not on the border of tiles of two sizes
        return;
    int32_t cells = (1 << k) / seam->side; // between a vertex that the split shows and its neighbours
    for (int32_t along = cells - (1 << k); along < 1 << k; along += 2 * cells) {
        Place p = m.col >> k & 1 ? (Place){m.col + along, m.row} : (Place){m.col, m.row + along};
        if (seam->marks[sample_of(seam, p)] & SEAM_BORDER)
            activate(seam, p, SHOWN);
    }
}

// The patch that shows a border vertex only when it splits has its hypotenuse on the border, `side` times as long as
// the vertex's.
static void show(PatchSeam *seam, Place p, int k, const Parents *parents) {
    int32_t step = seam->side << k;
    for (int i = 0; i < 2; i++) {
        int32_t side = side_at(seam, parents->cell[i].col, parents->cell[i].row);
        if (side < seam->static_side || 2 * step > side)
            continue;
        bool along_row = p.col >> k & 1;
        int32_t x = along_row ? p.col : p.row, middle = (x & -(2 * step)) + step;
        split(seam, along_row ? (Place){middle, p.row} : (Place){p.col, middle});
    }
}

static void close_vertex(PatchSeam *seam, int32_t sample) {
    Place p = place_of(seam, sample);
    int k = step_log2(p);
    Parents parents = parents_of(p, k);
    if ((seam->marks[sample] & (SEAM_BORDER | SHOWN)) == SEAM_BORDER)
        show(seam, p, k, &parents);
    for (int i = 0; i < 2; i++) {
        int32_t side = side_at(seam, parents.cell[i].col, parents.cell[i].row);
        if (side < seam->static_side && side > 1 << k)
            activate(seam, parents.at[i], 0);
    }
}

Result seam_close(PatchSeam *seam) {
    for (int level = 0; level < SEAM_LEVELS; level++) {
        SeamList *patches = &seam->patches[level], *vertices = &seam->vertices[level];
        // Either may add to the other at this level, and to both at coarser ones.
        for (int32_t m = 0, v = 0; m < patches->count || v < vertices->count;) {
            if (m < patches->count)
                close_patch(seam, place_of(seam, patches->samples[m++]));
            else
                close_vertex(seam, vertices->samples[v++]);
        }
    }
    bool failed = seam->out_of_memory;
    seam->out_of_memory = false;
    return failed ? RESULT_MEMORY : RESULT_OK;
}

// Selecting ----------------------------------------------------------------------------------------------------

typedef struct Asking {
    PatchSeam *seam;
    const SeamView *view; // NULL: as split before
} Asking;

bool seam_is_static(const PatchSeam *seam, const ForestTile *tile) {
    return tile->side >= seam->static_side;
}

static bool view_splits(const Asking *asking, PatchCorner middle) {
    const PatchSeam *seam = asking->seam;
    int k = step_log2((Place){middle.col, middle.row}), plane = k - forest_log2(seam->side);
    const PatchVertex *vertex = patch_forest_vertex(&seam->terrain->patches, middle);
    const SeamSphere *sphere = &seam->spheres[plane][seam_plane_entry(seam, plane, middle.col, middle.row)];
    return 1 << k > seam->widest_step ||
           (seam_view_matters(asking->view, sphere->delta) &&
            refine_is_active(&asking->view->view, vertex->position, sphere->delta, sphere->radius));
}

static bool splits(void *user, const PatchTile *tile, PatchCorner middle) {
    const Asking *asking = user;
    Place m = {middle.col, middle.row};
    if (!seam_is_static(asking->seam, &tile->tile) || *split_at(asking->seam, m))
        return true;
    if (!asking->view || !view_splits(asking, middle))
        return false;
    split(asking->seam, m);
    return true;
}

Result seam_split(PatchSeam *seam, const SeamView *view, int32_t count_max, PatchSelection *out) {
    Asking asking = {seam, view};
    return patch_select_where(&seam->terrain->patches, splits, &asking, count_max, out);
}

Result seam_select(PatchSeam *seam, int32_t count_max, PatchSelection *out) {
    Asking asking = {seam, NULL};
    return patch_select_where(&seam->terrain->patches, splits, &asking, count_max, out);
}
