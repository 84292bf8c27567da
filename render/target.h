// render/target.h: a framebuffer of the renderer's own: 8-bit colour, 32-bit float depth.
// Pixels.
// A Target owns its attachments; thread of the context. A zeroed Target is empty and may be destroyed.
#pragma once
#include "base/base.h"

typedef struct Target {
    unsigned framebuffer, colour, depth;
    int width, height, samples; // samples 1: not multisampled
} Target;

// DEVICE: the driver refuses the size.
MUST_USE Result target_create(int width, int height, int samples, Target *out);
void target_destroy(Target *target);
// Copies (and resolves) the colour of the whole into `framebuffer`, which is of the same size.
void target_blit_colour(const Target *target, unsigned framebuffer);
