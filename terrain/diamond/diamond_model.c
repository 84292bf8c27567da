// Yalcin, Weiss, De Floriani 2011, section 4: the buffers of the hierarchy. Our own: positions relative to one origin
// instead of a flat height field, the reach of diamonds, and what is split in every cut where the DEM is not one square
// of a power of two.
#include "terrain/diamond/diamond_internal.h"

#include "base/log.h"
#include "terrain/diamond/diamond_fields.h"
#include "terrain/errors/error_rows.h"
#include "terrain/terrain_parts.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#define ALIGNMENT 64 // bytes
// Rounding of a distance to float, and of its square root.
#define REACH_GROW 1.000002f
#define ROUNDING 5.97e-8f // 2^-24, and then some
// diamond_deviation rounds more often than the terms of the error field allow for: 8 times 2^-24 of the largest height.
#define MORE_ROUNDING_M(h_max) (4.0f * FLT_EPSILON * (h_max))

// Positions in rows, while a model is made.
typedef struct Positions {
    float *x, *y, *z; // [height][width]
} Positions;

typedef struct Making {
    DiamondModel *model;
    Positions positions;
    int plane;
} Making;

// ---- memory ----

typedef struct Room {
    unsigned char *base; // NULL: only counted
    size_t used;
} Room;

static void *take(Room *room, size_t bytes) {
    void *here = room->base ? room->base + room->used : NULL;
    room->used += (bytes + ALIGNMENT - 1) & ~(size_t)(ALIGNMENT - 1);
    return here;
}

static size_t place_arrays(DiamondModel *model, unsigned fields, unsigned char *base) {
    Room room = {.base = base};
    size_t words = model->layout.word_count, entries = DIAMOND_SLOTS * words * sizeof(float);
    model->x = take(&room, entries);
    model->y = take(&room, entries);
    model->z = take(&room, entries);
    model->reach_m = take(&room, 2 * words * sizeof(float));
    model->valid = take(&room, words * sizeof(uint32_t));
    model->always = take(&room, words * sizeof(uint32_t));
    model->terms = take(&room, model->layout.row_count * sizeof(DiamondTerms));
    model->datum_m = fields & DIAMOND_FIELD_DATUM ? take(&room, entries) : NULL;
    model->east_deg = fields & DIAMOND_FIELD_DEGREES ? take(&room, entries) : NULL;
    model->north_deg = fields & DIAMOND_FIELD_DEGREES ? take(&room, entries) : NULL;
    return room.used;
}

static bool allocate(DiamondModel *model, unsigned fields) {
    model->bytes = place_arrays(model, fields, NULL);
    model->memory = aligned_alloc(ALIGNMENT, model->bytes);
    if (!model->memory)
        return false;
    place_arrays(model, fields, model->memory);
    return true;
}

static void free_positions(Positions *positions) {
    free(positions->x);
    free(positions->y);
    free(positions->z);
}

static bool allocate_positions(Positions *positions, const DiamondLayout *layout) {
    size_t bytes = sizeof(float) * (size_t)layout->width * (size_t)layout->height;
    *positions = (Positions){malloc(bytes), malloc(bytes), malloc(bytes)};
    return positions->x && positions->y && positions->z;
}

// ---- positions ----

static Vec3d middle_of(const Terrain *terrain) {
    Vec3d p = grid_point_ecef(terrain_point(terrain, terrain->dem->width / 2, terrain->dem->height / 2));
    return vec3d(floor(p.x), floor(p.y), floor(p.z));
}

static void position_task(void *user, int64_t begin, int64_t end, int worker) {
    Making *m = user;
    const DiamondModel *model = m->model;
    (void)worker;
    for (int32_t row = (int32_t)begin; row < end; row++) {
        size_t at = (size_t)row * (size_t)model->layout.width;
        for (int32_t col = 0; col < model->layout.width; col++, at++) {
            Vec3d p = vec3d_sub(grid_point_ecef(terrain_point(model->terrain, col, row)), model->origin_ecef);
            m->positions.x[at] = (float)p.x;
            m->positions.y[at] = (float)p.y;
            m->positions.z[at] = (float)p.z;
        }
    }
}

static float largest_coordinate(const Positions *positions, size_t samples) {
    float x = error_height_max(positions->x, samples), y = error_height_max(positions->y, samples);
    return fmaxf(fmaxf(x, y), error_height_max(positions->z, samples));
}

// ---- super-squares ----

static float squared_between(const Positions *p, size_t a, size_t b) {
    float x = p->x[a] - p->x[b], y = p->y[a] - p->y[b], z = p->z[a] - p->z[b];
    return x * x + y * y + z * z;
}

static float corner_distance2(const Making *m, int slot, DiamondPoint v) {
    const DiamondLayout *layout = &m->model->layout;
    DiamondCorners corners = diamond_corners(slot, v, 1 << m->plane);
    size_t at = diamond_sample(layout, v);
    float most = 0.0f;
    for (int i = 0; i < 2; i++) {
        if (diamond_is_inside(layout, corners.ends[i]))
            most = fmaxf(most, squared_between(&m->positions, at, diamond_sample(layout, corners.ends[i])));
        if (diamond_is_inside(layout, corners.parents[i]))
            most = fmaxf(most, squared_between(&m->positions, at, diamond_sample(layout, corners.parents[i])));
    }
    return most;
}

