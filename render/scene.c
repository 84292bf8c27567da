#include "render/scene.h"

#include "base/log.h"
#include "render/atmosphere.h"
#include "render/craft/craft_pass.h"
#include "render/diamond/diamond_pass.h"
#include "render/gl.h"
#include "render/ground/drape.h"
#include "render/ground/ground.h"
#include "render/patch_cache.h"
#include "render/shader.h"
#include "render/sky_pass.h"
#include "render/terrain_pass.h"
#include "terrain/geodesy.h"

#include <stdio.h>
#include <stdlib.h>

// As shaders/aerial.glsl has them.
enum { UNIT_SKY_RADIANCE = 8, UNIT_SKY_SOURCE = 9 };
enum { UNIT_LIGHT_SUN = 12, UNIT_LIGHT_SKY = 13 }; // shaders/globe.frag

struct Scene {
    const Terrain *terrain;
    PatchCache *cache;
    TerrainPass *terrain_passes[2]; // by SceneView.index: each remembers what it drew last
    DiamondPass *diamond_passes[2]; // by SceneView.index, for resident cuts
    Atmosphere *atmosphere;
    Ground *ground;
    Drape *drape; // NULL: no image
    SkyPass *sky_pass;
    CraftPass *craft_pass;                            // NULL until there is an aircraft
    bool craft_refused;                               // it could not be made, and the log said why
    GLuint land_program, shore_program;               // patches without water, and with
    GLuint shaded_land_program, shaded_shore_program; // with an aircraft's shadow; 0 until they are called for
    bool shaded_refused;                              // they could not be made, and the log said why
    GLuint wire_program;                              // 0 until it is called for
    GLuint frame_buffer;                              // uniform block
    char defines[64];
    Frame frame;
};

static Result create_land_program(const Scene *scene, const char *more, GLuint *program) {
    char defines[96];
    snprintf(defines, sizeof defines, "%s%s", scene->defines, more);
    const ShaderSpec spec = {.stages = {"terrain.vert", "terrain.frag"}, .defines = defines};
    return shader_create_program(&spec, program);
}

static Result create_programs(Scene *scene) {
    Result result = create_land_program(scene, "", &scene->land_program);
    return result == RESULT_OK ? create_land_program(scene, " WATER", &scene->shore_program) : result;
}

static Result create_terrain_passes(Scene *scene) {
    double noise_repeats[2];
    ground_noise_repeats(scene->ground, noise_repeats);
    Result result = terrain_pass_create(noise_repeats, &scene->terrain_passes[0]);
    return result == RESULT_OK ? terrain_pass_create(noise_repeats, &scene->terrain_passes[1]) : result;
}

static Result create_diamond_passes(Scene *scene, const RenderOptions *render, bool software) {
    const DiamondPassOptions options = {software, software || render->lockstep || render->measure_times,
                                        scene->defines};
    Result result = diamond_pass_create(&options, &scene->diamond_passes[0]);
    return result == RESULT_OK ? diamond_pass_create(&options, &scene->diamond_passes[1]) : result;
}

static Result create_parts(Scene *scene, const RenderOptions *options, const Terrain *terrain, bool software) {
    Result result = patch_cache_create(options->vram_bytes_max, &scene->cache);
    if (result == RESULT_OK)
        result = ground_create(terrain, software, &scene->ground);
    if (result == RESULT_OK && options->image_path)
        result = drape_create(options, terrain, software, &scene->drape);
    if (result == RESULT_OK)
        result = create_terrain_passes(scene);
    if (result == RESULT_OK)
        result = atmosphere_create(&scene->atmosphere);
    if (result != RESULT_OK)
        return result;
    snprintf(scene->defines, sizeof scene->defines, "%s%s%s", ground_has_holes(scene->ground) ? "HOLES " : "",
             scene->drape ? "DRAPE " : "", ground_in_sea(scene->ground) ? "SEA" : "");
    glCreateBuffers(1, &scene->frame_buffer);
    glNamedBufferStorage(scene->frame_buffer, sizeof(FrameBlock), NULL, GL_DYNAMIC_STORAGE_BIT);
    if ((result = create_diamond_passes(scene, options, software)) != RESULT_OK)
        return result;
    if ((result = create_programs(scene)) != RESULT_OK)
        return result;
    scene->terrain = terrain;
    return sky_pass_create(scene->defines, &scene->sky_pass);
}

