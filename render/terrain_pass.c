#include "render/terrain_pass.h"

#include "base/log.h"
#include "render/gl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ATTRIBUTE_VERTEX, ATTRIBUTE_SAMPLE, ATTRIBUTE_LO, ATTRIBUTE_HI, ATTRIBUTE_INFO, ATTRIBUTE_PHASE };
enum { BINDING_VERTICES, BINDING_INSTANCES };

#define STATE_UPLOADED 2u // beyond LodItemState: the page came in this frame

// A patch that is in the cache; outlives the cut it came from.
typedef struct Placed {
    PatchPlace place;
    uint32_t index_count;
    GridPoint origin;
    int32_t col0, row0;
    uint32_t info; // level | state << 8 | partition << 16
    bool wet;      // has water
    Vec3d centre_ecef;
    double radius_m;
} Placed;

// As glMultiDrawElementsIndirect reads it.
typedef struct DrawCommand {
    uint32_t index_count, instance_count, first_index;
    int32_t base_vertex;
    uint32_t base_instance;
} DrawCommand;

// The attributes of shaders/terrain.vert that belong to a patch.
typedef struct Instance {
    int32_t lo[3], col0;
    int32_t hi[3], row0;
    uint32_t info;
    float noise_phase[2];
} Instance;
_Static_assert(sizeof(Instance) == 44, "attribute offsets below");

typedef struct Visible {
    bool wet;
    double distance_m;
    int32_t index;
} Visible;

struct TerrainPass {
    GLuint vertex_array, commands_buffer, instances_buffer;
    Placed *placed;
    PatchPlace *places;
    LodItem *in_view; // the cut's, while not all of it fits into the cache
    Visible *visible;
    DrawCommand *commands;
    Instance *instances;
    int32_t capacity, placed_count, visible_count, dry_count; // the dry ones come first
    int64_t triangles;
    double noise_repeats[2]; // per column and row
    uint64_t placed_last;    // patch_cache_last_placed of `placed`
    bool partial;            // what is placed is not all that is in view of the cut
    bool over_budget;        // and it has been said
};

static void describe_attributes(GLuint vertex_array) {
    glVertexArrayAttribIFormat(vertex_array, ATTRIBUTE_VERTEX, 3, GL_INT, offsetof(LodVertex, x));
    glVertexArrayAttribIFormat(vertex_array, ATTRIBUTE_SAMPLE, 2, GL_UNSIGNED_SHORT, offsetof(LodVertex, col));
    glVertexArrayAttribIFormat(vertex_array, ATTRIBUTE_LO, 4, GL_INT, offsetof(Instance, lo));
    glVertexArrayAttribIFormat(vertex_array, ATTRIBUTE_HI, 4, GL_INT, offsetof(Instance, hi));
    glVertexArrayAttribIFormat(vertex_array, ATTRIBUTE_INFO, 1, GL_UNSIGNED_INT, offsetof(Instance, info));
    glVertexArrayAttribFormat(vertex_array, ATTRIBUTE_PHASE, 2, GL_FLOAT, GL_FALSE, offsetof(Instance, noise_phase));
    for (GLuint i = ATTRIBUTE_VERTEX; i <= ATTRIBUTE_PHASE; i++) {
        glEnableVertexArrayAttrib(vertex_array, i);
        glVertexArrayAttribBinding(vertex_array, i, i <= ATTRIBUTE_SAMPLE ? BINDING_VERTICES : BINDING_INSTANCES);
    }
    glVertexArrayBindingDivisor(vertex_array, BINDING_INSTANCES, 1);
}

Result terrain_pass_create(const double noise_repeats[2], TerrainPass **out) {
    TerrainPass *pass = calloc(1, sizeof *pass);
    if (!pass) {
        log_error("out of memory for the terrain pass");
        return RESULT_MEMORY;
    }
    pass->noise_repeats[0] = noise_repeats[0];
    pass->noise_repeats[1] = noise_repeats[1];
    glCreateVertexArrays(1, &pass->vertex_array);
    glCreateBuffers(1, &pass->commands_buffer);
    glCreateBuffers(1, &pass->instances_buffer);
    describe_attributes(pass->vertex_array);
    *out = pass;
    return RESULT_OK;
}

