#include "render/render.h"

#include "base/clock.h"
#include "base/log.h"
#include "render/gl.h"
#include "render/hud/hud.h"
#include "render/scene.h"
#include "render/target.h"
#include "render/timing.h"

#include <math.h>
#include <stdlib.h>

#define VRAM_BYTES_DEFAULT ((size_t)256 << 20)
#define SAMPLES_HARDWARE 4

struct Renderer {
    RenderOptions options;
    bool software;
    Target target; // the picture, until it goes to the context's framebuffer
    Target multi;  // the same with several samples a pixel, if asked for
    int samples;
    Scene *scene;
    Hud *hud;             // NULL: none could be made
    Timing timings[2];    // of the whole picture or its left half, and of the right half
    RenderStats previous; // of the frame before, for the display
    bool has_previous;
};

RenderOptions render_default_options(void) {
    return (RenderOptions){.width = 1280, .height = 800, .vram_bytes_max = VRAM_BYTES_DEFAULT};
}

// A picture without its display is better than none; the cause was logged where it was found.
static Hud *create_hud(void) {
    const HudOptions options = hud_default_options();
    Hud *hud = NULL;
    if (hud_create(&options, &hud) != RESULT_OK)
        log_warn("flying without the head-up display");
    return hud;
}

Result render_create(const RenderOptions *options, const Terrain *terrain, Renderer **out) {
    Renderer *renderer = calloc(1, sizeof *renderer);
    if (!renderer) {
        log_error("out of memory for the renderer");
        return RESULT_MEMORY;
    }
    renderer->options = *options;
    renderer->software = gl_is_software();
    renderer->samples = options->samples ? options->samples : renderer->software ? 1 : SAMPLES_HARDWARE;
    for (size_t i = 0; i < COUNT_OF(renderer->timings); i++)
        renderer->timings[i] = timing_create(renderer->software);
    Result result = scene_create(options, terrain, renderer->software, &renderer->scene);
    if (result != RESULT_OK) {
        render_destroy(&renderer);
        return result;
    }
    renderer->hud = create_hud();
    *out = renderer;
    return RESULT_OK;
}

void render_destroy(Renderer **renderer) {
    Renderer *self = *renderer;
    if (!self)
        return;
    hud_destroy(&self->hud);
    scene_destroy(&self->scene);
    target_destroy(&self->target);
    target_destroy(&self->multi);
    for (size_t i = 0; i < COUNT_OF(self->timings); i++)
        timing_destroy(&self->timings[i]);
    free(self);
    *renderer = NULL;
}

void render_resize(Renderer *renderer, int width, int height) {
    renderer->options.width = width;
    renderer->options.height = height;
}

static Result fit_target(Renderer *renderer, Target *target, int samples) {
    const RenderOptions *options = &renderer->options;
    if (target->width == options->width && target->height == options->height)
        return RESULT_OK;
    target_destroy(target);
    return target_create(options->width, options->height, samples, target);
}

static Result fit_targets(Renderer *renderer) {
    Result result = fit_target(renderer, &renderer->target, 1);
    if (result == RESULT_OK && renderer->samples > 1)
        result = fit_target(renderer, &renderer->multi, renderer->samples);
    return result;
}

void render_tell_cut(const RenderResident *resident, bool partial, LodCut *cut) {
    cut->promises = cut->promises && !partial;
    if (!resident->made)
        return;
    cut->reached_px = resident->reached_px;
    cut->promises = cut->promises && isfinite(resident->reached_px);
    cut->stats.triangles = cut->stats.triangles_rebuilt = resident->triangles;
    cut->stats.patches = 1;
    cut->stats.select_ns = (int64_t)((resident->evaluate_ms + resident->close_ms) * 1e6);
    cut->stats.refine_ns = (int64_t)(resident->indices_ms * 1e6);
}

static bool draws_several_samples(const Renderer *renderer, const RenderPacket *packet) {
    return renderer->samples > 1 && !packet->magenta_background;
}

// Brings the cut to the GPU and draws it into its part of the picture; the time since the begin of the timing is told
// by end_view.
static Result draw_view(Renderer *renderer, const RenderPacket *packet, const SceneView *view, RenderCutStats *stats) {
    int64_t begin_ns = clock_now_ns();
    Result result = scene_prepare(renderer->scene, packet, view);
    stats->upload_ms = (double)(clock_now_ns() - begin_ns) * 1e-6;
    timing_begin(&renderer->timings[view->index]);
    bool several = draws_several_samples(renderer, packet);
    scene_draw(renderer->scene, packet, view, several ? renderer->multi.framebuffer : renderer->target.framebuffer);
    scene_count(renderer->scene, view, stats);
    return result;
}

