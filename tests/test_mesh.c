// Exported meshes: read back by readers of our own and compared with the cut they came from.
#define _GNU_SOURCE
#include "base/log.h"
#include "terrain/geo.h"
#include "terrain/mesh/mesh.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#define COLS 13
#define ROWS 9
#define SAMPLES (COLS * ROWS)
#define TRIANGLES (2 * (COLS - 1) * (ROWS - 1))
#define SEAM 6 // the column at which two pages meet

typedef struct Fixture {
    Dem dem;
    float height_m[SAMPLES];
    Grid *grid;
    LodVertex vertices[2][SAMPLES];
    uint16_t indices[2][3 * TRIANGLES];
    LodPage pages[2];
    LodItem items[2];
    LodCut cut;
    Mesh mesh;
} Fixture;

static void put_quad(LodItem *item, uint16_t *indices, int cols, int col, int row) {
    uint16_t nw = (uint16_t)(row * cols + col), ne = (uint16_t)(nw + 1), sw = (uint16_t)(nw + cols),
             se = (uint16_t)(sw + 1);
    uint16_t quad[6] = {nw, sw, ne, se, ne, sw};
    memcpy(indices + item->index_count, quad, sizeof quad);
    item->index_count += 6;
}

// A page of all rows and the columns first..last, with an origin of its own.
static void fill_page(Fixture *f, int page, int first, int last) {
    int cols = last - first + 1;
    GridPoint near = grid_lattice(f->grid, first, 0, 0.0);
    LodPage *p = &f->pages[page];
    *p = (LodPage){.vertex_count = cols * ROWS, .col0 = first, .vertices = f->vertices[page]};
    p->origin =
        (GridPoint){near.x / GRID_LATTICE_PER_M * GRID_LATTICE_PER_M, near.y / GRID_LATTICE_PER_M * GRID_LATTICE_PER_M,
                    near.z / GRID_LATTICE_PER_M * GRID_LATTICE_PER_M};
    for (int i = 0; i < cols * ROWS; i++) {
        int col = i % cols, row = i / cols;
        GridPoint at = grid_lattice(f->grid, first + col, row, (double)f->height_m[row * COLS + first + col]);
        f->vertices[page][i] = (LodVertex){(int32_t)(at.x - p->origin.x), (int32_t)(at.y - p->origin.y),
                                           (int32_t)(at.z - p->origin.z), (uint16_t)col, (uint16_t)row};
    }
    f->items[page] = (LodItem){.page = p, .indices = f->indices[page]};
    for (int row = 0; row + 1 < ROWS; row++)
        for (int col = 0; col + 1 < cols; col++)
            put_quad(&f->items[page], f->indices[page], cols, col, row);
}

static Fixture *fixture_create(void) {
    Fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->dem = (Dem){.width = COLS,
                   .height = ROWS,
                   .georef = {DEM_CRS_GEOGRAPHIC, 0, false, -122.0, 47.0, 0.002, -0.001},
                   .datum = DEM_DATUM_ELLIPSOID,
                   .height_m = f->height_m};
    for (int i = 0; i < SAMPLES; i++)
        f->height_m[i] = 500.0f + 40.0f * sinf((float)i);
    assert_int_equal(grid_create(&f->dem.georef, COLS, ROWS, &f->grid), RESULT_OK);
    fill_page(f, 0, 0, SEAM);
    fill_page(f, 1, SEAM, COLS - 1);
    f->cut = (LodCut){.item_count = 2, .items = f->items};
    assert_int_equal(mesh_from_cut_of(&f->dem, f->grid, &f->cut, &f->mesh), RESULT_OK);
    return f;
}

static void fixture_destroy(Fixture *f) {
    mesh_clear(&f->mesh);
    grid_destroy(&f->grid);
    free(f);
}

static Vec3d expected_ecef(const Fixture *f, int col, int row) {
    return grid_ecef(f->grid, col, row, (double)f->height_m[row * COLS + col]);
}

// ---- files ----

static void path_of(const char *name, char out[256]) {
    snprintf(out, 256, "test_mesh_%ld_%s", (long)getpid(), name);
}

static unsigned char *read_all(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    unsigned char *bytes = malloc(*size + 1);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    bytes[*size] = 0;
    fclose(file);
    return bytes;
}

static unsigned char *write_and_read(const Fixture *f, const char *name, size_t *size) {
    char path[256];
    MeshFormat format;
    path_of(name, path);
    assert_int_equal(mesh_format_of(path, &format), RESULT_OK);
    assert_int_equal(mesh_write(&f->mesh, format, path), RESULT_OK);
    unsigned char *bytes = read_all(path, size);
    unlink(path);
    return bytes;
}

