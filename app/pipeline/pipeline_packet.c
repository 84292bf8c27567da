#include "app/pipeline/pipeline_packet.h"

#include "base/clock.h"

#include <string.h>

static LodCut *cut_of(Packet *packet, int half) {
    return half == 0 ? &packet->render.cut : &packet->render.right;
}

static LodMethod wanted_of(const Packet *packet, int half) {
    return half == 0 ? packet->order.method : packet->order.right;
}

// Up to which frame nobody reads any more. `drawn` first: who holds a frame said so before it was drawn.
static uint64_t unread_frame(MethodRun *run) {
    uint64_t drawn = atomic_load(&run->drawn), held = atomic_load(&run->held);
    return held > 0 && held <= drawn ? held - 1 : drawn;
}

// A reached budget is a valid cut, and the panel says so.
static Result refine_with(Packet *packet, MethodRun *run, Jobs *jobs, LodCut *cut) {
    lod_release(run->lod, unread_frame(run));
    Result result = lod_update(run->lod, &packet->order.view, jobs, packet->arena, cut);
    return result == RESULT_BUDGET ? RESULT_OK : result;
}

// Whether a method that was wanted and is ready took over with the half's cut.
static bool try_candidate(Packet *packet, Methods *methods, Jobs *jobs, int half) {
    MethodRun *candidate = methods_find_candidate(methods, half, wanted_of(packet, half));
    if (!candidate)
        return false;
    int64_t begin_ns = clock_now_ns();
    Result result = refine_with(packet, candidate, jobs, cut_of(packet, half));
    methods_judge(methods, half, result, (double)(clock_now_ns() - begin_ns) * 1e-6);
    return result == RESULT_OK;
}

// The half's cut by the method that is wanted, or by the one that stands in for it; without either, none.
static Result refine_half(Packet *packet, Methods *methods, Jobs *jobs, int half) {
    bool refined = try_candidate(packet, methods, jobs, half);
    MethodRun *run = methods_current(methods, half);
    Result result = refined || !run ? RESULT_OK : refine_with(packet, run, jobs, cut_of(packet, half));
    if (result != RESULT_OK || !run)
        return result;
    atomic_fetch_add(&run->users, 1);
    packet->runs[half] = run;
    return RESULT_OK;
}

void packet_leave(Packet *packet) {
    for (int half = 0; half < METHODS_HALVES; half++)
        if (packet->runs[half])
            atomic_fetch_sub(&packet->runs[half]->users, 1);
    memset(packet->runs, 0, sizeof packet->runs);
}

void packet_hold(Packet *packet) {
    atomic_store(&packet->runs[0]->held, packet->render.cut.frame);
}

void packet_let_go(Packet *packet) {
    atomic_store(&packet->runs[0]->held, 0);
    packet_leave(packet);
}

bool packet_is_refused(Packet *packet, const RenderStats *stats) {
    const bool refused[METHODS_HALVES] = {stats->resident.refused, stats->right.resident.refused};
    for (int half = 0; half < METHODS_HALVES; half++)
        if (refused[half] && packet->runs[half])
            atomic_store(&packet->runs[half]->undrawable, true);
    return refused[0] || refused[1];
}

static const char *method_name(const MethodRun *run) {
    return run ? lod_method_name(run->method) : NULL;
}

static void fill_packet(Packet *packet) {
    const FrameOrder *order = &packet->order;
    LodCut cut = packet->render.cut, right = packet->render.right;
    packet->render = order->look;
    packet->render.cut = cut;
    packet->render.right = right;
    packet->render.split = packet->runs[1] != NULL;
    packet->render.hud.message = order->message[0] ? order->message : NULL;
    packet->render.hud.method = method_name(packet->runs[0]);
    packet->render.hud.right_method = method_name(packet->runs[1]);
}

// The cuts for the packet's order, one after the other, so that each method's time is its own.
Result packet_refine(Packet *packet, Methods *methods, Jobs *jobs) {
    arena_reset(packet->arena);
    Result result = refine_half(packet, methods, jobs, 0);
    if (!packet->order.compare)
        methods_leave(methods, 1);
    else if (result == RESULT_OK)
        result = refine_half(packet, methods, jobs, 1);
    if (result == RESULT_OK)
        fill_packet(packet);
    else
        packet_leave(packet);
    return result;
}

void packet_mark_drawn(Packet *packet, LodMethod methods[METHODS_HALVES]) {
    for (int half = 0; half < METHODS_HALVES; half++) {
        MethodRun *run = packet->runs[half];
        methods[half] = run ? run->method : (LodMethod)0;
        if (run)
            atomic_store(&run->drawn, cut_of(packet, half)->frame);
    }
}
