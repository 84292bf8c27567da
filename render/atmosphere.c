#include "render/atmosphere.h"

#include "base/log.h"
#include "render/gl.h"
#include "render/shader.h"

#include <stdlib.h>

// Sizes as shaders/atmosphere.glsl has them.
enum { TRANSMITTANCE_WIDTH = 256, TRANSMITTANCE_HEIGHT = 64 };
enum { MULTIPLE_SIDE = 32 };
enum { SKY_VIEW_WIDTH = 64, SKY_VIEW_HEIGHT = 128 };
enum { LIGHT_WIDTH = 64, LIGHT_HEIGHT = 4 };
#define LIGHT_DEFINES "GROUND_LIGHT_WIDTH=64 GROUND_LIGHT_HEIGHT=4"
#define LIGHT_TOP_M 8000.0
#define LIGHT_MU_MIN (-0.2)

struct Atmosphere {
    GLuint transmittance, multiple, radiance, source, light_sun, light_sky; // textures
    GLuint sky_program, sky_framebuffer, vertex_array;
    float sun[LIGHT_HEIGHT][LIGHT_WIDTH][4], sky[LIGHT_HEIGHT][LIGHT_WIDTH][4];
    float eye_km, mu_sun; // of the sky at hand
    bool sky_drawn;
};

static GLuint create_table(int width, int height, GLenum format) {
    GLuint texture = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, 1, format, width, height);
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return texture;
}

static GLuint create_framebuffer(GLuint first, GLuint second) {
    static const GLenum BUFFERS[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    GLuint framebuffer = 0;
    glCreateFramebuffers(1, &framebuffer);
    glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, first, 0);
    if (second)
        glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT1, second, 0);
    glNamedFramebufferDrawBuffers(framebuffer, second ? 2 : 1, BUFFERS);
    return framebuffer;
}

static void draw_table(const Atmosphere *atmosphere, GLuint framebuffer, GLuint program, int width, int height) {
    const GLuint inputs[] = {atmosphere->transmittance, atmosphere->multiple};
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, width, height);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glBindTextures(0, COUNT_OF(inputs), inputs);
    glUseProgram(program);
    glBindVertexArray(atmosphere->vertex_array);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindVertexArray(0);
}

// One table, drawn once with a program that is not needed again.
static Result draw_table_once(const Atmosphere *atmosphere, const char *file, const char *defines, GLuint first,
                              GLuint second, int width, int height) {
    const ShaderSpec spec = {.stages = {"fullscreen.vert", file}, .defines = defines};
    GLuint program = 0;
    Result result = shader_create_program(&spec, &program);
    if (result != RESULT_OK)
        return result;
    GLuint framebuffer = create_framebuffer(first, second);
    draw_table(atmosphere, framebuffer, program, width, height);
    glDeleteFramebuffers(1, &framebuffer);
    glDeleteProgram(program);
    return RESULT_OK;
}

// Two small tables, read back for the frame's uniforms.
static Result draw_ground_light(Atmosphere *atmosphere) {
    atmosphere->light_sun = create_table(LIGHT_WIDTH, LIGHT_HEIGHT, GL_RGBA32F);
    atmosphere->light_sky = create_table(LIGHT_WIDTH, LIGHT_HEIGHT, GL_RGBA32F);
    Result result = draw_table_once(atmosphere, "atmosphere_ground.frag", LIGHT_DEFINES, atmosphere->light_sun,
                                    atmosphere->light_sky, LIGHT_WIDTH, LIGHT_HEIGHT);
    glGetTextureImage(atmosphere->light_sun, 0, GL_RGBA, GL_FLOAT, sizeof atmosphere->sun, atmosphere->sun);
    glGetTextureImage(atmosphere->light_sky, 0, GL_RGBA, GL_FLOAT, sizeof atmosphere->sky, atmosphere->sky);
    return result;
}

static Result draw_tables(Atmosphere *atmosphere) {
    const ShaderSpec sky = {.stages = {"fullscreen.vert", "sky_view.frag"}};
    glCreateVertexArrays(1, &atmosphere->vertex_array);
    atmosphere->transmittance = create_table(TRANSMITTANCE_WIDTH, TRANSMITTANCE_HEIGHT, GL_RGBA16F);
    atmosphere->multiple = create_table(MULTIPLE_SIDE, MULTIPLE_SIDE, GL_RGBA16F);
    atmosphere->radiance = create_table(SKY_VIEW_WIDTH, SKY_VIEW_HEIGHT, GL_RGBA16F);
    atmosphere->source = create_table(SKY_VIEW_WIDTH, SKY_VIEW_HEIGHT, GL_RGBA16F);
    atmosphere->sky_framebuffer = create_framebuffer(atmosphere->radiance, atmosphere->source);
    Result result = draw_table_once(atmosphere, "atmosphere_transmittance.frag", NULL, atmosphere->transmittance, 0,
                                    TRANSMITTANCE_WIDTH, TRANSMITTANCE_HEIGHT);
    if (result == RESULT_OK)
        result = draw_table_once(atmosphere, "atmosphere_multiple.frag", NULL, atmosphere->multiple, 0, MULTIPLE_SIDE,
                                 MULTIPLE_SIDE);
    if (result == RESULT_OK)
        result = draw_ground_light(atmosphere);
    if (result == RESULT_OK)
        result = shader_create_program(&sky, &atmosphere->sky_program);
    return result;
}