static void set_entry(const Making *m, size_t entry, size_t sample) {
    m->model->x[entry] = m->positions.x[sample];
    m->model->y[entry] = m->positions.y[sample];
    m->model->z[entry] = m->positions.z[sample];
}

static void clear_entry(DiamondModel *model, size_t entry) {
    model->x[entry] = model->y[entry] = model->z[entry] = 0.0f;
}

static bool is_always(const Terrain *terrain, DiamondPoint v) {
    return error_field_at(&terrain->errors, v.col, v.row).delta == ERROR_FIELD_ALWAYS;
}

static void make_word(const Making *m, uint32_t i, uint32_t j) {
    DiamondModel *model = m->model;
    const DiamondLayout *layout = &model->layout;
    uint32_t word = layout->offset[m->plane] + j * layout->across[m->plane] + i;
    uint32_t valid = 0, always = 0;
    float reach2[2] = {0.0f, 0.0f}; // of centres, of edge midpoints
    for (int slot = 0; slot < DIAMOND_SLOTS; slot++) {
        DiamondPoint v = diamond_vertex(m->plane, i, j, slot);
        size_t entry = diamond_entry(layout, slot, word);
        if (!diamond_is_inside(layout, v)) {
            clear_entry(model, entry);
            continue;
        }
        set_entry(m, entry, diamond_sample(layout, v));
        valid |= UINT32_C(1) << diamond_slot_bit(slot);
        always |= (uint32_t)is_always(model->terrain, v) << diamond_slot_bit(slot);
        float *most = &reach2[!diamond_is_centre(slot)];
        *most = fmaxf(*most, corner_distance2(m, slot, v));
    }
    model->valid[word] = valid;
    model->always[word] = always;
    for (uint32_t kind = 0; kind < 2; kind++)
        model->reach_m[kind * layout->word_count + word] =
            sqrtf(reach2[kind]) * REACH_GROW + 2.0f * model->position_slack_m;
}

static void word_task(void *user, int64_t begin, int64_t end, int worker) {
    const Making *m = user;
    (void)worker;
    for (uint32_t j = (uint32_t)begin; j < (uint32_t)end; j++)
        for (uint32_t i = 0; i < m->model->layout.across[m->plane]; i++)
            make_word(m, i, j);
}

// ---- the terms of rows ----

static void make_terms(DiamondModel *model) {
    const DiamondLayout *layout = &model->layout;
    float h_max = error_height_max(model->height_m, (size_t)layout->width * (size_t)layout->height);
    float more = MORE_ROUNDING_M(h_max);
    for (int k = 0; k < layout->level_count; k++)
        for (int row = 0; row < layout->height; row += 1 << k) {
            ErrorTerms t = error_terms_of_row(model->terrain->grid, row, 1 << k, layout->height, h_max);
            model->terms[layout->row_offset[k] + (uint32_t)(row >> k)] =
                (DiamondTerms){t.edge_sag + more, t.centre_sag + more, t.edge_drift, t.centre_drift};
        }
}

// ---- the model ----

static Result make(Making *m, unsigned fields, Jobs *jobs) {
    DiamondModel *model = m->model;
    const DiamondLayout *layout = &model->layout;
    if (!allocate(model, fields) || !allocate_positions(&m->positions, layout))
        return RESULT_MEMORY;
    jobs_run(jobs, layout->height, 16, position_task, m);
    size_t samples = (size_t)layout->width * (size_t)layout->height;
    model->extent_m = largest_coordinate(&m->positions, samples);
    model->position_slack_m = 1.7321f * ROUNDING * model->extent_m;
    make_terms(model);
    for (m->plane = 0; m->plane < layout->level_count; m->plane++)
        diamond_run_rows(jobs, layout, m->plane, word_task, m);
    return diamond_fields_fill(model, jobs);
}

Result diamond_model_create(const Terrain *terrain, unsigned fields, uint64_t id, Jobs *jobs, DiamondModel *out) {
    const Dem *dem = terrain->dem;
    DiamondModel model = {.id = id,
                          .terrain = terrain,
                          .layout = diamond_layout(dem->width, dem->height, terrain->errors.plane_count),
                          .origin_ecef = middle_of(terrain),
                          .height_m = dem->height_m};
    grid_geodetic(terrain->grid, 0.5 * (dem->width - 1), 0.5 * (dem->height - 1), &model.middle_lat_deg,
                  &model.middle_lon_deg);
    for (int k = 0; k < model.layout.level_count; k++)
        model.run_first[k + 1] =
            model.run_first[k] + (diamond_plane_words(&model.layout, k) + DIAMOND_RUN - 1) / DIAMOND_RUN;
    Making making = {.model = &model};
    Result result = make(&making, fields, jobs);
    free_positions(&making.positions);
    if (result != RESULT_OK) {
        log_error("diamonds: not enough memory for %d x %d samples", dem->width, dem->height);
        diamond_model_destroy(&model);
        return result;
    }
    *out = model;
    return RESULT_OK;
}

void diamond_model_destroy(DiamondModel *model) {
    free(model->memory);
    free(model->error_m);
    free(model->runs);
    *model = (DiamondModel){0};
}
