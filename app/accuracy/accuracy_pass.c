#include "app/accuracy/accuracy_internal.h"
#include "app/bench/bench.h"
#include "app/picture_options.h"
#include "base/clock.h"
#include "base/hash.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#define FRAME_BLOCK_BYTES (1 << 20)

// What others freed is not to be taken for what this pass needs not.
static void give_back_memory(void) {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

Result accuracy_pass_begin(const AccuracyPlan *plan, const AccuracyDem *dem, const AccuracyRun *run, uint32_t serial,
                           AccuracyPass *out) {
    const AccuracyVariant *variant = &plan->variants[run->variant];
    give_back_memory();
    LodOptions options = scene_lod_options(plan->options);
    options.method = variant->method;
    options.bound = variant->bound;
    options.serial = serial;
    *out = (AccuracyPass){.plan = plan,
                          .dem = dem,
                          .world = &dem->worlds[variant->kind],
                          .tau_px = run->tau_px,
                          .bytes_before = bench_resident_bytes()};
    Result result = arena_create(FRAME_BLOCK_BYTES, &out->frame);
    int64_t begin = clock_now_ns();
    if (result == RESULT_OK)
        result = lod_create(&options, out->world->terrain, &out->lod);
    out->prepare_ns = clock_now_ns() - begin;
    return result;
}

Result accuracy_pass_refine_at(AccuracyPass *pass, const Viewpoint *at) {
    LodView view = accuracy_view_at(pass->plan, pass->dem, at, pass->tau_px);
    lod_release(pass->lod, pass->cut.frame);
    arena_reset(pass->frame);
    bool first = pass->cut.frame == 0;
    int64_t begin = clock_now_ns();
    Result result = lod_update(pass->lod, &view, pass->world->jobs, pass->frame, &pass->cut);
    if (first)
        pass->prepare_ns += clock_now_ns() - begin - pass->cut.stats.select_ns - pass->cut.stats.refine_ns;
    return result == RESULT_BUDGET ? RESULT_OK : result;
}

Result accuracy_pass_refine(AccuracyPass *pass, int pose) {
    return accuracy_pass_refine_at(pass, &pass->dem->poses[pose].at);
}

void accuracy_pass_end(AccuracyPass *pass) {
    lod_destroy(&pass->lod);
    arena_destroy(&pass->frame);
}

RenderPacket accuracy_packet(const AccuracyPass *pass, int pose) {
    const AccuracyPlan *plan = pass->plan;
    const Viewpoint *at = &pass->dem->poses[pose].at;
    RenderCamera camera = {pass->cut.view.eye_ecef, viewpoint_camera(at), plan->fov_rad};
    return (RenderPacket){.cut = pass->cut, .camera = camera, .sun_ecef = world_sun(pass->world, plan->options, at)};
}

Result accuracy_renderer(const AccuracyPlan *plan, const World *world, Renderer **out) {
    RenderOptions options = picture_render_options(plan->options, world);
    options.width = plan->width;
    options.height = plan->height;
    options.measure_times = true;
    options.lockstep = true;
    return render_create(&options, world->terrain, out);
}

uint64_t accuracy_cut_outline(const LodCut *cut) {
    uint64_t hash = hash_mix((uint64_t)cut->item_count, (uint64_t)cut->stats.triangles);
    for (int32_t i = 0; i < cut->item_count; i++) {
        const LodItem *item = &cut->items[i];
        hash = hash_mix(hash, (uint64_t)(uint32_t)item->page->col0 << 32 | (uint32_t)item->page->row0);
        hash = hash_mix(hash, (uint64_t)item->level << 32 | (uint32_t)item->index_count);
    }
    return hash;
}

uint64_t accuracy_cut_hash(const LodCut *cut) {
    uint64_t hash = accuracy_cut_outline(cut);
    for (int32_t i = 0; i < cut->item_count; i++) {
        const LodItem *item = &cut->items[i];
        hash = hash_mix(hash, (uint64_t)item->page->origin.x ^ (uint64_t)item->page->origin.z << 20);
        for (int32_t k = 0; k < item->index_count; k++) {
            const LodVertex *v = &item->page->vertices[item->indices[k]];
            hash = hash_mix(hash, (uint64_t)(uint32_t)v->x << 32 | (uint32_t)v->y);
            hash = hash_mix(hash, (uint64_t)(uint32_t)v->z << 32 | (uint32_t)v->col << 16 | v->row);
        }
    }
    return hash;
}