void terrain_pass_destroy(TerrainPass **pass) {
    TerrainPass *self = *pass;
    if (!self)
        return;
    glDeleteVertexArrays(1, &self->vertex_array);
    glDeleteBuffers(1, &self->commands_buffer);
    glDeleteBuffers(1, &self->instances_buffer);
    free(self->placed);
    free(self->places);
    free(self->in_view);
    free(self->visible);
    free(self->commands);
    free(self->instances);
    free(self);
    *pass = NULL;
}

static bool grow_array(void **array, size_t item_bytes, int32_t capacity) {
    void *grown = realloc(*array, item_bytes * (size_t)capacity);
    if (grown)
        *array = grown;
    return grown != NULL;
}

static Result reserve(TerrainPass *pass, int32_t count) {
    if (count <= pass->capacity)
        return RESULT_OK;
    int32_t capacity = count + count / 2 + 64;
    if (!grow_array((void **)&pass->placed, sizeof *pass->placed, capacity) ||
        !grow_array((void **)&pass->places, sizeof *pass->places, capacity) ||
        !grow_array((void **)&pass->in_view, sizeof *pass->in_view, capacity) ||
        !grow_array((void **)&pass->visible, sizeof *pass->visible, capacity) ||
        !grow_array((void **)&pass->commands, sizeof *pass->commands, capacity) ||
        !grow_array((void **)&pass->instances, sizeof *pass->instances, capacity)) {
        log_error("out of memory for a list of %d patches", capacity);
        return RESULT_MEMORY;
    }
    pass->capacity = capacity;
    return RESULT_OK;
}

static Placed placed_from(const LodItem *item, const PatchPlace *place, const Ground *ground) {
    uint32_t state = place->page_uploaded ? STATE_UPLOADED : item->state;
    return (Placed){.place = *place,
                    .index_count = (uint32_t)item->index_count,
                    .origin = item->page->origin,
                    .col0 = item->page->col0,
                    .row0 = item->page->row0,
                    .info = (uint32_t)item->level | state << 8 | (uint32_t)item->partition << 16,
                    .wet = ground_is_wet(ground, item->page->col0, item->page->row0, place->cols, place->rows),
                    .centre_ecef = item->centre_ecef,
                    .radius_m = item->radius_m};
}

// As many items, from the first, as the cache can hold.
static int32_t count_fitting(const LodItem *items, int32_t count, size_t capacity_bytes) {
    size_t bytes = 0;
    for (int32_t i = 0; i < count; i++) {
        bytes += patch_cache_bytes_needed(&items[i], 1);
        if (bytes > capacity_bytes)
            return i;
    }
    return count;
}

static void warn_over_budget(TerrainPass *pass, const PatchCache *cache, const LodCut *cut, const char *what) {
    if (!pass->over_budget)
        log_warn("the cut needs %zu MiB of graphics memory, the limit is %zu MiB: drawing %s; raise the limit or the "
                 "tolerance",
                 (patch_cache_bytes_needed(cut->items, cut->item_count) >> 20) + 1, patch_cache_capacity(cache) >> 20,
                 what);
    pass->over_budget = true;
}

// Dry before wet, near before far.
static bool comes_before(const Visible *a, const Visible *b) {
    if (a->wet != b->wet)
        return b->wet;
    if (a->distance_m != b->distance_m)
        return a->distance_m < b->distance_m;
    return a->index < b->index;
}

static void sift_down(Visible *heap, int32_t root, int32_t count) {
    Visible moved = heap[root];
    for (int32_t child; (child = 2 * root + 1) < count; root = child) {
        if (child + 1 < count && comes_before(&heap[child], &heap[child + 1]))
            child++;
        if (!comes_before(&moved, &heap[child]))
            break;
        heap[root] = heap[child];
    }
    heap[root] = moved;
}

