#include "render/sky_pass.h"

#include "base/log.h"
#include "render/gl.h"
#include "render/shader.h"
#include "terrain/geodesy.h"

#include <stdio.h>
#include <stdlib.h>

// A software renderer computes both sides of every branch. So the screen is cut into tiles, and each is drawn with the
// sky's program, the globe's, or both where the horizon passes through it.
#define TILES_X 20
#define TILES_Y 16
#define TILE_FLOATS 12 // two triangles

typedef struct TileList {
    float corners[TILES_X * TILES_Y][TILE_FLOATS]; // clip space
    int count;
} TileList;

struct SkyPass {
    GLuint sky_program, globe_program, vertex_array, buffer;
    GLuint shaded_program; // of the globe under an aircraft's shadow; 0 until it is called for
    bool shaded_refused;   // it could not be made, and the log said why
    char defines[64];      // of the globe's programs
    TileList sky, globe, shaded;
};

static Result create_globe_program(const SkyPass *pass, const char *more, GLuint *program) {
    char defines[96];
    snprintf(defines, sizeof defines, "%s%s", pass->defines, more);
    const ShaderSpec spec = {.stages = {"sky.vert", "globe.frag"}, .defines = defines};
    return shader_create_program(&spec, program);
}

Result sky_pass_create(const char *defines, SkyPass **out) {
    const ShaderSpec sky = {.stages = {"sky.vert", "sky.frag"}};
    SkyPass *pass = calloc(1, sizeof *pass);
    if (!pass) {
        log_error("out of memory for the sky");
        return RESULT_MEMORY;
    }
    snprintf(pass->defines, sizeof pass->defines, "%s", defines);
    glCreateVertexArrays(1, &pass->vertex_array);
    glCreateBuffers(1, &pass->buffer);
    glEnableVertexArrayAttrib(pass->vertex_array, 0);
    glVertexArrayAttribFormat(pass->vertex_array, 0, 2, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(pass->vertex_array, 0, 0);
    Result result = shader_create_program(&sky, &pass->sky_program);
    if (result == RESULT_OK)
        result = create_globe_program(pass, "", &pass->globe_program);
    if (result != RESULT_OK) {
        sky_pass_destroy(&pass);
        return result;
    }
    *out = pass;
    return RESULT_OK;
}

void sky_pass_destroy(SkyPass **pass) {
    SkyPass *self = *pass;
    if (!self)
        return;
    glDeleteProgram(self->sky_program);
    glDeleteProgram(self->globe_program);
    glDeleteProgram(self->shaded_program);
    glDeleteVertexArrays(1, &self->vertex_array);
    glDeleteBuffers(1, &self->buffer);
    free(self);
    *pass = NULL;
}

static Vec3d vec3d_of(const float v[4]) {
    return (Vec3d){v[0], v[1], v[2]};
}

// What the shaders compute for a pixel: its direction in round space.
static Vec3d direction_at(const Frame *frame, double x, double y) {
    Vec3d look = vec3d_of(frame->block.ray_ahead);
    look = vec3d_mad(look, vec3d_of(frame->block.ray_right), x);
    look = vec3d_mad(look, vec3d_of(frame->block.ray_up), y);
    return vec3d_normalize(frame_round(look));
}

static double angle_between(Vec3d a, Vec3d b) {
    return acos(fmin(fmax(vec3d_dot(a, b), -1.0), 1.0));
}

// Clip space.
typedef struct Tile {
    double left, bottom, right, top;
} Tile;

static void add_tile(TileList *list, const Tile *tile) {
    const double corners[TILE_FLOATS] = {tile->left, tile->bottom, tile->right, tile->bottom, tile->right, tile->top,
                                         tile->left, tile->bottom, tile->right, tile->top,    tile->left,  tile->top};
    for (int i = 0; i < TILE_FLOATS; i++)
        list->corners[list->count][i] = (float)corners[i];
    list->count++;
}

// From straight up to where the globe begins.
static double horizon_angle(const Frame *frame) {
    double globe = GEODESY_A_M + frame->globe_m, eye = GEODESY_A_M + frame->eye_h_m;
    return GEODESY_PI - asin(fmin(globe / eye, 1.0));
}

#define ANGLE_SLACK_RAD 1e-4 // the shaders' arithmetic is in float

static bool in_shadow(const Tile *tile, const CraftCast *cast) {
    return cast->falls && cast->on_globe && tile->right > cast->clip.left && tile->left < cast->clip.right &&
           tile->top > cast->clip.bottom && tile->bottom < cast->clip.top;
}

static void sort_tile(SkyPass *pass, const Frame *frame, const CraftCast *cast, double horizon, const Tile *tile) {
    Vec3d middle = direction_at(frame, (tile->left + tile->right) * 0.5, (tile->bottom + tile->top) * 0.5);
    // Seen from the eye a tile is convex: its corners are the furthest from its middle.
    double radius = fmax(angle_between(middle, direction_at(frame, tile->left, tile->bottom)),
                         angle_between(middle, direction_at(frame, tile->right, tile->bottom)));
    radius = fmax(radius, angle_between(middle, direction_at(frame, tile->left, tile->top)));
    radius = fmax(radius, angle_between(middle, direction_at(frame, tile->right, tile->top))) + ANGLE_SLACK_RAD;
    double angle = angle_between(middle, vec3d_of(frame->block.eye_up));
    if (angle - radius < horizon)
        add_tile(&pass->sky, tile);
    if (angle + radius > horizon)
        add_tile(in_shadow(tile, cast) ? &pass->shaded : &pass->globe, tile);
}

static void draw_tiles(const SkyPass *pass, const TileList *list, GLuint program) {
    if (!list->count)
        return;
    glNamedBufferData(pass->buffer, (GLsizeiptr)((size_t)list->count * sizeof list->corners[0]), list->corners,
                      GL_STREAM_DRAW);
    glVertexArrayVertexBuffer(pass->vertex_array, 0, pass->buffer, 0, 2 * sizeof(float));
    glBindVertexArray(pass->vertex_array);
    glUseProgram(program);
    glDrawArrays(GL_TRIANGLES, 0, list->count * TILE_FLOATS / 2);
    glBindVertexArray(0);
}

// Without it, the globe's own.
static GLuint shaded_program(SkyPass *pass) {
    if (!pass->shaded_program && !pass->shaded_refused)
        pass->shaded_refused = create_globe_program(pass, " SHADED", &pass->shaded_program) != RESULT_OK;
    return pass->shaded_refused ? pass->globe_program : pass->shaded_program;
}

void sky_pass_draw(SkyPass *pass, const Frame *frame, const CraftCast *cast) {
    double horizon = horizon_angle(frame);
    pass->sky.count = pass->globe.count = pass->shaded.count = 0;
    for (int y = 0; y < TILES_Y; y++)
        for (int x = 0; x < TILES_X; x++) {
            const Tile tile = {2.0 * x / TILES_X - 1.0, 2.0 * y / TILES_Y - 1.0, 2.0 * (x + 1) / TILES_X - 1.0,
                               2.0 * (y + 1) / TILES_Y - 1.0};
            sort_tile(pass, frame, cast, horizon, &tile);
        }
    glDepthFunc(GL_EQUAL);
    glDepthMask(GL_FALSE);
    draw_tiles(pass, &pass->sky, pass->sky_program);
    draw_tiles(pass, &pass->globe, pass->globe_program);
    if (pass->shaded.count)
        draw_tiles(pass, &pass->shaded, shaded_program(pass));
    glDepthMask(GL_TRUE);
}
