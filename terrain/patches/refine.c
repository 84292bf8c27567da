#include "terrain/patches/refine.h"

#include <math.h>
#include <string.h>

// Rounding of a distance in double, and then some: decisions within it of their limit count as about to change.
#define VALIDITY_SLACK_M 1e-6

RefineView refine_view(const LodView *view, double tau_px) {
    return (RefineView){
        .eye = {view->eye_ecef.x * GRID_LATTICE_PER_M, view->eye_ecef.y * GRID_LATTICE_PER_M,
                view->eye_ecef.z * GRID_LATTICE_PER_M},
        .nu = view->px_per_rad / tau_px,
    };
}

bool refine_is_active(const RefineView *view, Vec3d position_ecef, float delta_m, float radius_m) {
    double x = position_ecef.x * GRID_LATTICE_PER_M - view->eye[0];
    double y = position_ecef.y * GRID_LATTICE_PER_M - view->eye[1];
    double z = position_ecef.z * GRID_LATTICE_PER_M - view->eye[2];
    double reach = view->nu * GRID_LATTICE_PER_M * (double)delta_m + GRID_LATTICE_PER_M * (double)radius_m;
    return reach > sqrt(x * x + y * y + z * z);
}

size_t refine_active_bytes(const PatchTemplate *patch) {
    return (size_t)patch->vertex_count;
}

size_t refine_indices_max(const PatchTemplate *patch) {
    return 3 * (size_t)patch->triangle_count + 1; // a triangle is written as four, the last one over what follows
}

typedef struct Decided {
    int64_t slack; // bits of the smallest | reach - distance |: non-negative doubles compare like their bits
    int active;
} Decided;

// Offsets plus origin are exact in double, so a vertex is decided by the same bits in every page that holds it.
SIMD_CLONES
static Decided decide(const int32_t *restrict px, const int32_t *restrict py, const int32_t *restrict pz,
                      const uint16_t *restrict delta, const uint16_t *restrict radius, uint8_t *restrict active,
                      int count, const double *restrict origin, const double *restrict eye, double nu) {
    int64_t slack = INT64_MAX;
    int any = 0;
    double ox = origin[0], oy = origin[1], oz = origin[2], ex = eye[0], ey = eye[1], ez = eye[2];
    for (int v = 0; v < count; v++) {
        double x = ((double)px[v] + ox) - ex, y = ((double)py[v] + oy) - ey, z = ((double)pz[v] + oz) - ez;
        double distance = sqrt(x * x + y * y + z * z);
        double reach =
            nu * (double)error_field_decode(delta[v]) + GRID_LATTICE_PER_M * (double)error_field_decode(radius[v]);
        union {
            double value;
            int64_t bits;
        } gap = {.value = reach - distance};
        int is_active = reach > distance;
        gap.bits &= INT64_MAX;
        slack = gap.bits < slack ? gap.bits : slack;
        active[v] = (uint8_t)is_active;
        any |= is_active;
    }
    return (Decided){slack, any};
}

// Depth first over the heap: past a triangle that is drawn, go on at the next one whose parent is split.
int32_t refine_emit(const PatchTemplate *patch, const uint8_t *active, uint16_t *indices) {
    uint32_t heap = 1, leaves = (uint32_t)patch->triangle_count;
    uint16_t *out = indices;
    do {
        while (heap < leaves && active[patch->split[heap]])
            heap *= 2;
        memcpy(out, patch->corners[heap], 4 * sizeof *out);
        out += 3;
        heap++;
        heap >>= __builtin_ctz(heap);
    } while (heap > 1);
    return (int32_t)(out - indices);
}

RefineResult refine_decide(const Page *page, const RefineView *view, uint8_t *active) {
    const PatchTemplate *patch = page->patch;
    const GridPoint *o = &page->shown.origin;
    double origin[3] = {(double)o->x, (double)o->y, (double)o->z};
    int64_t slack = INT64_MAX;
    int level = 0, end = patch->level_begin[0];
    bool any = true;
    // Errors are nested: below a level without an active vertex there is none, and no decision there is closer to
    // changing.
    for (; level < patch->depth && any; level++) {
        int begin = end;
        end = patch->level_begin[level + 1];
        Decided level_decided =
            decide(page->x + begin, page->y + begin, page->z + begin, page->delta + begin, page->radius + begin,
                   active + begin, end - begin, origin, view->eye, view->nu * GRID_LATTICE_PER_M);
        slack = level_decided.slack < slack ? level_decided.slack : slack;
        any = level_decided.active;
    }
    memset(active + end, 0, (size_t)(patch->vertex_count - end));
    RefineResult result = {.evaluated = end - patch->level_begin[0]};
    union {
        int64_t bits;
        double value;
    } gap = {.bits = slack};
    result.validity_m = level > 0 ? gap.value * GRID_LATTICE_M - VALIDITY_SLACK_M : INFINITY;
    result.vertex_count = patch->level_begin[0];
    for (int v = patch->level_begin[0]; v < end; v++)
        result.vertex_count += active[v];
    return result;
}

RefineResult refine_page(const Page *page, const RefineView *view, uint8_t *active, uint16_t *indices) {
    RefineResult result = refine_decide(page, view, active);
    result.index_count = refine_emit(page->patch, active, indices);
    return result;
}

int32_t refine_all(const PatchTemplate *patch, uint16_t *indices) {
    uint16_t *out = indices;
    for (int heap = patch->triangle_count; heap < 2 * patch->triangle_count; heap++, out += 3)
        memcpy(out, patch->corners[heap], 3 * sizeof *out);
    return (int32_t)(out - indices);
}