// A heap sort, because qsort may ask the system for memory, and a frame shall not.
static void sort_visible(Visible *items, int32_t count) {
    for (int32_t root = count / 2 - 1; root >= 0; root--)
        sift_down(items, root, count);
    for (int32_t end = count - 1; end > 0; end--) {
        Visible last = items[end];
        items[end] = items[0];
        items[0] = last;
        sift_down(items, 0, end);
    }
}

static double distance_to(const Frame *frame, Vec3d centre_ecef, double radius_m) {
    return vec3d_distance(centre_ecef, frame->eye_ecef) - radius_m;
}

// Nearest first: of what does not fit, the far end is missed least.
static int32_t find_in_view(TerrainPass *pass, const Frame *frame, const LodCut *cut) {
    int32_t count = 0;
    for (int32_t i = 0; i < cut->item_count; i++) {
        const LodItem *item = &cut->items[i];
        if (frame_sees_sphere(frame, item->centre_ecef, item->radius_m))
            pass->visible[count++] = (Visible){false, distance_to(frame, item->centre_ecef, item->radius_m), i};
    }
    sort_visible(pass->visible, count);
    for (int32_t k = 0; k < count; k++)
        pass->in_view[k] = cut->items[pass->visible[k].index];
    return count;
}

static Result place_items(TerrainPass *pass, PatchCache *cache, const Ground *ground, const LodItem *items,
                          int32_t count) {
    Result result = patch_cache_place(cache, items, count, pass->places);
    if (result == RESULT_BUDGET)
        return result;
    pass->placed_count = result == RESULT_OK ? count : 0;
    for (int32_t i = 0; i < pass->placed_count; i++)
        pass->placed[i] = placed_from(&items[i], &pass->places[i], ground);
    pass->placed_last = patch_cache_last_placed(cache);
    return result;
}

// All of the cut, so that a turn of the head uploads nothing; else what is in view; else what was drawn before; else
// what fits.
static Result place_cut(TerrainPass *pass, PatchCache *cache, const Frame *frame, const Ground *ground,
                        const LodCut *cut) {
    Result result = place_items(pass, cache, ground, cut->items, cut->item_count);
    pass->partial = false;
    if (result != RESULT_BUDGET) {
        pass->over_budget = false;
        return result;
    }
    int32_t count = find_in_view(pass, frame, cut);
    result = place_items(pass, cache, ground, pass->in_view, count);
    if (result != RESULT_BUDGET) {
        warn_over_budget(pass, cache, cut, "only what is in view");
        return result;
    }
    pass->partial = true;
    if (pass->placed_count && pass->placed_last == patch_cache_last_placed(cache)) { // nobody else placed since
        warn_over_budget(pass, cache, cut, "the last cut that fitted");
        patch_cache_keep_last(cache);
        pass->placed_last = patch_cache_last_placed(cache);
        return RESULT_OK;
    }
    warn_over_budget(pass, cache, cut, "the nearest part of it");
    return place_items(pass, cache, ground, pass->in_view,
                       count_fitting(pass->in_view, count, patch_cache_capacity(cache)));
}

static void find_visible(TerrainPass *pass, const Frame *frame) {
    pass->visible_count = pass->dry_count = 0;
    for (int32_t i = 0; i < pass->placed_count; i++) {
        const Placed *placed = &pass->placed[i];
        if (placed->index_count == 0 || !frame_sees_sphere(frame, placed->centre_ecef, placed->radius_m))
            continue;
        double distance = distance_to(frame, placed->centre_ecef, placed->radius_m);
        pass->visible[pass->visible_count++] = (Visible){placed->wet, distance, i};
        pass->dry_count += !placed->wet;
    }
    sort_visible(pass->visible, pass->visible_count);
}

// Whole repeats are dropped here, in double, so that what remains is exact to a millimetre.
static float phase_of(int32_t sample, double repeats_per_sample) {
    double repeats = sample * repeats_per_sample;
    return (float)(repeats - floor(repeats));
}

static Instance instance_of(const TerrainPass *pass, const Placed *placed, const Frame *frame) {
    FrameOffset offset = frame_offset(frame, placed->origin);
    return (Instance){.lo = {offset.lo[0], offset.lo[1], offset.lo[2]},
                      .col0 = placed->col0,
                      .hi = {offset.hi[0], offset.hi[1], offset.hi[2]},
                      .row0 = placed->row0,
                      .info = placed->info,
                      .noise_phase = {phase_of(placed->col0, pass->noise_repeats[0]),
                                      phase_of(placed->row0, pass->noise_repeats[1])}};
}

