// render/diamond/diamond_pass.h: resident cuts: the triangles of diamonds are made and drawn on the GPU, within the
// budget. As render/frame.h.
// A DiamondPass owns its programs and the model on the GPU, which it keeps while cuts of one model come; thread of the
// context.
#pragma once
#include "render/diamond/diamond_gpu.h"
#include "render/frame.h"
#include "render/ground/ground.h"

typedef struct DiamondPass DiamondPass;

typedef struct DiamondPassOptions {
    bool software;
    bool wait;           // counts are known, and the budget is kept, before a frame is drawn
    const char *defines; // of terrain.frag, without WATER and SHADED; lives as long as the pass
} DiamondPassOptions;

MUST_USE Result diamond_pass_create(const DiamondPassOptions *options, DiamondPass **out);
void diamond_pass_destroy(DiamondPass **pass);

// Makes the cut's triangles; for a cut that is not resident only gives the memory back. Above the budget the tolerance
// is raised: at once with `wait`, else for frames to come, and what there is room for, a quarter more, is drawn. Where
// the model or a phase cannot be had, nothing is drawn, the stats say refused, and that model is not tried again.
void diamond_pass_prepare(DiamondPass *pass, const Frame *frame, const Ground *ground, const LodCut *cut);
// The land, or the edges of its triangles with the state for them set; nothing where the cut is not resident.
// Shaded: with what shaders/craft_shade.glsl needs bound.
void diamond_pass_draw(DiamondPass *pass, RenderColouring colouring, bool shaded);
void diamond_pass_draw_wire(DiamondPass *pass);
void diamond_pass_count(const DiamondPass *pass, RenderCutStats *stats);
size_t diamond_pass_bytes(const DiamondPass *pass);