Result scene_create(const RenderOptions *options, const Terrain *terrain, bool software, Scene **out) {
    Scene *scene = calloc(1, sizeof *scene);
    if (!scene) {
        log_error("out of memory for the picture");
        return RESULT_MEMORY;
    }
    Result result = create_parts(scene, options, terrain, software);
    if (result != RESULT_OK) {
        scene_destroy(&scene);
        return result;
    }
    *out = scene;
    return RESULT_OK;
}

void scene_destroy(Scene **scene) {
    Scene *self = *scene;
    if (!self)
        return;
    patch_cache_destroy(&self->cache);
    for (size_t i = 0; i < COUNT_OF(self->terrain_passes); i++) {
        terrain_pass_destroy(&self->terrain_passes[i]);
        diamond_pass_destroy(&self->diamond_passes[i]);
    }
    sky_pass_destroy(&self->sky_pass);
    craft_pass_destroy(&self->craft_pass);
    atmosphere_destroy(&self->atmosphere);
    ground_destroy(&self->ground);
    drape_destroy(&self->drape);
    glDeleteProgram(self->land_program);
    glDeleteProgram(self->shore_program);
    glDeleteProgram(self->shaded_land_program);
    glDeleteProgram(self->shaded_shore_program);
    glDeleteProgram(self->wire_program);
    glDeleteBuffers(1, &self->frame_buffer);
    free(self);
    *scene = NULL;
}

static void put_light(float out[4], Vec3f light) {
    out[0] = light.x;
    out[1] = light.y;
    out[2] = light.z;
    out[3] = 0.0f;
}

// The light at the middle of the data stands for all of it; its change over a few degrees is small.
static void set_light(Scene *scene, Vec3d sun_ecef) {
    Vec3d up = vec3d_normalize(frame_round(ground_middle_ecef(scene->ground)));
    double mu_sun = vec3d_dot(up, vec3d_normalize(frame_round(sun_ecef)));
    for (int i = 0; i < 2; i++) {
        AtmosphereLight light = atmosphere_light(scene->atmosphere, i * FRAME_LIGHT_M, mu_sun);
        put_light(scene->frame.block.light_sun[i], light.sun);
        put_light(scene->frame.block.light_sky[i], light.sky);
    }
}

Result scene_prepare(Scene *scene, const RenderPacket *packet, const SceneView *view) {
    scene->frame = frame_make(&packet->camera, view->width, view->height);
    frame_set_sun(&scene->frame, packet->sun_ecef);
    frame_set_globe(&scene->frame, ground_globe_m(scene->ground));
    frame_set_waves(&scene->frame, ground_middle_ecef(scene->ground));
    set_light(scene, packet->sun_ecef);
    scene->frame.block.mode[0] = (int32_t)packet->colouring;
    scene->frame.block.mode[1] = packet->magenta_background;
    ground_follow_sun(scene->ground, packet->sun_ecef);
    patch_cache_begin_frame(scene->cache);
    diamond_pass_prepare(scene->diamond_passes[view->index], &scene->frame, scene->ground, view->cut);
    return terrain_pass_prepare(scene->terrain_passes[view->index], scene->cache, &scene->frame, scene->ground,
                                view->cut);
}

