// make_geoid IN.gtx OUT.pgm: the EGM96 grid of Debian's proj-data in the format that GeographicLib reads.
// In: NOAA's GTX, a header of four big-endian doubles (south, west, step north, step east, degrees) and two integers
// (rows, columns), then floats in metres, south first, from 180 W. Out: PGM of 16 bits, north first, from 0 E.
#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROWS 721
#define COLS 1440
#define OFFSET_M -108.0 // below the deepest dent of the geoid
#define SCALE_M 0.003   // so that 16 bits reach above its highest bulge

static int complain(const char *path, const char *what) {
    fprintf(stderr, "make_geoid: %s: %s\n", path, what);
    return 1;
}

static uint64_t read_big_endian(FILE *file, int bytes) {
    uint64_t value = 0;
    for (int i = 0; i < bytes; i++) {
        int byte = fgetc(file);
        value = value << 8 | (uint64_t)(byte == EOF ? 0 : byte);
    }
    return value;
}

static double read_double(FILE *file) {
    uint64_t bits = read_big_endian(file, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static float read_float(FILE *file) {
    uint32_t bits = (uint32_t)read_big_endian(file, 4);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static int read_header(FILE *file) {
    double south = read_double(file), west = read_double(file), north_step = read_double(file),
           east_step = read_double(file);
    uint64_t rows = read_big_endian(file, 4), cols = read_big_endian(file, 4);
    return south == -90.0 && west == -180.0 && north_step == 0.25 && east_step == 0.25 && rows == ROWS && cols == COLS;
}

static int read_grid(const char *path, uint16_t grid[ROWS][COLS]) {
    FILE *file = fopen(path, "rb");
    if (!file)
        return complain(path, strerror(errno));
    int known = read_header(file), valid = 1;
    for (int row = ROWS - 1; row >= 0 && known; row--)
        for (int col = 0; col < COLS; col++) {
            double level = ((double)read_float(file) - OFFSET_M) / SCALE_M;
            valid = valid && level >= 0.0 && level <= 65535.0;
            grid[row][(col + COLS / 2) % COLS] = valid ? (uint16_t)lrint(level) : 0;
        }
    valid = valid && !feof(file) && !ferror(file);
    fclose(file);
    if (!known)
        return complain(path, "not the global 15-minute grid; expected 721 x 1440 values from 90 S, 180 W");
    return valid ? 0 : complain(path, "truncated, or values outside -108..88.6 m");
}

static int write_grid(const char *path, uint16_t grid[ROWS][COLS]) {
    FILE *file = fopen(path, "wb");
    if (!file)
        return complain(path, strerror(errno));
    fprintf(file,
            "P5\n# Geoid file in PGM format for the GeographicLib::Geoid class\n"
            "# Description WGS84 EGM96, 15-minute grid\n# Offset %g\n# Scale %g\n# Origin 90N 0E\n"
            "# AREA_OR_POINT Point\n# Vertical_Datum WGS84\n%d %d\n65535\n",
            OFFSET_M, SCALE_M, COLS, ROWS);
    for (int row = 0; row < ROWS; row++)
        for (int col = 0; col < COLS; col++) {
            fputc(grid[row][col] >> 8, file);
            fputc(grid[row][col] & 255, file);
        }
    int failed = ferror(file);
    failed |= fclose(file);
    if (!failed)
        return 0;
    remove(path);
    return complain(path, "writing failed");
}

int main(int argc, char **argv) {
    if (argc != 3) {
        fprintf(stderr, "usage: make_geoid IN.gtx OUT.pgm\n");
        return 2;
    }
    uint16_t(*grid)[COLS] = malloc(ROWS * sizeof *grid);
    if (!grid)
        return complain(argv[1], "out of memory");
    int failed = read_grid(argv[1], grid);
    failed = failed ? failed : write_grid(argv[2], grid);
    free(grid);
    return failed;
}