static void fill_lists(TerrainPass *pass, const Frame *frame) {
    pass->triangles = 0;
    for (int32_t i = 0; i < pass->visible_count; i++) {
        const Placed *placed = &pass->placed[pass->visible[i].index];
        pass->commands[i] = (DrawCommand){.index_count = placed->index_count,
                                          .instance_count = 1,
                                          .first_index = placed->place.first_index,
                                          .base_vertex = placed->place.base_vertex,
                                          .base_instance = (uint32_t)i};
        pass->instances[i] = instance_of(pass, placed, frame);
        pass->triangles += placed->index_count / 3;
    }
}

static void upload_lists(const TerrainPass *pass) {
    size_t count = (size_t)pass->visible_count;
    if (!count)
        return;
    // Giving the storage anew each frame lets the driver keep what frames in flight read.
    glNamedBufferData(pass->commands_buffer, (GLsizeiptr)(count * sizeof *pass->commands), pass->commands,
                      GL_STREAM_DRAW);
    glNamedBufferData(pass->instances_buffer, (GLsizeiptr)(count * sizeof *pass->instances), pass->instances,
                      GL_STREAM_DRAW);
}

Result terrain_pass_prepare(TerrainPass *pass, PatchCache *cache, const Frame *frame, const Ground *ground,
                            const LodCut *cut) {
    Result result = reserve(pass, cut->item_count);
    if (result == RESULT_OK)
        result = place_cut(pass, cache, frame, ground, cut);
    find_visible(pass, frame);
    fill_lists(pass, frame);
    upload_lists(pass);
    return result;
}

typedef struct Range {
    int32_t begin, end; // of the visible ones
} Range;

static Range range_of(const TerrainPass *pass, TerrainPart part) {
    return (Range){part == TERRAIN_WET ? pass->dry_count : 0,
                   part == TERRAIN_DRY ? pass->dry_count : pass->visible_count};
}

static void bind(const TerrainPass *pass, const PatchCache *cache) {
    GLuint buffer = patch_cache_buffer(cache);
    glVertexArrayVertexBuffer(pass->vertex_array, BINDING_VERTICES, buffer, 0, sizeof(LodVertex));
    glVertexArrayVertexBuffer(pass->vertex_array, BINDING_INSTANCES, pass->instances_buffer, 0, sizeof(Instance));
    glVertexArrayElementBuffer(pass->vertex_array, buffer);
    glBindVertexArray(pass->vertex_array);
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, pass->commands_buffer);
}

static void draw_range(Range range) {
    if (range.begin < range.end)
        glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_SHORT,
                                    (const void *)((size_t)range.begin * sizeof(DrawCommand)), range.end - range.begin,
                                    0);
}

void terrain_pass_draw(TerrainPass *pass, const PatchCache *cache, TerrainPart part) {
    Range range = range_of(pass, part);
    if (range.begin == range.end)
        return;
    bind(pass, cache);
    draw_range(range);
    glBindVertexArray(0);
}

void terrain_pass_draw_near(TerrainPass *pass, const PatchCache *cache, TerrainPart part, Vec3d centre_ecef,
                            double radius_m) {
    Range range = range_of(pass, part);
    bind(pass, cache);
    for (int32_t i = range.begin; i < range.end; i++) {
        const Placed *placed = &pass->placed[pass->visible[i].index];
        if (vec3d_distance(placed->centre_ecef, centre_ecef) < placed->radius_m + radius_m)
            draw_range((Range){i, i + 1});
    }
    glBindVertexArray(0);
}

void terrain_pass_count(const TerrainPass *pass, RenderCutStats *stats) {
    stats->draws = (pass->dry_count > 0) + (pass->visible_count > pass->dry_count);
    stats->patches_drawn = pass->visible_count;
    stats->triangles_drawn = pass->triangles;
    stats->partial = pass->partial;
}
