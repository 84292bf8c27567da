// terrain/geomipmap/geomip_page.c: Ye, Wang, section 3.3: vertices between two levels. All arithmetic is in whole
// lattice units, and symmetric in the ends of an edge, so that two tiles agree on their border.
#include "terrain/geomipmap/geomip_page.h"

#include "terrain/terrain_parts.h"

#include <stdlib.h>

// ---- memory ----

static int class_of(int vertex_count) {
    int size_class = 0;
    while (4 << size_class < vertex_count)
        size_class++;
    return size_class;
}

static GeomipPage *allocate(int size_class) {
    GeomipPage *page = calloc(1, sizeof *page);
    LodVertex *vertices = page ? malloc(sizeof *vertices * (size_t)(4 << size_class)) : NULL;
    if (!vertices) {
        free(page);
        return NULL;
    }
    page->shown.vertices = vertices;
    page->size_class = size_class;
    return page;
}

static void free_chain(GeomipPage *page) {
    while (page) {
        GeomipPage *next = page->next;
        free((void *)(uintptr_t)page->shown.vertices);
        free(page);
        page = next;
    }
}

void geomip_page_store_destroy(GeomipPageStore *store) {
    for (int i = 0; i < GEOMIP_PAGE_CLASSES; i++)
        free_chain(store->free_pages[i]);
    free_chain(store->retired);
    *store = (GeomipPageStore){0};
}

GeomipPage *geomip_page_take(GeomipPageStore *store, int vertex_count) {
    int size_class = class_of(vertex_count);
    GeomipPage *page = store->free_pages[size_class];
    if (page)
        store->free_pages[size_class] = page->next;
    else
        page = allocate(size_class);
    if (!page)
        return NULL;
    page->next = NULL;
    page->shown.id = ++store->next_id;
    page->shown.vertex_count = vertex_count;
    return page;
}

void geomip_page_retire(GeomipPageStore *store, GeomipPage *page, uint64_t last_frame) {
    if (!page)
        return;
    page->last_frame = last_frame;
    page->next = NULL;
    *(store->retired ? &store->retired_last->next : &store->retired) = page;
    store->retired_last = page;
}

void geomip_page_store_release(GeomipPageStore *store, uint64_t frame) {
    while (store->retired && store->retired->last_frame <= frame) {
        GeomipPage *page = store->retired;
        store->retired = page->next;
        page->next = store->free_pages[page->size_class];
        store->free_pages[page->size_class] = page;
    }
}

// ---- positions ----

typedef struct Filling {
    const GeomipTiles *tiles;
    const ForestTile *square;
    const GeomipOutline *outline;
    LodVertex *vertices;
    GridPoint origin;
} Filling;

static GridPoint sample_at(const Filling *f, int col, int row) {
    return terrain_point(f->tiles->terrain, f->square->col + col, f->square->row + row);
}

static int64_t weigh(int64_t a, int64_t b, int part, int shift) { // a + (b - a) part / 2^shift, rounded
    int64_t whole = (int64_t)1 << shift;
    return (a * (whole - part) + b * part + whole / 2) >> shift;
}

static GridPoint between(GridPoint a, GridPoint b, int part, int shift) {
    return (GridPoint){weigh(a.x, b.x, part, shift), weigh(a.y, b.y, part, shift), weigh(a.z, b.z, part, shift)};
}

// own + ((a + b) / 2 - own) steps / 256, rounded.
static int64_t approach(int64_t own, int64_t a, int64_t b, int steps) {
    return (2 * own * (256 - steps) + (a + b) * steps + 256) >> 9;
}

// So many steps from a vertex to the middle of the coarser edge (a, b).
static GridPoint morph(GridPoint own, GridPoint a, GridPoint b, int steps) {
    return (GridPoint){approach(own.x, a.x, b.x, steps), approach(own.y, a.y, b.y, steps),
                       approach(own.z, a.z, b.z, steps)};
}
_Static_assert(GEOMIP_LEVEL == 1 << 8, "approach counts steps of 1/256");

// ---- the border ----

static GridPoint side_sample(const Filling *f, int side, int t) {
    int col, row;
    geomip_turn(f->square->side, side, t, 0, &col, &row);
    return sample_at(f, col, row);
}

// A vertex of the border's own level.
static GridPoint line_vertex(const Filling *f, int side, int t, int level) {
    int stride = 1 << level / GEOMIP_LEVEL, steps = level % GEOMIP_LEVEL;
    GridPoint own = side_sample(f, side, t);
    if (!steps || !(t & stride))
        return own;
    return morph(own, side_sample(f, side, t - stride), side_sample(f, side, t + stride), steps);
}

