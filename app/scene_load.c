#define _POSIX_C_SOURCE 200809L
#include "app/scene_load.h"

#include "app/flight/camera.h"
#include "app/signals.h"
#include "app/viewpoint.h"
#include "base/log.h"
#include "base/paths.h"
#include "config/files.h"
#include "terrain/geodesy.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define BOUND_CORNER 2 // in CHOICES_BOUND
#define GEOID_FILE "geoid/egm96-15.pgm"

static bool is_scene_file(const char *path) {
    const char *dot = strrchr(path, '.');
    return dot && strcmp(dot, ".scene") == 0;
}

bool world_find_scene(const char *word, char out[PATHS_BYTES_MAX]) {
    char folder[PATHS_BYTES_MAX];
    if (strpbrk(word, "./") || paths_find_data("scenes", folder) != RESULT_OK)
        return false;
    int printed = snprintf(out, PATHS_BYTES_MAX, "%s/%s.scene", folder, word);
    return printed > 0 && printed < PATHS_BYTES_MAX && files_exists(out);
}

// A bare word that is no file may be the name of a scene that came with the program.
static bool find_named_scene(const char *word, char out[PATHS_BYTES_MAX]) {
    return !files_exists(word) && world_find_scene(word, out);
}

static Result read_named(const char *const *paths, int count, Scene *out) {
    char path[PATHS_BYTES_MAX];
    for (int i = 0; i < count; i++) {
        bool named = !is_scene_file(paths[i]) && find_named_scene(paths[i], path);
        if (!named && !is_scene_file(paths[i]))
            continue;
        if (count == 1)
            return scene_read(named ? path : paths[i], out);
        log_error("%s: a scene stands alone; expected one scene, or DEM files and folders", paths[i]);
        return RESULT_USAGE;
    }
    return scene_of_dems(paths, count, out);
}

static Result read_default(Scene *out) {
    char path[PATHS_BYTES_MAX];
    Result result = paths_find_data("scenes/" WORLD_DEFAULT_SCENE ".scene", path);
    return result == RESULT_OK ? scene_read(path, out) : result;
}

// The first word of some commands is what to measure, to replay, or to fly; a conversion's second what it writes.
static int first_scene(const Options *options) {
    if (options_command(options) == COMMAND_CONVERT)
        return 2;
    return (options_command(options) & (COMMAND_BENCH | COMMAND_REPRODUCE | COMMAND_REPLAY | COMMAND_DEMO)) != 0;
}

static Result read_listed(const char *const *names, int count, Scene *out) {
    return count > 0 ? read_named(names, count, out) : read_default(out);
}

static Result read_scene(const Options *options, Scene *out) {
    int first = first_scene(options);
    int count = options_positional_count(options) - first;
    return read_listed(options_positionals(options) + first, count, out);
}

// ---- Are the files there? ---------------------------------------------------------------------------------------

static Result check_file(Result before, const char *path) {
    return before == RESULT_OK && path ? files_check_readable(path) : before;
}

static Result check_bounds_have_image(const Options *options, const char *image) {
    OptionSource source = options_source(options, OPTION_IMAGE_BOUNDS);
    bool asked_for = source == SOURCE_ENVIRONMENT || source == SOURCE_COMMAND_LINE;
    if (image || !asked_for)
        return RESULT_OK;
    log_error("--image-bounds: no picture has these bounds; name one with --image FILE");
    return RESULT_USAGE;
}

static Result check_scene_files(const Options *options, const Scene *scene) {
    const char *image = options_is_set(options, OPTION_IMAGE) ? options_text(options, OPTION_IMAGE) : scene->image;
    Result result = check_bounds_have_image(options, image);
    for (int i = 0; i < scene->dem_count; i++)
        result = check_file(result, scene->dem[i]);
    result = check_file(result, options_text(options, OPTION_GEOID));
    return check_file(result, image);
}

Result world_check_inputs(const Options *options) {
    Scene scene;
    Result result = read_scene(options, &scene);
    if (result != RESULT_OK)
        return result;
    result = check_scene_files(options, &scene);
    scene_clear(&scene);
    return result;
}

// ---- What is read -----------------------------------------------------------------------------------------------

