// render/hud/hud.h: the head-up display: flight instruments, a panel of numbers, a page of keys, messages.
// Pixels from the top left corner of the picture; radians, metres and seconds as in render/render.h.
// A Hud belongs to the thread that has the GL context current; it owns its font, shapes and GL objects.
#pragma once
#include "base/base.h"
#include "render/render.h"

typedef struct Hud Hud;

typedef struct HudOptions {
    const char *font_path; // a TrueType file, or NULL: fonts/DejaVuSans.ttf of the data, then the system's DejaVu Sans
} HudOptions;
HudOptions hud_default_options(void);

// Needs a current GL 4.5 context. NOT_FOUND: no font, the message says which package brings one. DEVICE: the shaders
// did not compile. MEMORY.
MUST_USE Result hud_create(const HudOptions *options, Hud **out);
// With the same context current; accepts NULL and half-built objects.
void hud_destroy(Hud **hud);

// Draws what `packet->hud` asks for over the picture, into the framebuffer bound for drawing, whose size is
// width x height pixels; one draw call, two with the panel of accuracy. `previous` tells the numbers of the frame
// before; NULL before the first. All state of GL that it changes is as before on return: program, vertex array,
// viewport, blending, depth and stencil test, culling, scissor, polygon mode, colour and depth masks, sRGB writing, the
// array buffer binding, the unpack alignment, and texture and sampler of unit 0. After warm-up it allocates nothing.
void hud_draw(Hud *hud, const RenderPacket *packet, const RenderStats *previous, int width, int height);