static uint32_t u32_at(const unsigned char *bytes) {
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static double double_at(const unsigned char *bytes) {
    uint64_t bits = (uint64_t)u32_at(bytes + 4) << 32 | u32_at(bytes);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static float float_at(const unsigned char *bytes) {
    uint32_t bits = u32_at(bytes);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

// ---- the mesh ----

static void test_vertices_of_two_patches_occur_once(void **state) {
    (void)state;
    Fixture *f = fixture_create();
    bool seen[SAMPLES] = {false};
    print_message("%" PRId64 " vertices, expected %d; %" PRId64 " triangles, expected %d\n", f->mesh.vertex_count,
                  SAMPLES, f->mesh.triangle_count, TRIANGLES);
    assert_int_equal(f->mesh.vertex_count, SAMPLES);
    assert_int_equal(f->mesh.triangle_count, TRIANGLES);
    for (int64_t i = 0; i < f->mesh.vertex_count; i++) {
        const MeshVertex *v = &f->mesh.vertices[i];
        assert_false(seen[v->row * COLS + v->col]);
        seen[v->row * COLS + v->col] = true;
        assert_true(vec3d_distance(v->ecef, expected_ecef(f, v->col, v->row)) <= GRID_LATTICE_M);
    }
    fixture_destroy(f);
}

static void test_culling_keeps_what_a_plane_touches(void **state) {
    (void)state;
    Fixture *f = fixture_create();
    // Everything west of a meridian a little east of the seam.
    double lat, lon;
    grid_geodetic(f->grid, SEAM + 0.5, ROWS / 2, &lat, &lon);
    Vec3d east = {-sin(lon * M_PI / 180.0), cos(lon * M_PI / 180.0), 0.0};
    MeshPlane plane = {grid_ecef(f->grid, SEAM, ROWS / 2, 0.0), vec3d_scale(east, -1.0)};
    plane.point_ecef = vec3d_scale(vec3d_add(plane.point_ecef, grid_ecef(f->grid, SEAM + 1, ROWS / 2, 0.0)), 0.5);
    assert_int_equal(mesh_cull(&f->mesh, &plane, 1), RESULT_OK);
    print_message("kept %" PRId64 " triangles and %" PRId64 " vertices\n", f->mesh.triangle_count,
                  f->mesh.vertex_count);
    assert_int_equal(f->mesh.triangle_count, 2 * (SEAM + 1) * (ROWS - 1));
    assert_int_equal(f->mesh.vertex_count, (SEAM + 2) * ROWS);
    for (int64_t i = 0; i < 3 * f->mesh.triangle_count; i++)
        assert_true(f->mesh.indices[i] < f->mesh.vertex_count);
    plane.normal = vec3d(0.0, 0.0, 0.0);
    plane.normal.z = -1.0; // everything is north of the equator
    plane.point_ecef = vec3d(0.0, 0.0, 0.0);
    assert_int_equal(mesh_cull(&f->mesh, &plane, 1), RESULT_OK);
    assert_int_equal(f->mesh.triangle_count, 0);
    assert_int_equal(f->mesh.vertex_count, 0);
    fixture_destroy(f);
}

// ---- PLY ----

static void test_ply_holds_earth_centred_doubles(void **state) {
    (void)state;
    Fixture *f = fixture_create();
    size_t size;
    unsigned char *bytes = write_and_read(f, "a.ply", &size);
    const char *end = strstr((char *)bytes, "end_header\n");
    assert_non_null(end);
    assert_non_null(strstr((char *)bytes, "ply\nformat binary_little_endian 1.0\n"));
    assert_non_null(strstr((char *)bytes,
                           "element vertex 117\nproperty double x\nproperty double y\nproperty double z\n"
                           "property double col\nproperty double row\nelement face 192\n"));
    const unsigned char *at = (const unsigned char *)end + strlen("end_header\n"), *vertices = at;
    assert_int_equal((size_t)(at - bytes) + SAMPLES * 40 + TRIANGLES * 13, size);
    double worst = 0.0;
    for (int i = 0; i < SAMPLES; i++, at += 40) {
        Vec3d p = {double_at(at), double_at(at + 8), double_at(at + 16)};
        worst = fmax(worst, vec3d_distance(p, expected_ecef(f, (int)double_at(at + 24), (int)double_at(at + 32))));
    }
    print_message("vertices off by at most %.3g m\n", worst);
    assert_true(worst <= GRID_LATTICE_M);
    for (int i = 0; i < TRIANGLES; i++, at += 13) {
        assert_int_equal(at[0], 3);
        Vec3d p[3];
        for (int k = 0; k < 3; k++) {
            uint32_t index = u32_at(at + 1 + 4 * k);
            assert_true(index < SAMPLES);
            const unsigned char *v = vertices + 40 * index;
            p[k] = vec3d(double_at(v), double_at(v + 8), double_at(v + 16));
        }
        Vec3d normal = vec3d_cross(vec3d_sub(p[1], p[0]), vec3d_sub(p[2], p[0]));
        assert_true(vec3d_dot(normal, p[0]) > 0.0); // away from the Earth's centre
    }
    free(bytes);
    fixture_destroy(f);
}

// ---- OBJ ----

static void test_obj_is_local_east_north_up(void **state) {
    (void)state;
    Fixture *f = fixture_create();
    size_t size;
    char *text = (char *)write_and_read(f, "a.obj", &size), *rest = NULL;
    int vertices = 0, faces = 0;
    double worst = 0.0;
    for (char *line = strtok_r(text, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
        double x, y, z;
        unsigned a, b, c;
        if (sscanf(line, "v %lf %lf %lf", &x, &y, &z) == 3) {
            const MeshVertex *v = &f->mesh.vertices[vertices++];
            double lat, lon, h, ecef[3] = {v->ecef.x, v->ecef.y, v->ecef.z};
            geo_ecef_reverse(ecef, &lat, &lon, &h);
            // East and north from the middle by the radii of curvature; flat over a kilometre to a metre.
            double east = (lon + 121.988) * M_PI / 180.0 * 6390000.0 * cos(46.996 * M_PI / 180.0);
            double north = (lat - 46.996) * M_PI / 180.0 * 6369700.0;
            worst = fmax(worst, fmax(fabs(x - east), fmax(fabs(y - north), fabs(z - h))));
        } else if (sscanf(line, "f %u %u %u", &a, &b, &c) == 3) {
            faces++;
            assert_true(a >= 1 && b >= 1 && c >= 1 && a <= SAMPLES && b <= SAMPLES && c <= SAMPLES);
        } else {
            assert_int_equal(line[0], '#');
        }
    }
    print_message("%d vertices, %d faces; off east, north, up by at most %.3f m\n", vertices, faces, worst);
    assert_int_equal(vertices, SAMPLES);
    assert_int_equal(faces, TRIANGLES);
    assert_true(worst < 1.0);
    free(text);
    fixture_destroy(f);
}

// ---- GLB ----

// The number after the `occurrence`-th (from 0) `key` of the JSON.
static double number_of(const char *json, const char *key, int occurrence) {
    const char *at = json;
    for (int i = 0; i <= occurrence; i++) {
        at = strstr(at, key);
        if (!at)
            fail_msg("no %s number %d in %s", key, occurrence, json);
        at += strlen(key);
    }
    return strtod(at, NULL);
}

static void numbers_of(const char *json, const char *key, double *out, int count) {
    const char *at = strstr(json, key);
    assert_non_null(at);
    at += strlen(key);
    for (int i = 0; i < count; i++) {
        char *end;
        out[i] = strtod(at, &end);
        assert_ptr_not_equal(at, end);
        at = end + 1;
    }
}

typedef struct Glb {
    unsigned char *bytes;
    char *json;
    const unsigned char *data;
    uint32_t data_bytes;
} Glb;

// The container: header, chunk lengths and kinds, alignment, padding (glTF 2.0, section 4).
static Glb open_glb(const Fixture *f) {
    size_t size;
    unsigned char *bytes = write_and_read(f, "a.glb", &size);
    assert_memory_equal(bytes, "glTF", 4);
    assert_int_equal(u32_at(bytes + 4), 2);
    assert_int_equal(u32_at(bytes + 8), size);
    uint32_t json_bytes = u32_at(bytes + 12);
    assert_int_equal(json_bytes % 4, 0);
    assert_memory_equal(bytes + 16, "JSON", 4);
    const unsigned char *chunk = bytes + 20 + json_bytes;
    uint32_t data_bytes = u32_at(chunk);
    assert_int_equal(data_bytes % 4, 0);
    assert_memory_equal(chunk + 4, "BIN\0", 4);
    assert_int_equal(20 + json_bytes + 8 + data_bytes, size);
    assert_int_equal(bytes[20], '{');
    return (Glb){bytes, strndup((char *)bytes + 20, json_bytes), chunk + 8, data_bytes};
}

static void check_views(const Glb *glb) {
    uint32_t end = 0;
    for (int i = 0; i < 3; i++) {
        uint32_t offset = (uint32_t)number_of(glb->json, "\"byteOffset\":", i);
        uint32_t length = (uint32_t)number_of(glb->json, "\"byteLength\":", i);
        assert_int_equal(offset, end);
        assert_int_equal(offset % 4, 0);
        end = offset + length;
    }
    assert_int_equal(end, glb->data_bytes);
    assert_int_equal((uint32_t)number_of(glb->json, "\"byteLength\":", 3), glb->data_bytes);
    assert_int_equal((int)number_of(glb->json, "\"count\":", 0), 3 * TRIANGLES);
    assert_int_equal((int)number_of(glb->json, "\"count\":", 1), SAMPLES);
    assert_int_equal((int)number_of(glb->json, "\"count\":", 2), SAMPLES);
    assert_int_equal((int)number_of(glb->json, "\"componentType\":", 0), 5125);
    assert_int_equal((int)number_of(glb->json, "\"componentType\":", 1), 5126);
}

static void check_accessor_range(const Glb *glb) {
    double least[3], greatest[3];
    numbers_of(glb->json, "\"min\":[", least, 3);
    numbers_of(glb->json, "\"max\":[", greatest, 3);
    const unsigned char *positions = glb->data + 12 * TRIANGLES;
    for (int k = 0; k < 3; k++) {
        float low = INFINITY, high = -INFINITY;
        for (int i = 0; i < SAMPLES; i++) {
            low = fminf(low, float_at(positions + 12 * i + 4 * k));
            high = fmaxf(high, float_at(positions + 12 * i + 4 * k));
        }
        print_message("axis %d: %.9g..%.9g, in the accessor %.9g..%.9g\n", k, (double)low, (double)high, least[k],
                      greatest[k]);
        assert_true((float)least[k] == low && (float)greatest[k] == high);
    }
}

// Back to ECEF as a reader would: translation, then axes, then the frame of the extras.
static Vec3d glb_ecef(const Glb *glb, int vertex) {
    double shift[3], origin[3], m[11];
    numbers_of(glb->json, "\"translation\":[", shift, 3);
    numbers_of(glb->json, "\"origin_ecef_m\":[", origin, 3);
    const char *matrix = strstr(glb->json, "\"enu_from_ecef\":[[");
    assert_non_null(matrix);
    for (int row = 0; row < 3; row++) {
        matrix = strchr(matrix + 1, '[');
        while (matrix[1] == '[')
            matrix++;
        numbers_of(matrix, "[", m + 3 * row, 3);
    }
    const unsigned char *at = glb->data + 12 * TRIANGLES + 12 * vertex;
    double x = (double)float_at(at) + shift[0], y = (double)float_at(at + 4) + shift[1],
           z = (double)float_at(at + 8) + shift[2];
    double enu[3] = {x, -z, y};
    return vec3d(origin[0] + m[0] * enu[0] + m[3] * enu[1] + m[6] * enu[2],
                 origin[1] + m[1] * enu[0] + m[4] * enu[1] + m[7] * enu[2],
                 origin[2] + m[2] * enu[0] + m[5] * enu[1] + m[8] * enu[2]);
}

static void check_glb_vertices(const Fixture *f, const Glb *glb) {
    double worst = 0.0, worst_length = 0.0;
    for (int i = 0; i < SAMPLES; i++) {
        worst = fmax(worst, vec3d_distance(glb_ecef(glb, i), f->mesh.vertices[i].ecef));
        const unsigned char *n = glb->data + 12 * TRIANGLES + 12 * SAMPLES + 12 * i;
        double x = (double)float_at(n), y = (double)float_at(n + 4), z = (double)float_at(n + 8);
        worst_length = fmax(worst_length, fabs(sqrt(x * x + y * y + z * z) - 1.0));
        assert_true(y > 0.5); // up
    }
    print_message("positions off by at most %.3g m, normals' lengths by %.2g\n", worst, worst_length);
    assert_true(worst < 2e-3);
    assert_true(worst_length < 1e-6);
}

static void test_glb_is_valid_and_goes_back_to_ecef(void **state) {
    (void)state;
    Fixture *f = fixture_create();
    Glb glb = open_glb(f);
    check_views(&glb);
    check_accessor_range(&glb);
    check_glb_vertices(f, &glb);
    for (int i = 0; i < 3 * TRIANGLES; i++)
        assert_int_equal(u32_at(glb.data + 4 * i), f->mesh.indices[i]);
    free(glb.json);
    free(glb.bytes);
    fixture_destroy(f);
}

// ---- failures ----

static void keep_message(void *user, LogLevel level, const char *message) {
    (void)level;
    snprintf(user, 512, "%s", message);
}

static void check_refused(const Fixture *f, const char *path, MeshFormat format, const char *expected) {
    char message[512] = "";
    log_set_sink(keep_message, message);
    Result result = mesh_write(&f->mesh, format, path);
    log_set_sink(NULL, NULL);
    print_message("%s: %s: %s\n", path, result_name(result), message);
    assert_int_equal(result, RESULT_IO);
    assert_non_null(strstr(message, path));
    assert_non_null(strstr(message, expected));
}

static void test_a_full_disk_names_the_file(void **state) {
    (void)state;
    if (access("/dev/full", W_OK))
        skip();
    Fixture *f = fixture_create();
    check_refused(f, "/dev/full", MESH_PLY, strerror(ENOSPC));
    check_refused(f, "/dev/full", MESH_OBJ, strerror(ENOSPC));
    check_refused(f, "/dev/full", MESH_GLB, strerror(ENOSPC));
    struct stat status;
    assert_int_equal(stat("/dev/full", &status), 0);
    assert_true(S_ISCHR(status.st_mode)); // and it is still there
    fixture_destroy(f);
}

static void test_a_missing_folder_names_the_file(void **state) {
    (void)state;
    Fixture *f = fixture_create();
    check_refused(f, "no-such-folder/a.ply", MESH_PLY, strerror(ENOENT));
    fixture_destroy(f);
}

static void test_a_failed_write_leaves_the_old_file(void **state) {
    (void)state;
    Fixture *f = fixture_create();
    char path[256], part[300];
    path_of("kept.ply", path);
    snprintf(part, sizeof part, "%s.part-%ld", path, (long)getpid());
    FILE *old = fopen(path, "wb");
    fputs("old", old);
    fclose(old);
    struct rlimit before, limit;
    getrlimit(RLIMIT_FSIZE, &before);
    limit = before;
    limit.rlim_cur = 1000; // bytes a file may have
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &limit);
    check_refused(f, path, MESH_PLY, strerror(EFBIG));
    setrlimit(RLIMIT_FSIZE, &before);
    size_t size;
    unsigned char *bytes = read_all(path, &size);
    assert_string_equal((char *)bytes, "old");
    assert_int_not_equal(access(part, F_OK), 0);
    free(bytes);
    unlink(path);
    fixture_destroy(f);
}

static void test_other_endings_are_refused(void **state) {
    (void)state;
    MeshFormat format;
    char message[512] = "";
    assert_int_equal(mesh_format_of("a.PLY", &format), RESULT_OK);
    assert_int_equal(format, MESH_PLY);
    assert_int_equal(mesh_format_of("dir.d/a.Glb", &format), RESULT_OK);
    assert_int_equal(format, MESH_GLB);
    log_set_sink(keep_message, message);
    assert_int_equal(mesh_format_of("a.stl", &format), RESULT_USAGE);
    assert_non_null(strstr(message, "a.stl"));
    assert_int_equal(mesh_format_of(".ply", &format), RESULT_USAGE);
    assert_int_equal(mesh_format_of("", &format), RESULT_USAGE);
    log_set_sink(NULL, NULL);
}

static void test_an_empty_mesh_is_written_where_the_format_can(void **state) {
    (void)state;
    Fixture *f = fixture_create();
    MeshPlane nothing = {{0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}};
    assert_int_equal(mesh_cull(&f->mesh, &nothing, 1), RESULT_OK);
    size_t size;
    unsigned char *bytes = write_and_read(f, "empty.ply", &size);
    assert_non_null(strstr((char *)bytes, "element face 0\n"));
    free(bytes);
    char message[512] = "", path[256];
    path_of("empty.glb", path);
    log_set_sink(keep_message, message);
    assert_int_equal(mesh_write(&f->mesh, MESH_GLB, path), RESULT_RANGE);
    log_set_sink(NULL, NULL);
    print_message("%s\n", message);
    assert_int_not_equal(access(path, F_OK), 0);
    fixture_destroy(f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_vertices_of_two_patches_occur_once),
        cmocka_unit_test(test_culling_keeps_what_a_plane_touches),
        cmocka_unit_test(test_ply_holds_earth_centred_doubles),
        cmocka_unit_test(test_obj_is_local_east_north_up),
        cmocka_unit_test(test_glb_is_valid_and_goes_back_to_ecef),
        cmocka_unit_test(test_a_full_disk_names_the_file),
        cmocka_unit_test(test_a_missing_folder_names_the_file),
        cmocka_unit_test(test_a_failed_write_leaves_the_old_file),
        cmocka_unit_test(test_other_endings_are_refused),
        cmocka_unit_test(test_an_empty_mesh_is_written_where_the_format_can),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
