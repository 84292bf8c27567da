// app/pipeline/pipeline_packet.h: a frame on its way through a pipeline: what was ordered, and its cuts.
// As app/pipeline/pipeline.h.
// A Packet owns its arena; only the stage that holds it, by its state, touches more than the state.
#pragma once
#include "app/pipeline/pipeline.h"
#include "app/pipeline/pipeline_methods.h"
#include "base/arena.h"

typedef enum PacketState {
    PACKET_FREE,
    PACKET_REFINING,
    PACKET_READY,
    PACKET_DRAWING,
    PACKET_REFUSED,
    PACKET_HELD // drawn, and somebody reads its left cut
} PacketState;

typedef struct Packet {
    PacketState state;
    uint64_t number; // order of submission
    Arena *arena;
    FrameOrder order;
    RenderPacket render;
    MethodRun *runs[METHODS_HALVES]; // whose cuts it holds; NULL: none
    int64_t refine_ns;               // that the whole of the refining stage took
} Packet;

// The packet's order refined: its cuts, and all of `render`. Refining thread. On failure it holds nothing.
MUST_USE Result packet_refine(Packet *packet, Methods *methods, Jobs *jobs);
// Before packet_mark_drawn: the left half's cut stays readable until packet_let_go.
void packet_hold(Packet *packet);
void packet_let_go(Packet *packet);
// The packet is drawn: its cuts' memory may be used again. `methods`: who made them; without a right half 0.
void packet_mark_drawn(Packet *packet, LodMethod methods[METHODS_HALVES]);
// Whether a cut of it could not be drawn, which its method is told: the packet is to be refined again.
bool packet_is_refused(Packet *packet, const RenderStats *stats);
// It holds no cuts any more.
void packet_leave(Packet *packet);