// Any vertex of the border: between two of its level it lies on their line.
static GridPoint border_vertex(const Filling *f, int side, int t, int level) {
    int shift = level / GEOMIP_LEVEL, rest = t & ((1 << shift) - 1);
    if (!rest)
        return line_vertex(f, side, t, level);
    int begin = t - rest;
    return between(line_vertex(f, side, begin, level), line_vertex(f, side, begin + (1 << shift), level), rest, shift);
}

static void set_vertex(Filling *f, int vertex, int col, int row, GridPoint p) {
    f->vertices[vertex] = (LodVertex){(int32_t)(p.x - f->origin.x), (int32_t)(p.y - f->origin.y),
                                      (int32_t)(p.z - f->origin.z), (uint16_t)col, (uint16_t)row};
}

static GridPoint vertex_at(const Filling *f, int vertex) {
    const LodVertex *v = &f->vertices[vertex];
    return (GridPoint){f->origin.x + v->x, f->origin.y + v->y, f->origin.z + v->z};
}

static void fill_border(Filling *f, const int16_t *drawn, int32_t tile) {
    const GeomipTiles *tiles = f->tiles;
    const GeomipOutline *o = f->outline;
    int own = drawn[tile], point = 0;
    for (int32_t k = tiles->tiles[tile].first_link; k < tiles->tiles[tile + 1].first_link; k++) {
        const GeomipLink *link = &tiles->links[k];
        int level = geomip_border_level(own, geomip_level_beyond(drawn, link, own));
        for (; point < o->begin[link->side + 1] && o->t[point] < link->end; point++) {
            int col, row;
            geomip_turn(o->side, link->side, o->t[point], 0, &col, &row);
            set_vertex(f, o->vertex[point], col, row, border_vertex(f, link->side, o->t[point], level));
        }
    }
}

// ---- the inside ----

// The middle of the next level's edge on which a vertex lies that this level has and the next has not.
static void fill_odd(Filling *f, int i, int j, int steps) {
    const GeomipOutline *o = f->outline;
    int stride = o->stride, dx = i & 1, dy = j & 1;
    if (dx && dy && geomip_is_rising(f->square->col + i * stride, f->square->row + j * stride, 2 * stride))
        dy = -1;
    int vertex = j * o->across + i, step = dy * o->across + dx;
    GridPoint own = sample_at(f, i * stride, j * stride);
    if (steps)
        own = morph(own, vertex_at(f, vertex - step), vertex_at(f, vertex + step), steps);
    set_vertex(f, vertex, i * stride, j * stride, own);
}

static void fill_inside(Filling *f, int steps) {
    const GeomipOutline *o = f->outline;
    for (int odd = 0; odd < 2; odd++)
        for (int j = 1; j < o->across - 1; j++)
            for (int i = 1; i < o->across - 1; i++) {
                if (odd && (i | j) & 1)
                    fill_odd(f, i, j, steps);
                else if (!odd && !((i | j) & 1))
                    set_vertex(f, j * o->across + i, i * o->stride, j * o->stride,
                               sample_at(f, i * o->stride, j * o->stride));
            }
}

// The middle of a tile of two triangles, on their common edge.
static void fill_star(Filling *f) {
    const GeomipOutline *o = f->outline;
    bool rising = geomip_is_rising(f->square->col, f->square->row, o->side);
    GridPoint a = vertex_at(f, rising ? 1 : 0), b = vertex_at(f, rising ? 2 : 3);
    set_vertex(f, o->vertex_count - 1, o->side / 2, o->side / 2, between(a, b, 1, 1));
}

static void fill_sphere(GeomipPage *page, const Filling *f) {
    page->centre_ecef = grid_point_ecef(f->origin);
    page->radius_m = 0.0;
    for (int v = 0; v < page->shown.vertex_count; v++) {
        double d = vec3d_distance(grid_point_ecef(vertex_at(f, v)), page->centre_ecef) * (1.0 + 1e-12);
        page->radius_m = d > page->radius_m ? d : page->radius_m;
    }
}

void geomip_page_fill(GeomipPage *page, const GeomipTiles *tiles, const int16_t *drawn, int32_t tile,
                      const GeomipOutline *outline) {
    const ForestTile *square = &tiles->squares.squares[tile];
    Filling f = {tiles, square, outline, (LodVertex *)(uintptr_t)page->shown.vertices, {0}};
    GridPoint middle = sample_at(&f, square->side / 2, square->side / 2);
    f.origin = grid_whole_metres(middle);
    page->shown.origin = f.origin;
    page->shown.col0 = square->col;
    page->shown.row0 = square->row;
    fill_border(&f, drawn, tile);
    fill_inside(&f, drawn[tile] % GEOMIP_LEVEL);
    if (outline->star)
        fill_star(&f);
    fill_sphere(page, &f);
}
