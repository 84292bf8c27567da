#include "render/ground/ground.h"

#include "base/clock.h"
#include "base/log.h"
#include "render/gl.h"
#include "render/ground/ground_shade.h"
#include "render/ground/ground_source.h"
#include "render/ground/ground_surface.h"
#include "render/ground/noise.h"
#include "terrain/geodesy.h"

#include <stdlib.h>

#define ANISOTROPY 8.0f
#define SHADE_TURN_RAD (1.0 * GEODESY_RAD_PER_DEG)

struct Ground {
    const Terrain *terrain;
    GroundSource source;
    GLuint textures[GROUND_UNITS];
    GLuint block_buffer;
    GroundBlock block;
    uint32_t *wet_blocks; // as GroundSurface has them
    int wet_width, wet_height;
    Vec3d middle_ecef, east, north;
    bool software, has_holes, has_shade;
    double shade_azimuth_rad;
};

static GLuint create_texture(GLenum format, int width, int height, GLenum wrap, bool software) {
    GLuint texture = 0;
    int levels = 1;
    while (width >> levels || height >> levels)
        levels++;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, levels, format, width, height);
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, software ? GL_LINEAR_MIPMAP_NEAREST : GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_S, (GLint)wrap);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_T, (GLint)wrap);
    if (!software && epoxy_has_gl_extension("GL_EXT_texture_filter_anisotropic"))
        glTextureParameterf(texture, GL_TEXTURE_MAX_ANISOTROPY_EXT, ANISOTROPY);
    return texture;
}

static void fill_texture(GLuint texture, int width, int height, GLenum format, GLenum type, const void *pixels) {
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage2D(texture, 0, 0, 0, width, height, format, type, pixels);
    glGenerateTextureMipmap(texture);
}

static void fill_block(Ground *ground, const GroundSurface *surface) {
    const GroundSource *source = &ground->source;
    GroundJacobian j = ground_source_jacobian(source, source->width / 2, source->height / 2);
    double col_m = hypot(j.east_col, j.north_col), row_m = hypot(j.east_row, j.north_row);
    GroundBlock *block = &ground->block;
    block->texel[0] = 1.0f / (float)(source->width * source->step);
    block->texel[1] = 1.0f / (float)(source->height * source->step);
    block->texel[2] = 0.5f / (float)source->width;
    block->texel[3] = 0.5f / (float)source->height;
    block->height[0] = fmaxf(source->max_m - source->min_m, 1.0f);
    block->height[1] = source->min_m;
    block->height[2] = (float)sqrt(col_m * row_m);
    block->noise[0] = (float)(col_m / source->step / GROUND_NOISE_M);
    block->noise[1] = (float)(row_m / source->step / GROUND_NOISE_M);
    block->noise[2] = (float)source->width;
    block->noise[3] = (float)source->height;
    bool sea = surface->border_water > 0.5f;
    block->globe[0] = sea ? 0.0f : surface->border_m;
    block->globe[1] = sea ? 1.0f : 0.0f;
    glCreateBuffers(1, &ground->block_buffer);
    glNamedBufferStorage(ground->block_buffer, sizeof *block, block, 0);
}

static Result create_surface(Ground *ground, Jobs *jobs) {
    const GroundSource *source = &ground->source;
    GroundSurface surface;
    Result result = ground_surface_create(source, jobs, &surface);
    if (result != RESULT_OK)
        return result;
    GLuint cells = create_texture(GL_RGBA8, source->width, source->height, GL_CLAMP_TO_EDGE, ground->software);
    fill_texture(cells, source->width, source->height, GL_RGBA, GL_UNSIGNED_BYTE, surface.cells);
    GLuint heights = create_texture(GL_R16, source->width, source->height, GL_CLAMP_TO_EDGE, ground->software);
    fill_texture(heights, source->width, source->height, GL_RED, GL_UNSIGNED_SHORT, surface.heights);
    ground->textures[GROUND_UNIT_SURFACE] = cells;
    ground->textures[GROUND_UNIT_HEIGHT] = heights;
    fill_block(ground, &surface);
    ground->wet_blocks = surface.wet_blocks;
    ground->wet_width = surface.wet_width;
    ground->wet_height = source->height / GROUND_BLOCK + 2;
    surface.wet_blocks = NULL;
    ground_surface_destroy(&surface);
    return RESULT_OK;
}

static Result create_noise(Ground *ground) {
    uint8_t *texels = malloc((size_t)NOISE_SIDE * NOISE_SIDE * 4);
    if (!texels) {
        log_error("out of memory for the picture of the ground");
        return RESULT_MEMORY;
    }
    noise_fill(texels);
    GLuint texture = create_texture(GL_RGBA8, NOISE_SIDE, NOISE_SIDE, GL_REPEAT, ground->software);
    fill_texture(texture, NOISE_SIDE, NOISE_SIDE, GL_RGBA, GL_UNSIGNED_BYTE, texels);
    ground->textures[GROUND_UNIT_NOISE] = texture;
    free(texels);
    return RESULT_OK;
}

// A texel of 255 for every void sample.
static Result create_holes(Ground *ground) {
    const Dem *dem = terrain_dem(ground->terrain);
    const GroundSource *source = &ground->source;
    ground->has_holes = dem->void_bits != NULL;
    if (!ground->has_holes)
        return RESULT_OK;
    uint8_t *texels = malloc((size_t)source->width * (size_t)source->height);
    if (!texels) {
        log_error("out of memory for the holes in the ground");
        return RESULT_MEMORY;
    }
    for (int row = 0; row < source->height; row++)
        for (int col = 0; col < source->width; col++)
            texels[(size_t)row * (size_t)source->width + (size_t)col] =
                dem_is_void(dem, col * source->step, row * source->step) ? 255 : 0;
    GLuint texture = create_texture(GL_R8, source->width, source->height, GL_CLAMP_TO_EDGE, true);
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    fill_texture(texture, source->width, source->height, GL_RED, GL_UNSIGNED_BYTE, texels);
    ground->textures[GROUND_UNIT_HOLES] = texture;
    free(texels);
    return RESULT_OK;
}