Result atmosphere_create(Atmosphere **out) {
    Atmosphere *atmosphere = calloc(1, sizeof *atmosphere);
    if (!atmosphere) {
        log_error("out of memory for the atmosphere");
        return RESULT_MEMORY;
    }
    GLint bound = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
    Result result = draw_tables(atmosphere);
    glBindFramebuffer(GL_FRAMEBUFFER, (GLuint)bound);
    if (result != RESULT_OK) {
        atmosphere_destroy(&atmosphere);
        return result;
    }
    *out = atmosphere;
    return RESULT_OK;
}

void atmosphere_destroy(Atmosphere **atmosphere) {
    Atmosphere *self = *atmosphere;
    if (!self)
        return;
    const GLuint textures[] = {self->transmittance, self->multiple,  self->radiance,
                               self->source,        self->light_sun, self->light_sky};
    glDeleteTextures(COUNT_OF(textures), textures);
    glDeleteFramebuffers(1, &self->sky_framebuffer);
    glDeleteVertexArrays(1, &self->vertex_array);
    glDeleteProgram(self->sky_program);
    free(self);
    *atmosphere = NULL;
}

#define HEIGHT_STEPS 36.0    // per doubling: 2 %
#define HEIGHT_SHIFT_M 300.0 // below it the steps stop shrinking
#define MU_STEPS 1024.0

static double quantise_height(double h_m) {
    double step = round(log2(fmax(h_m, 0.0) + HEIGHT_SHIFT_M) * HEIGHT_STEPS);
    return exp2(step / HEIGHT_STEPS) - HEIGHT_SHIFT_M;
}

void atmosphere_update(Atmosphere *atmosphere, double eye_h_m, double mu_sun) {
    float eye_km = (float)(fmax(quantise_height(eye_h_m), 0.0) * 1e-3);
    float mu = (float)(round(mu_sun * MU_STEPS) / MU_STEPS);
    if (atmosphere->sky_drawn && eye_km == atmosphere->eye_km && mu == atmosphere->mu_sun)
        return;
    glProgramUniform2f(atmosphere->sky_program, 0, eye_km, mu);
    draw_table(atmosphere, atmosphere->sky_framebuffer, atmosphere->sky_program, SKY_VIEW_WIDTH, SKY_VIEW_HEIGHT);
    atmosphere->eye_km = eye_km;
    atmosphere->mu_sun = mu;
    atmosphere->sky_drawn = true;
}

unsigned atmosphere_radiance(const Atmosphere *atmosphere) {
    return atmosphere->radiance;
}

unsigned atmosphere_source(const Atmosphere *atmosphere) {
    return atmosphere->source;
}

unsigned atmosphere_light_sun(const Atmosphere *atmosphere) {
    return atmosphere->light_sun;
}

unsigned atmosphere_light_sky(const Atmosphere *atmosphere) {
    return atmosphere->light_sky;
}

// Position in a table of `count` entries whose ends are at 0 and 1.
static int split_position(double share, int count, float *rest) {
    double position = fmin(fmax(share, 0.0), 1.0) * (count - 1);
    int begin = (int)fmin(floor(position), count - 2);
    *rest = (float)(position - begin);
    return begin;
}

static Vec3f look_up(const float table[LIGHT_HEIGHT][LIGHT_WIDTH][4], int x, float fx, int y, float fy) {
    float out[3];
    for (int i = 0; i < 3; i++) {
        float low = table[y][x][i] + (table[y][x + 1][i] - table[y][x][i]) * fx;
        float high = table[y + 1][x][i] + (table[y + 1][x + 1][i] - table[y + 1][x][i]) * fx;
        out[i] = low + (high - low) * fy;
    }
    return (Vec3f){out[0], out[1], out[2]};
}

AtmosphereLight atmosphere_light(const Atmosphere *atmosphere, double h_m, double mu_sun) {
    float fx = 0.0f, fy = 0.0f;
    int x = split_position((mu_sun - LIGHT_MU_MIN) / (1.0 - LIGHT_MU_MIN), LIGHT_WIDTH, &fx);
    int y = split_position(h_m / LIGHT_TOP_M, LIGHT_HEIGHT, &fy);
    return (AtmosphereLight){.sun = look_up(atmosphere->sun, x, fx, y, fy),
                             .sky = look_up(atmosphere->sky, x, fx, y, fy)};
}
