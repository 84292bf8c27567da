#include "render/ground/drape.h"

#include "assets/image.h"
#include "base/log.h"
#include "render/gl.h"
#include "render/ground/drape_place.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <stdlib.h>

#define MAP_SIDE 65 // nodes a side: between them the map is bilinear, within centimetres for a UTM grid of 100 km

struct Drape {
    GLuint image, map; // textures
    GLuint block_buffer;
    DrapePlace place;
};

static GLuint create_texture(GLenum format, int levels, int width, int height, bool around) {
    GLuint texture = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, levels, format, width, height);
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, levels > 1 ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_S, around ? GL_REPEAT : GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return texture;
}

static bool goes_around(const DrapePlace *place) {
    return !place->utm && place->across > 359.9;
}

static Result load_image(Drape *drape, const char *path, bool software) {
    GLint side_max = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &side_max);
    ImagePicture picture;
    Result result = image_read_picture(path, side_max, &picture);
    if (result != RESULT_OK)
        return result;
    int levels = 1;
    while (picture.width >> levels || picture.height >> levels)
        levels++;
    drape->image = create_texture(GL_RGBA8, levels, picture.width, picture.height, goes_around(&drape->place));
    if (!software && epoxy_has_gl_extension("GL_EXT_texture_filter_anisotropic"))
        glTextureParameterf(drape->image, GL_TEXTURE_MAX_ANISOTROPY_EXT, 8.0f);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage2D(drape->image, 0, 0, 0, picture.width, picture.height, GL_RGBA, GL_UNSIGNED_BYTE, picture.rgba);
    glGenerateTextureMipmap(drape->image);
    free(picture.rgba);
    return RESULT_OK;
}

// A longitude inside the image to which those of the data are brought near.
static double middle_longitude(const DrapePlace *place, const Grid *grid, const Dem *dem) {
    double lat_deg = 0.0, lon_deg = 0.0;
    grid_geodetic(grid, dem->width * 0.5, dem->height * 0.5, &lat_deg, &lon_deg);
    double middle = place->utm ? lon_deg : place->west + place->across * 0.5;
    return middle + remainder(lon_deg - middle, 360.0);
}

// A picture smaller than the gaps between nodes counts as well: what all of them span is compared.
static void warn_when_beside(const char *path, float (*nodes)[MAP_SIDE][2]) {
    bool beside = false;
    for (int axis = 0; axis < 2; axis++) {
        float low = INFINITY, high = -INFINITY;
        for (int i = 0; i < MAP_SIDE * MAP_SIDE; i++) {
            float at = nodes[i / MAP_SIDE][i % MAP_SIDE][axis];
            low = fminf(low, at);
            high = fmaxf(high, at);
        }
        beside |= high < 0.0f || low > 1.0f;
    }
    if (beside)
        log_warn("%s: the picture lies beside the terrain, none of which it covers; check its bounds", path);
}

// Image coordinates at nodes over the DEM, its first and last samples included.
static void create_map(Drape *drape, const char *path, const Terrain *terrain) {
    static const float OUTSIDE[2] = {-9.0f, -9.0f};
    const Dem *dem = terrain_dem(terrain);
    const Grid *grid = terrain_grid(terrain);
    float nodes[MAP_SIDE][MAP_SIDE][2];
    double near_lon_deg = middle_longitude(&drape->place, grid, dem);
    for (int y = 0; y < MAP_SIDE; y++) {
        for (int x = 0; x < MAP_SIDE; x++) {
            double lat_deg = 0.0, lon_deg = 0.0, u = OUTSIDE[0], v = OUTSIDE[1];
            grid_geodetic(grid, (dem->width - 1.0) * x / (MAP_SIDE - 1), (dem->height - 1.0) * y / (MAP_SIDE - 1),
                          &lat_deg, &lon_deg);
            (void)drape_place_locate(&drape->place, lat_deg, lon_deg, near_lon_deg, &u, &v);
            nodes[y][x][0] = (float)u;
            nodes[y][x][1] = (float)v;
        }
    }
    warn_when_beside(path, nodes);
    drape->map = create_texture(GL_RG32F, 1, MAP_SIDE, MAP_SIDE, false);
    glTextureSubImage2D(drape->map, 0, 0, 0, MAP_SIDE, MAP_SIDE, GL_RG, GL_FLOAT, nodes);
}

static void create_block(Drape *drape, const Dem *dem) {
    const DrapePlace *place = &drape->place;
    DrapeBlock block = {{0}, {0}, {0}};
    if (!place->utm) {
        block.globe[0] = (float)(place->west * GEODESY_RAD_PER_DEG);
        block.globe[1] = (float)(place->north * GEODESY_RAD_PER_DEG);
        block.globe[2] = (float)(1.0 / (place->across * GEODESY_RAD_PER_DEG));
        block.globe[3] = (float)(-1.0 / (place->down * GEODESY_RAD_PER_DEG));
    }
    // Node i is the texel whose centre is at (i + 0.5) / MAP_SIDE.
    block.map[0] = (float)(MAP_SIDE - 1) / (float)MAP_SIDE / (float)(dem->width - 1);
    block.map[1] = (float)(MAP_SIDE - 1) / (float)MAP_SIDE / (float)(dem->height - 1);
    block.map[2] = block.map[3] = 0.5f / (float)MAP_SIDE;
    block.image[0] = goes_around(place) ? 1.0f : 0.0f;
    glCreateBuffers(1, &drape->block_buffer);
    glNamedBufferStorage(drape->block_buffer, sizeof block, &block, 0);
}

Result drape_create(const RenderOptions *options, const Terrain *terrain, bool software, Drape **out) {
    Drape *drape = calloc(1, sizeof *drape);
    if (!drape) {
        log_error("out of memory for the draped image");
        return RESULT_MEMORY;
    }
    Result result = drape_place_find(options, &drape->place);
    if (result == RESULT_OK)
        result = load_image(drape, options->image_path, software);
    if (result != RESULT_OK) {
        drape_destroy(&drape);
        return result;
    }
    create_map(drape, options->image_path, terrain);
    create_block(drape, terrain_dem(terrain));
    *out = drape;
    return RESULT_OK;
}

void drape_destroy(Drape **drape) {
    Drape *self = *drape;
    if (!self)
        return;
    glDeleteTextures(1, &self->image);
    glDeleteTextures(1, &self->map);
    glDeleteBuffers(1, &self->block_buffer);
    free(self);
    *drape = NULL;
}

void drape_bind(const Drape *drape) {
    glBindTextureUnit(DRAPE_UNIT_IMAGE, drape->image);
    glBindTextureUnit(DRAPE_UNIT_MAP, drape->map);
    glBindBufferBase(GL_UNIFORM_BUFFER, DRAPE_BLOCK_BINDING, drape->block_buffer);
}