static Result visit_scene(const Scene *scene, WorldVisit *visit, void *user) {
    Result result = RESULT_OK;
    for (int i = 0; i < scene->dem_count && result == RESULT_OK; i++)
        result = visit(user, scene->dem[i]);
    if (result == RESULT_OK && scene->image)
        result = visit(user, scene->image);
    return result == RESULT_OK && scene->demo ? visit(user, scene->demo) : result;
}

Result world_visit_listed(const char *const *names, int count, WorldVisit *visit, void *user) {
    char path[PATHS_BYTES_MAX];
    Scene scene = {.datum = -1, .voids = -1};
    Result result = RESULT_OK;
    for (int i = 0; i < count && result == RESULT_OK; i++)
        result = visit(user, find_named_scene(names[i], path) ? path : names[i]);
    if (result == RESULT_OK)
        result = read_listed(names, count, &scene);
    if (result == RESULT_OK)
        result = visit_scene(&scene, visit, user);
    scene_clear(&scene);
    return result;
}

Result world_visit_files(const Options *options, WorldVisit *visit, void *user) {
    int first = first_scene(options);
    int count = options_positional_count(options) - first;
    return world_visit_listed(options_positionals(options) + first, count, visit, user);
}

// ---- Loading ----------------------------------------------------------------------------------------------------

// Index in the choices of the option: what was given on purpose, else the scene's word, else the default.
static int choose(const Options *options, OptionId id, int scene_choice) {
    return options_is_given(options, id) || scene_choice < 0 ? options_choice(options, id) : scene_choice;
}

DemOptions scene_dem_options(const Options *options, const Scene *scene) {
    DemOptions dem = dem_default_options();
    int datum = choose(options, OPTION_DATUM, scene ? scene->datum : -1);
    dem.datum_given = datum > 0;
    dem.datum = datum == 2 ? DEM_DATUM_ELLIPSOID : DEM_DATUM_EGM96;
    dem.voids = (DemVoids)choose(options, OPTION_VOIDS, scene ? scene->voids : -1);
    if (options_is_set(options, OPTION_SPACING))
        dem.spacing_m = options_number(options, OPTION_SPACING);
    if (options_is_set(options, OPTION_BOUNDS)) {
        const double *bounds = options_numbers(options, OPTION_BOUNDS);
        dem.bounds_given = true;
        dem.west_deg = bounds[0];
        dem.south_deg = bounds[1];
        dem.east_deg = bounds[2];
        dem.north_deg = bounds[3];
    }
    return dem;
}

LodOptions scene_lod_options(const Options *options) {
    LodOptions lod = lod_default_options();
    lod.method = (LodMethod)options_choice(options, OPTION_METHOD);
    lod.partitions = (int)options_integer(options, OPTION_PARTITIONS);
    lod.max_triangles = options_integer(options, OPTION_MAX_TRIANGLES);
    lod.reuse = options_flag(options, OPTION_REUSE);
    lod.bound = options_choice(options, OPTION_BOUND) == 0 ? LOD_BOUND_PUBLISHED : LOD_BOUND_CENTRE;
    lod.unit_m = options_number(options, OPTION_UNIT);
    lod.tile_side = (2 << options_choice(options, OPTION_TILE_SIDE)) + 1;
    return lod;
}

Result scene_open_geoid(const Options *options, Geoid **out) {
    char found[PATHS_BYTES_MAX];
    const char *path = options_text(options, OPTION_GEOID);
    if (!path) {
        Result result = paths_find_data(GEOID_FILE, found);
        if (result != RESULT_OK)
            return result;
        path = found;
    }
    return geoid_open(path, out);
}

// In flight the main thread alone takes signals, so no other may be started with them open: neither our workers nor
// those that image libraries start when they read. One that comes while reading waits until it is done.
static Result load_dem(const DemOptions *read_as, const Scene *scene, Dem **out) {
    sigset_t before;
    signals_hold_all(&before);
    Result result = dem_load(read_as, (const char *const *)scene->dem, scene->dem_count, out);
    signals_restore(&before);
    return result;
}