static void end_view(Renderer *renderer, int index, RenderCutStats *stats) {
    stats->draw_ms = timing_end(&renderer->timings[index], renderer->options.measure_times);
}

// The packet as the display tells of it.
static RenderPacket told_packet(const RenderPacket *packet, const RenderCutStats *left, const RenderCutStats *right) {
    RenderPacket told = *packet;
    render_tell_cut(&left->resident, left->partial, &told.cut);
    if (right)
        render_tell_cut(&right->resident, right->partial, &told.right);
    return told;
}

// What lies over the land, and the picture to the screen.
static void finish(Renderer *renderer, const RenderPacket *packet, unsigned screen) {
    const Target *target = &renderer->target;
    if (draws_several_samples(renderer, packet))
        target_blit_colour(&renderer->multi, target->framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
    if (renderer->hud)
        hud_draw(renderer->hud, packet, renderer->has_previous ? &renderer->previous : NULL, target->width,
                 target->height);
    target_blit_colour(target, screen);
}

static Result draw_whole(Renderer *renderer, const RenderPacket *packet, unsigned screen, RenderCutStats *stats) {
    const SceneView view = {&packet->cut, 0, 0, renderer->target.width, renderer->target.height};
    Result result = draw_view(renderer, packet, &view, stats);
    RenderPacket told = told_packet(packet, stats, NULL);
    finish(renderer, &told, screen);
    end_view(renderer, 0, stats);
    return result;
}

static Result draw_halves(Renderer *renderer, const RenderPacket *packet, unsigned screen, RenderCutStats *left,
                          RenderCutStats *right) {
    int width = renderer->target.width, height = renderer->target.height, middle = render_left_width(width);
    const SceneView left_view = {&packet->cut, 0, 0, middle, height},
                    right_view = {&packet->right, 1, middle, width - middle, height};
    Result left_result = draw_view(renderer, packet, &left_view, left);
    end_view(renderer, 0, left);
    Result right_result = draw_view(renderer, packet, &right_view, right);
    end_view(renderer, 1, right);
    RenderPacket told = told_packet(packet, left, right);
    finish(renderer, &told, screen);
    return left_result != RESULT_OK ? left_result : right_result;
}

static RenderStats stats_of(const Renderer *renderer, const RenderCutStats *cut) {
    return (RenderStats){.draws = cut->draws,
                         .triangles_drawn = cut->triangles_drawn,
                         .patches_drawn = cut->patches_drawn,
                         .upload_bytes = cut->upload_bytes,
                         .evictions = cut->evictions,
                         .upload_ms = cut->upload_ms,
                         .draw_ms = cut->draw_ms,
                         .partial = cut->partial,
                         .resident = cut->resident,
                         .vram_bytes = scene_vram_bytes(renderer->scene),
                         .software = renderer->software};
}

Result render_frame(Renderer *renderer, const RenderPacket *packet, RenderStats *stats) {
    GLint screen = 0;
    RenderCutStats cut = {0}, right = {0};
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &screen);
    *stats = (RenderStats){.software = renderer->software};
    Result result = fit_targets(renderer);
    if (result != RESULT_OK)
        return result;
    if (packet->split && renderer->target.width > 1)
        result = draw_halves(renderer, packet, (unsigned)screen, &cut, &right);
    else
        result = draw_whole(renderer, packet, (unsigned)screen, &cut);
    *stats = stats_of(renderer, &cut);
    stats->right = right;
    glBindFramebuffer(GL_FRAMEBUFFER, (GLuint)screen);
    renderer->previous = *stats;
    renderer->has_previous = true;
    return result;
}

void render_forget_patches(Renderer *renderer) {
    scene_forget_patches(renderer->scene);
}

static void flip_rows(uint8_t *rgb, int width, int height) {
    size_t row_bytes = (size_t)width * 3;
    for (int top = 0, bottom = height - 1; top < bottom; top++, bottom--) {
        uint8_t *a = rgb + (size_t)top * row_bytes, *b = rgb + (size_t)bottom * row_bytes;
        for (size_t i = 0; i < row_bytes; i++) {
            uint8_t kept = a[i];
            a[i] = b[i];
            b[i] = kept;
        }
    }
}

Result render_read_pixels(Renderer *renderer, uint8_t *rgb) {
    GLint bound = 0;
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &bound);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, renderer->target.framebuffer);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, renderer->target.width, renderer->target.height, GL_RGB, GL_UNSIGNED_BYTE, rgb);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, (GLuint)bound);
    flip_rows(rgb, renderer->target.width, renderer->target.height);
    return RESULT_OK;
}
