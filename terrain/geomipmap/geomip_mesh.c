// terrain/geomipmap/geomip_mesh.c: a tile's triangles. The body is the level's grid in both methods. De Boer 2000:
// towards a coarser neighbour the finer tile omits border vertices. Ye, Wang, section 3.2 and figure 7: towards a finer
// neighbour the coarser tile's border triangles become fans, in the four corners as well, to four neighbours of any
// level.
#include "terrain/geomipmap/geomip_mesh.h"

#include "terrain/geomipmap/geomip_zip.h"

typedef struct Writer {
    const GeomipOutline *outline;
    uint16_t *out;
} Writer;

static void put(Writer *w, int a, int b, int c) {
    *w->out++ = (uint16_t)a;
    *w->out++ = (uint16_t)b;
    *w->out++ = (uint16_t)c;
}

// ---- size and outline ----

GeomipSize geomip_mesh_size(const GeomipTiles *tiles, const int16_t *drawn, int32_t tile, GeomipBorder border) {
    int own = drawn[tile], cells = 1 << (tiles->tiles[tile].log_side - own / GEOMIP_LEVEL), points = 0;
    for (int32_t k = tiles->tiles[tile].first_link; k < tiles->tiles[tile + 1].first_link; k++) {
        const GeomipLink *link = &tiles->links[k];
        int stride = geomip_border_stride(border, own, geomip_level_beyond(drawn, link, own));
        points += (link->end - link->begin) >> forest_log2(stride);
    }
    int more = points > 4 * cells ? points - 4 * cells : 0, grid = (cells + 1) * (cells + 1);
    if (cells == 1)
        return more ? (GeomipSize){points, grid + more + 1} : (GeomipSize){2, grid};
    return (GeomipSize){2 * cells * cells - 4 * cells + points, grid + more};
}

static int grid_vertex(const GeomipOutline *o, int side, int t, int depth) {
    int col, row, shift = forest_log2(o->stride);
    geomip_turn(o->side, side, t, depth, &col, &row);
    return (row >> shift) * o->across + (col >> shift);
}

void geomip_mesh_outline(const GeomipTiles *tiles, const int16_t *drawn, int32_t tile, GeomipBorder border,
                         GeomipOutline *o) {
    int own = drawn[tile], side = 0;
    o->side = tiles->squares.squares[tile].side;
    o->stride = 1 << own / GEOMIP_LEVEL;
    o->across = o->side / o->stride + 1;
    o->count = 0;
    o->begin[0] = 0;
    o->vertex_count = o->across * o->across;
    for (int32_t k = tiles->tiles[tile].first_link; k < tiles->tiles[tile + 1].first_link; k++) {
        const GeomipLink *link = &tiles->links[k];
        int stride = geomip_border_stride(border, own, geomip_level_beyond(drawn, link, own));
        while (side < link->side)
            o->begin[++side] = o->count;
        for (int t = link->begin; t < link->end; t += stride) {
            bool on_grid = (t & (o->stride - 1)) == 0;
            o->t[o->count] = (int16_t)t;
            o->vertex[o->count++] = (uint16_t)(on_grid ? grid_vertex(o, side, t, 0) : o->vertex_count++);
        }
    }
    o->begin[GEOMIP_SIDES] = o->count;
    o->vertex[o->count] = o->vertex[0];
    o->star = o->across == 2 && o->count > 4;
    o->vertex_count += o->star;
}

// ---- body and strips ----

static void put_cell(Writer *w, int col, int row, bool rising) {
    int across = w->outline->across, nw = row * across + col, ne = nw + 1, sw = nw + across, se = sw + 1;
    put(w, rising ? ne : nw, rising ? nw : sw, rising ? sw : se);
    put(w, rising ? ne : nw, rising ? sw : se, rising ? se : ne);
}

// Within a tile of two cells or more a side, cells are numbered from its corner; its column and row are even.
static void put_body(Writer *w) {
    for (int row = 1; row < w->outline->across - 2; row++)
        for (int col = 1; col < w->outline->across - 2; col++)
            put_cell(w, col, row, (col + row) & 1);
}

// Ye: each border cell's triangle at the border is a fan from its inner corner; corner cells have two such.
static void put_fans(Writer *w, int side) {
    const GeomipOutline *o = w->outline;
    int point = o->begin[side], cells = o->across - 1;
    for (int cell = 0; cell < cells; cell++) {
        int begin = cell * o->stride, end = begin + o->stride, first = o->vertex[point];
        int apex = grid_vertex(o, side, cell & 1 ? begin : end, o->stride);
        for (; point < o->begin[side + 1] && o->t[point] < end; point++)
            put(w, o->vertex[point], apex, o->vertex[point + 1]);
        if (cell > 0 && cell < cells - 1)
            put(w, cell & 1 ? o->vertex[point] : first, grid_vertex(o, side, begin, o->stride),
                grid_vertex(o, side, end, o->stride));
    }
}

static void put_zip(Writer *w, int side) {
    const GeomipOutline *o = w->outline;
    int16_t outer[GEOMIP_ZIP_MAX];
    GeomipZip zip[GEOMIP_ZIP_MAX];
    int begin = o->begin[side], points = o->begin[side + 1] - begin;
    for (int i = 0; i < points; i++)
        outer[i] = o->t[begin + i];
    outer[points] = (int16_t)o->side;
    int count = geomip_zip(outer, points + 1, o->side, o->stride, zip);
    for (int i = 0; i < count; i++) {
        int at = begin + zip[i].at, inner = grid_vertex(o, side, zip[i].t, o->stride);
        int third = zip[i].outer ? o->vertex[at + 1] : grid_vertex(o, side, zip[i].t + o->stride, o->stride);
        put(w, o->vertex[at], inner, third);
    }
}

static void put_star(Writer *w) {
    const GeomipOutline *o = w->outline;
    for (int i = 0; i < o->count; i++)
        put(w, o->vertex[i], o->vertex_count - 1, o->vertex[i + 1]);
}

int32_t geomip_mesh_indices(const GeomipOutline *outline, const ForestTile *square, GeomipBorder border,
                            uint16_t *indices) {
    Writer w = {outline, indices};
    if (outline->star) {
        put_star(&w);
    } else if (outline->across == 2) {
        put_cell(&w, 0, 0, geomip_is_rising(square->col, square->row, outline->stride));
    } else {
        put_body(&w);
        for (int side = 0; side < GEOMIP_SIDES; side++)
            border == GEOMIP_FANNED ? put_fans(&w, side) : put_zip(&w, side);
    }
    return (int32_t)(w.out - indices);
}