Result scene_load_dem(const Options *options, Dem **out) {
    Scene scene = {.datum = -1, .voids = -1};
    Result result = read_scene(options, &scene);
    if (result != RESULT_OK)
        return result;
    const DemOptions read_as = scene_dem_options(options, &scene);
    result = load_dem(&read_as, &scene, out);
    scene_clear(&scene);
    return result;
}

TerrainOptions scene_terrain_options(const Options *options) {
    TerrainOptions terrain = terrain_default_options();
    terrain.error = options_choice(options, OPTION_ERROR) == 0 ? TERRAIN_ERROR_MIDPOINT : TERRAIN_ERROR_TOTAL;
    terrain.error_stride = options_choice_number(options, OPTION_ERROR);
    terrain.patch_level = 2 * (options_choice(options, OPTION_PATCH_SIDE) + 1); // sides 3, 5, 9: 2, 4, 6 bisections
    return terrain;
}

Result scene_error_kind(const Options *options, const char *name, TerrainOptions *out) {
    double numbers[4] = {0};
    *out = scene_terrain_options(options);
    if (option_parse(OPTION_ERROR, name, numbers) != RESULT_OK)
        return RESULT_USAGE;
    out->error = numbers[0] == 0.0 ? TERRAIN_ERROR_MIDPOINT : TERRAIN_ERROR_TOTAL;
    out->error_stride = (int)numbers[1];
    return RESULT_OK;
}

static Result create_terrain(const TerrainOptions *terrain, World *world) {
    Dem *dem = NULL;
    Result result = load_dem(&world->read_as, &world->scene, &dem);
    if (result != RESULT_OK)
        return result;
    result = terrain_create(terrain, dem, world->geoid, world->jobs, &world->terrain);
    if (result != RESULT_OK)
        dem_destroy(&dem);
    return result;
}

static Result create_jobs(const Options *options, Jobs **out) {
    sigset_t before;
    signals_hold_all(&before);
    Result result = jobs_create((int)options_integer(options, OPTION_THREADS), out);
    signals_restore(&before);
    return result;
}

// Takes the scene over.
static Result load_scene(const Options *options, const TerrainOptions *terrain, const Scene *scene,
                         const DemOptions *read_as, World *out) {
    World world = {.scene = *scene, .read_as = read_as ? *read_as : scene_dem_options(options, scene)};
    Result result = create_jobs(options, &world.jobs);
    if (result != RESULT_OK)
        goto fail;
    result = scene_open_geoid(options, &world.geoid);
    if (result != RESULT_OK)
        goto fail;
    result = create_terrain(terrain, &world);
    if (result != RESULT_OK)
        goto fail;
    *out = world;
    return RESULT_OK;
fail:
    world_unload(&world);
    return result;
}

// Too many names are cut off: whoever needs them finds that they name nothing.
static void keep_names(const char *const *names, int count, World *world) {
    size_t length = 0;
    for (int i = 0; i < count && length < sizeof world->names; i++)
        length += (size_t)snprintf(world->names + length, sizeof world->names - length, "%s%s", i ? "|" : "", names[i]);
}

Result world_load(const Options *options, World *out) {
    int first = first_scene(options);
    return world_load_listed(options, options_positionals(options) + first, options_positional_count(options) - first,
                             NULL, out);
}

Result world_check_listed(const Options *options, const char *const *names, int count) {
    Scene scene = {.datum = -1, .voids = -1};
    Result result = read_listed(names, count, &scene);
    if (result == RESULT_OK)
        result = check_scene_files(options, &scene);
    scene_clear(&scene);
    return result;
}

Result world_load_listed(const Options *options, const char *const *names, int count, const DemOptions *read_as,
                         World *out) {
    Scene scene = {.datum = -1, .voids = -1};
    TerrainOptions terrain = scene_terrain_options(options);
    Result result = read_listed(names, count, &scene);
    if (result == RESULT_OK)
        result = load_scene(options, &terrain, &scene, read_as, out);
    if (result == RESULT_OK)
        keep_names(names, count, out);
    return result;
}

Result world_check_named(const Options *options, const char *name) {
    Scene scene = {.datum = -1, .voids = -1};
    Result result = name ? read_named(&name, 1, &scene) : read_default(&scene);
    if (result == RESULT_OK)
        result = check_scene_files(options, &scene);
    scene_clear(&scene);
    return result;
}

