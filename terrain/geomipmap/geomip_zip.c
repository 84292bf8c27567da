// terrain/geomipmap/geomip_zip.c: de Boer 2000, "changing connectivity of vertices for the higher detail GeoMipMap":
// each vertex of the inner line joins the nearest one of the border.
#include "terrain/geomipmap/geomip_zip.h"

// Whether the triangle on the border comes before the one on the inner line: the one whose middle comes first; in a
// cell of the level's mesh, where the middles agree, as its diagonal asks.
static bool outer_is_next(int outer_sum, int t, int stride) {
    int inner_sum = 2 * t + stride;
    return outer_sum != inner_sum ? outer_sum < inner_sum : t / stride & 1;
}

int geomip_zip(const int16_t *outer, int outer_count, int side_cells, int stride, GeomipZip *out) {
    int at = 0, t = stride, last = side_cells - stride, count = 0;
    while (at < outer_count - 1 || t < last) {
        bool next = t == last || (at < outer_count - 1 && outer_is_next(outer[at] + outer[at + 1], t, stride));
        out[count++] = (GeomipZip){(int16_t)at, (int16_t)t, next};
        if (next)
            at++;
        else
            t += stride;
    }
    return count;
}