static void set_state(void) {
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glEnable(GL_CULL_FACE);
    glCullFace(GL_BACK);
    glFrontFace(GL_CCW);
    glDisable(GL_BLEND);
    glDisable(GL_STENCIL_TEST);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

static void begin_picture(unsigned framebuffer, const SceneView *view) {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(view->x, 0, view->width, view->height);
    glScissor(view->x, 0, view->width, view->height); // lines are wider than what the viewport clips, and clearing
    glEnable(GL_SCISSOR_TEST);                        // knows no viewport
    glDepthFunc(GL_GREATER);
    glClearColor(1.0f, 0.0f, 1.0f, 1.0f); // seen where nothing is drawn, which the pinhole test counts
    glClearDepth(0.0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

static void bind_inputs(const Scene *scene) {
    ground_bind(scene->ground);
    if (scene->drape)
        drape_bind(scene->drape);
    glBindTextureUnit(UNIT_SKY_RADIANCE, atmosphere_radiance(scene->atmosphere));
    glBindTextureUnit(UNIT_SKY_SOURCE, atmosphere_source(scene->atmosphere));
    glBindTextureUnit(UNIT_LIGHT_SUN, atmosphere_light_sun(scene->atmosphere));
    glBindTextureUnit(UNIT_LIGHT_SKY, atmosphere_light_sky(scene->atmosphere));
    glNamedBufferSubData(scene->frame_buffer, 0, sizeof scene->frame.block, &scene->frame.block);
    glBindBufferBase(GL_UNIFORM_BUFFER, FRAME_BLOCK_BINDING, scene->frame_buffer);
}

static bool have_wire_program(Scene *scene) {
    const ShaderSpec wire = {.stages = {"terrain.vert", "wire.geom", "wire.frag"}};
    if (!scene->wire_program && shader_create_program(&wire, &scene->wire_program) != RESULT_OK)
        scene->wire_program = 0;
    return scene->wire_program != 0;
}

// Lines a little nearer than the triangles they bound.
static void draw_wire(Scene *scene, const SceneView *view) {
    if (!have_wire_program(scene))
        return;
    glDepthFunc(GL_GEQUAL);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glEnable(GL_POLYGON_OFFSET_LINE);
    glPolygonOffset(0.5f, 8.0f);
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    glUseProgram(scene->wire_program);
    terrain_pass_draw(scene->terrain_passes[view->index], scene->cache, TERRAIN_ALL);
    diamond_pass_draw_wire(scene->diamond_passes[view->index]);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glDisable(GL_POLYGON_OFFSET_LINE);
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
}

// ---- the aircraft ----

// Two times the tolerance, which holds where the view is centred; what promises nothing is off by more.
#define COARSE_SHARE 2.0
#define COARSE_M 0.2
#define UNPROMISED_SHARE 16.0
#define UNPROMISED_M 5.0

static CraftLand land_of(const Scene *scene, const SceneView *view) {
    double tolerance_rad = view->cut->view.tau_px / (double)scene->frame.block.ray_right[3];
    bool promised = view->cut->promises;
    return (CraftLand){.terrain = scene->terrain,
                       .coarse_m = promised ? COARSE_M : UNPROMISED_M,
                       .coarse_rad = (promised ? COARSE_SHARE : UNPROMISED_SHARE) * tolerance_rad,
                       .view_width = view->width,
                       .view_height = view->height};
}

// A flight without its aircraft is better than none.
static CraftCast prepare_craft(Scene *scene, const RenderPacket *packet, const SceneView *view) {
    CraftCast cast = {0};
    const RenderCraft *craft = &packet->craft;
    if ((!craft->show && !craft->casts) || scene->craft_refused)
        return cast;
    const CraftLand land = land_of(scene, view);
    Result result = scene->craft_pass ? RESULT_OK : craft_pass_create(&scene->craft_pass);
    if (result == RESULT_OK)
        result = craft_pass_prepare(scene->craft_pass, &scene->frame, craft, &land, &cast);
    scene->craft_refused = result != RESULT_OK;
    return cast;
}

static bool have_shaded_programs(Scene *scene) {
    if (scene->shaded_refused || scene->shaded_shore_program)
        return !scene->shaded_refused;
    Result result = create_land_program(scene, " SHADED", &scene->shaded_land_program);
    if (result == RESULT_OK)
        result = create_land_program(scene, " WATER SHADED", &scene->shaded_shore_program);
    scene->shaded_refused = result != RESULT_OK;
    return !scene->shaded_refused;
}

static void scissor(const SceneView *view, const CraftPixels *pixels) {
    glScissor(view->x + pixels->x, pixels->y, pixels->width, pixels->height);
}

static void clear_beside(const SceneView *view, const CraftCast *cast, float depth) {
    glClearDepthf(depth);
    for (int i = 0; i < cast->beside_count; i++) {
        scissor(view, &cast->beside[i]);
        glClear(GL_DEPTH_BUFFER_BIT);
    }
}

// What the shadow may lie on, before all other land: a branch saves a software renderer nothing, so no other pixel
// knows of it. Beside the aircraft's parts nothing is in front of the nearest depth meanwhile: that is cheaper than to
// draw part by part.
static void shade_patches(Scene *scene, const SceneView *view, const CraftCast *cast) {
    TerrainPass *pass = scene->terrain_passes[view->index];
    clear_beside(view, cast, 1.0f);
    scissor(view, &cast->pixels);
    glUseProgram(scene->shaded_land_program);
    terrain_pass_draw_near(pass, scene->cache, TERRAIN_DRY, cast->centre_ecef, cast->radius_m);
    glUseProgram(scene->shaded_shore_program);
    terrain_pass_draw_near(pass, scene->cache, TERRAIN_WET, cast->centre_ecef, cast->radius_m);
    clear_beside(view, cast, 0.0f);
    glScissor(view->x, 0, view->width, view->height);
}

static void draw_land(Scene *scene, const RenderPacket *packet, const SceneView *view, const CraftCast *cast) {
    TerrainPass *pass = scene->terrain_passes[view->index];
    if (cast->falls && have_shaded_programs(scene))
        shade_patches(scene, view, cast);
    glUseProgram(scene->land_program);
    terrain_pass_draw(pass, scene->cache, TERRAIN_DRY);
    glUseProgram(scene->shore_program);
    terrain_pass_draw(pass, scene->cache, TERRAIN_WET);
    diamond_pass_draw(scene->diamond_passes[view->index], packet->colouring, cast->falls);
}

void scene_draw(Scene *scene, const RenderPacket *packet, const SceneView *view, unsigned framebuffer) {
    atmosphere_update(scene->atmosphere, scene->frame.eye_h_m, scene->frame.mu_sun);
    set_state();
    bind_inputs(scene);
    CraftCast cast = prepare_craft(scene, packet, view);
    begin_picture(framebuffer, view);
    draw_land(scene, packet, view, &cast);
    if (!packet->magenta_background)
        sky_pass_draw(scene->sky_pass, &scene->frame, &cast);
    if (packet->craft.show && scene->craft_pass)
        craft_pass_draw(scene->craft_pass, &packet->craft);
    if (packet->wireframe)
        draw_wire(scene, view);
    glDisable(GL_SCISSOR_TEST);
    patch_cache_end_frame(scene->cache);
}

void scene_count(const Scene *scene, const SceneView *view, RenderCutStats *stats) {
    PatchCacheStats cache = patch_cache_stats(scene->cache);
    terrain_pass_count(scene->terrain_passes[view->index], stats);
    diamond_pass_count(scene->diamond_passes[view->index], stats);
    stats->upload_bytes = cache.upload_bytes;
    stats->evictions = cache.evictions;
}

void scene_forget_patches(Scene *scene) {
    patch_cache_clear(scene->cache);
}

int64_t scene_vram_bytes(const Scene *scene) {
    return patch_cache_stats(scene->cache).used_bytes + (int64_t)diamond_pass_bytes(scene->diamond_passes[0]) +
           (int64_t)diamond_pass_bytes(scene->diamond_passes[1]);
}
