#include "tests/geomip_support.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

#define SEED UINT64_C(20001031)

static const DemGeoref GEOREF = {DEM_CRS_GEOGRAPHIC, 0, false, 12.3, 46.9, 0.0006, -0.0004};

GeomipGround geomip_support_ground(int width, int height, int side, GeomipBorder border, bool bounds) {
    GeomipGround g = {0};
    assert_int_equal(jobs_create(2, &g.jobs), RESULT_OK);
    g.terrain = support_terrain(support_rough_dem(width, height, &GEOREF, 900.0, SEED), TERRAIN_ERROR_TOTAL, 4, g.jobs);
    GeomipInput input = {g.terrain, side, border, bounds};
    assert_int_equal(geomip_tiles_create(&input, g.jobs, &g.tiles), RESULT_OK);
    return g;
}

void geomip_support_ground_end(GeomipGround *g) {
    geomip_tiles_destroy(&g->tiles);
    terrain_destroy(&g->terrain);
    jobs_destroy(&g->jobs);
}

static LodItem draw_tile(GeomipDrawn *d, const GeomipGround *g, const int16_t *levels, int32_t tile,
                         GeomipBorder border) {
    GeomipOutline outline;
    GeomipSize size = geomip_mesh_size(&g->tiles, levels, tile, border);
    geomip_mesh_outline(&g->tiles, levels, tile, border, &outline);
    uint16_t *indices = malloc(sizeof *indices * 3 * (size_t)size.triangles);
    assert_non_null(indices);
    int32_t count = geomip_mesh_indices(&outline, &g->tiles.squares.squares[tile], border, indices);
    assert_int_equal(count, 3 * size.triangles);
    LodItem item = {.indices = indices, .index_count = count};
    if (border == GEOMIP_FANNED) {
        GeomipPage *page = geomip_page_take(&d->pages, size.vertices);
        assert_non_null(page);
        assert_int_equal(outline.vertex_count, size.vertices);
        geomip_page_fill(page, &g->tiles, levels, tile, &outline);
        item.page = &page->shown;
    } else {
        SquarePage *page = square_page_take(&d->squares, tile, outline.stride, 1);
        assert_non_null(page);
        square_page_fill(page, &g->tiles.squares, g->terrain);
        item.page = &page->shown;
    }
    return item;
}

GeomipDrawn geomip_support_draw(const GeomipGround *g, const int16_t *levels, GeomipBorder border) {
    int32_t count = g->tiles.squares.count;
    GeomipDrawn d = {.items = malloc(sizeof(LodItem) * (size_t)count)};
    assert_non_null(d.items);
    assert_int_equal(square_page_store_create(&g->tiles.squares, 0, &d.squares), RESULT_OK);
    for (int32_t i = 0; i < count; i++)
        d.items[i] = draw_tile(&d, g, levels, i, border);
    d.cut = (LodCut){.item_count = count, .items = d.items};
    d.cut.view = support_view(support_eye(g->terrain, 10.0, 10.0, 5000.0), 1.0);
    return d;
}

void geomip_support_draw_end(GeomipDrawn *d) {
    for (int32_t i = 0; i < d->cut.item_count; i++) {
        free((void *)(uintptr_t)d->items[i].indices);
        if (!d->squares.oldest)
            geomip_page_retire(&d->pages, (GeomipPage *)(uintptr_t)d->items[i].page, 0); // its first member
    }
    geomip_page_store_destroy(&d->pages);
    square_page_store_destroy(&d->squares);
    free(d->items);
}

double geomip_support_area(GeomipPoint a, GeomipPoint b, GeomipPoint c) {
    return (b.col - a.col) * (c.row - a.row) - (b.row - a.row) * (c.col - a.col);
}