static void find_middle(Ground *ground) {
    const Dem *dem = terrain_dem(ground->terrain);
    Vec3d up;
    grid_base(terrain_grid(ground->terrain), dem->width / 2, dem->height / 2, &ground->middle_ecef, &up);
    ground->east = vec3d_normalize(vec3d(-up.y, up.x, 0.0));
    ground->north = vec3d_cross(up, ground->east);
}

static Result create_parts(Ground *ground) {
    Jobs *jobs = NULL;
    GLint side_max = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &side_max);
    Result result = ground_source_create(ground->terrain, side_max, &ground->source);
    if (result != RESULT_OK)
        return result;
    if ((result = jobs_create(0, &jobs)) != RESULT_OK)
        return result;
    result = create_surface(ground, jobs);
    jobs_destroy(&jobs);
    if (result == RESULT_OK)
        result = create_noise(ground);
    if (result == RESULT_OK)
        result = create_holes(ground);
    ground->textures[GROUND_UNIT_SHADE] =
        create_texture(GL_R8, ground->source.width, ground->source.height, GL_CLAMP_TO_EDGE, ground->software);
    return result;
}

Result ground_create(const Terrain *terrain, bool software, Ground **out) {
    int64_t begin_ns = clock_now_ns();
    Ground *ground = calloc(1, sizeof *ground);
    if (!ground) {
        log_error("out of memory for the picture of the ground");
        return RESULT_MEMORY;
    }
    ground->terrain = terrain;
    ground->software = software;
    find_middle(ground);
    Result result = create_parts(ground);
    if (result != RESULT_OK) {
        ground_destroy(&ground);
        return result;
    }
    log_debug("picture of the ground: %.2f s", (double)(clock_now_ns() - begin_ns) * 1e-9);
    *out = ground;
    return RESULT_OK;
}

void ground_destroy(Ground **ground) {
    Ground *self = *ground;
    if (!self)
        return;
    glDeleteTextures(GROUND_UNITS, self->textures);
    glDeleteBuffers(1, &self->block_buffer);
    ground_source_destroy(&self->source);
    free(self->wet_blocks);
    free(self);
    *ground = NULL;
}

static Result build_shade(Ground *ground, double azimuth_rad) {
    const GroundSource *source = &ground->source;
    Jobs *jobs = NULL;
    uint8_t *texels = malloc((size_t)source->width * (size_t)source->height);
    if (!texels) {
        log_error("out of memory for the ground's shadows");
        return RESULT_MEMORY;
    }
    Result result = jobs_create(0, &jobs);
    if (result == RESULT_OK)
        result = ground_shade_build(source, azimuth_rad, jobs, texels);
    if (result == RESULT_OK)
        fill_texture(ground->textures[GROUND_UNIT_SHADE], source->width, source->height, GL_RED, GL_UNSIGNED_BYTE,
                     texels);
    if (jobs)
        jobs_destroy(&jobs);
    free(texels);
    return result;
}

void ground_follow_sun(Ground *ground, Vec3d sun_ecef) {
    double azimuth = atan2(vec3d_dot(sun_ecef, ground->east), vec3d_dot(sun_ecef, ground->north));
    double turn = remainder(azimuth - ground->shade_azimuth_rad, 2.0 * GEODESY_PI);
    if (ground->has_shade && fabs(turn) < SHADE_TURN_RAD)
        return;
    // Not tried again each frame after a failure.
    ground->has_shade = true;
    ground->shade_azimuth_rad = azimuth;
    Result result = build_shade(ground, azimuth);
    if (result != RESULT_OK)
        log_warn("the ground's shadows stay as they were: %s", result_text(result));
}

void ground_bind(const Ground *ground) {
    glBindTextures(0, GROUND_UNITS, ground->textures);
    glBindBufferBase(GL_UNIFORM_BUFFER, GROUND_BLOCK_BINDING, ground->block_buffer);
}

static int block_corner(int cell, int count) {
    int block = cell < 0 ? 0 : cell / GROUND_BLOCK;
    return block < count ? block : count - 1;
}

bool ground_is_wet(const Ground *ground, int col, int row, int cols, int rows) {
    int step = ground->source.step, width = ground->wet_width;
    // One cell more on every side: the texture is read between cells.
    int left = block_corner(col / step - 1, width - 1), top = block_corner(row / step - 1, ground->wet_height - 1);
    int right = block_corner((col + cols) / step + 1, width - 1) + 1;
    int bottom = block_corner((row + rows) / step + 1, ground->wet_height - 1) + 1;
    const uint32_t *upper = ground->wet_blocks + (size_t)top * (size_t)width;
    const uint32_t *lower = ground->wet_blocks + (size_t)bottom * (size_t)width;
    return lower[right] - lower[left] - upper[right] + upper[left] > 0;
}

bool ground_has_holes(const Ground *ground) {
    return ground->has_holes;
}

Vec3d ground_middle_ecef(const Ground *ground) {
    return ground->middle_ecef;
}

bool ground_in_sea(const Ground *ground) {
    return ground->block.globe[1] > 0.5f;
}

double ground_globe_m(const Ground *ground) {
    return ground->block.globe[0];
}

void ground_noise_repeats(const Ground *ground, double out[2]) {
    out[0] = ground->block.noise[0];
    out[1] = ground->block.noise[1];
}