Result world_load_named(const Options *options, const char *name, const TerrainOptions *terrain, World *out) {
    Scene scene = {.datum = -1, .voids = -1};
    Result result = name ? read_named(&name, 1, &scene) : read_default(&scene);
    if (result == RESULT_OK)
        result = check_scene_files(options, &scene);
    if (result == RESULT_OK)
        return load_scene(options, terrain, &scene, NULL, out);
    scene_clear(&scene);
    return result;
}

void world_unload(World *world) {
    if (world->terrain)
        terrain_destroy(&world->terrain);
    if (world->geoid)
        geoid_close(&world->geoid);
    if (world->jobs)
        jobs_destroy(&world->jobs);
    scene_clear(&world->scene);
}

Result world_viewpoint(const World *world, const Options *options, Viewpoint *out) {
    const Scene *scene = &world->scene;
    Viewpoint view = {0};
    bool eye_given = options_is_set(options, OPTION_EYE);
    if (eye_given || scene->has_position) {
        const double *eye = eye_given ? options_numbers(options, OPTION_EYE) : scene->position;
        view.lat_deg = eye[0];
        view.lon_deg = eye[1];
        view.alt_m = eye[2];
        if (!eye_given && scene->has_look) {
            view.heading_deg = scene->look[0];
            view.pitch_deg = scene->look[1];
        }
    } else {
        Result result = viewpoint_of_relief(world->terrain, world->geoid, &view);
        if (result != RESULT_OK)
            return result;
    }
    if (options_is_set(options, OPTION_LOOK)) {
        view.heading_deg = options_numbers(options, OPTION_LOOK)[0];
        view.pitch_deg = options_numbers(options, OPTION_LOOK)[1];
    }
    *out = view;
    return RESULT_OK;
}

void world_warn_underground(const World *world, const Viewpoint *view) {
    double ground_m;
    if (!terrain_ground_m(world->terrain, view->lat_deg, view->lon_deg, &ground_m))
        return;
    double depth_m = ground_m - world_ellipsoid_m(world, view->lat_deg, view->lon_deg, view->alt_m);
    if (depth_m >= 0.1)
        log_warn("the eye is %.1f m under the ground; --eye %.6f,%.6f,%.0f is above it", depth_m, view->lat_deg,
                 view->lon_deg, ceil(view->alt_m + depth_m) + 2.0);
}

Vec3d world_sun(const World *world, const Options *options, const Viewpoint *view) {
    bool from_scene = world->scene.has_sun && !options_is_given(options, OPTION_SUN);
    const double *sun = from_scene ? world->scene.sun : options_numbers(options, OPTION_SUN);
    Viewpoint towards = *view;
    towards.heading_deg = sun[0];
    towards.pitch_deg = sun[1];
    return viewpoint_forward(&towards);
}

double world_ellipsoid_m(const World *world, double lat_deg, double lon_deg, double alt_m) {
    return alt_m + geoid_undulation_m(world->geoid, lat_deg, lon_deg);
}

Vec3d world_viewpoint_ecef(const World *world, const Viewpoint *view) {
    double h_m = world_ellipsoid_m(world, view->lat_deg, view->lon_deg, view->alt_m);
    return geodesy_to_ecef((Geodetic){view->lat_deg * GEODESY_RAD_PER_DEG, view->lon_deg * GEODESY_RAD_PER_DEG, h_m});
}

bool scene_bound_corner(const Options *options) {
    return options_choice(options, OPTION_BOUND) == BOUND_CORNER;
}

double scene_px_per_rad(const Options *options) {
    const double *size = options_numbers(options, OPTION_SIZE);
    return camera_px_per_rad(options_number(options, OPTION_FOV) * GEODESY_RAD_PER_DEG, size[0], size[1],
                             scene_bound_corner(options));
}

LodView world_lod_view(const World *world, const Options *options, const Viewpoint *view) {
    return (LodView){.eye_ecef = world_viewpoint_ecef(world, view),
                     .forward_ecef = viewpoint_forward(view),
                     .px_per_rad = scene_px_per_rad(options),
                     .tau_px = options_number(options, OPTION_TAU)};
}
