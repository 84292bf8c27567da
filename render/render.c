#include "render/render.h"

#include "base/clock.h"
#include "base/log.h"
#include "render/frame.h"
#include "render/gl.h"
#include "render/patch_cache.h"
#include "render/shader.h"
#include "render/target.h"
#include "render/terrain_pass.h"
#include "render/timing.h"

#include <stdlib.h>
#include <string.h>

#define VRAM_BYTES_DEFAULT ((size_t)256 << 20)

struct Renderer {
    RenderOptions options;
    const Terrain *terrain;
    bool software;
    Target target;
    PatchCache *cache;
    TerrainPass *terrain_pass;
    GLuint terrain_program;
    GLuint frame_buffer; // uniform block
    Timing timing;
};

RenderOptions render_default_options(void) {
    return (RenderOptions){.width = 1280, .height = 800, .vram_bytes_max = VRAM_BYTES_DEFAULT};
}

static Result create_parts(Renderer *renderer) {
    const ShaderSpec terrain = {.stages = {"terrain.vert", "terrain.frag"}};
    Result result = target_create(renderer->options.width, renderer->options.height, 1, &renderer->target);
    if (result == RESULT_OK)
        result = patch_cache_create(renderer->options.vram_bytes_max, &renderer->cache);
    if (result == RESULT_OK)
        result = terrain_pass_create(&renderer->terrain_pass);
    if (result == RESULT_OK)
        result = shader_create_program(&terrain, &renderer->terrain_program);
    glCreateBuffers(1, &renderer->frame_buffer);
    glNamedBufferStorage(renderer->frame_buffer, sizeof(FrameBlock), NULL, GL_DYNAMIC_STORAGE_BIT);
    return result;
}

Result render_create(const RenderOptions *options, const Terrain *terrain, Renderer **out) {
    Renderer *renderer = calloc(1, sizeof *renderer);
    if (!renderer) {
        log_error("out of memory for the renderer");
        return RESULT_MEMORY;
    }
    renderer->options = *options;
    renderer->terrain = terrain;
    renderer->software = gl_is_software();
    renderer->timing = timing_create(renderer->software);
    Result result = create_parts(renderer);
    if (result != RESULT_OK) {
        render_destroy(&renderer);
        return result;
    }
    *out = renderer;
    return RESULT_OK;
}

void render_destroy(Renderer **renderer) {
    Renderer *self = *renderer;
    if (!self)
        return;
    target_destroy(&self->target);
    patch_cache_destroy(&self->cache);
    terrain_pass_destroy(&self->terrain_pass);
    glDeleteProgram(self->terrain_program);
    glDeleteBuffers(1, &self->frame_buffer);
    timing_destroy(&self->timing);
    free(self);
    *renderer = NULL;
}

void render_resize(Renderer *renderer, int width, int height) {
    renderer->options.width = width;
    renderer->options.height = height;
}

static Result fit_target(Renderer *renderer) {
    const RenderOptions *options = &renderer->options;
    if (renderer->target.width == options->width && renderer->target.height == options->height)
        return RESULT_OK;
    target_destroy(&renderer->target);
    return target_create(options->width, options->height, 1, &renderer->target);
}

static void set_state(const Renderer *renderer) {
    glBindFramebuffer(GL_FRAMEBUFFER, renderer->target.framebuffer);
    glViewport(0, 0, renderer->target.width, renderer->target.height);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
    glEnable(GL_CULL_FACE);
    glDisable(GL_BLEND);
}

static void clear(const RenderPacket *packet) {
    bool magenta = packet->magenta_background;
    glClearColor(magenta ? 1.0f : 0.55f, magenta ? 0.0f : 0.7f, magenta ? 1.0f : 0.9f, 1.0f);
    glClearDepth(0.0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

static void draw_scene(Renderer *renderer, const Frame *frame, const RenderPacket *packet) {
    set_state(renderer);
    clear(packet);
    glNamedBufferSubData(renderer->frame_buffer, 0, sizeof frame->block, &frame->block);
    glBindBufferBase(GL_UNIFORM_BUFFER, FRAME_BLOCK_BINDING, renderer->frame_buffer);
    glUseProgram(renderer->terrain_program);
    terrain_pass_draw(renderer->terrain_pass, renderer->cache);
}

static void fill_stats(const Renderer *renderer, RenderStats *stats) {
    PatchCacheStats cache = patch_cache_stats(renderer->cache);
    terrain_pass_count(renderer->terrain_pass, stats);
    stats->upload_bytes = cache.upload_bytes;
    stats->evictions = cache.evictions;
    stats->vram_bytes = cache.used_bytes;
    stats->software = renderer->software;
}

Result render_frame(Renderer *renderer, const RenderPacket *packet, RenderStats *stats) {
    GLint screen = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &screen);
    Result result = fit_target(renderer);
    if (result != RESULT_OK)
        return result;
    *stats = (RenderStats){0};
    Frame frame = frame_make(&packet->camera, renderer->target.width, renderer->target.height);
    int64_t begin_ns = clock_now_ns();
    patch_cache_begin_frame(renderer->cache);
    result = terrain_pass_prepare(renderer->terrain_pass, renderer->cache, &frame, &packet->cut);
    stats->upload_ms = (double)(clock_now_ns() - begin_ns) * 1e-6;
    timing_begin(&renderer->timing);
    draw_scene(renderer, &frame, packet);
    patch_cache_end_frame(renderer->cache);
    target_blit_colour(&renderer->target, (GLuint)screen);
    stats->draw_ms = timing_end(&renderer->timing, renderer->options.measure_times);
    glBindFramebuffer(GL_FRAMEBUFFER, (GLuint)screen);
    fill_stats(renderer, stats);
    return result;
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
