#include "config/quantity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

// International foot and pound, and the pound's weight at standard gravity (NIST SP 811, appendix B).
#define FOOT 0.3048
#define POUND 0.45359237
#define POUND_FORCE (POUND * 9.80665)

typedef struct Unit {
    QuantityKind kind;
    const char *name;
    double factor;
} Unit;

static const Unit units[] = {
    {QUANTITY_LENGTH, "m", 1.0},
    {QUANTITY_LENGTH, "km", 1000.0},
    {QUANTITY_LENGTH, "ft", 0.3048},
    {QUANTITY_LENGTH, "nmi", 1852.0},
    {QUANTITY_LENGTH, "mi", 1609.344},
    {QUANTITY_SPEED, "m/s", 1.0},
    {QUANTITY_SPEED, "km/h", 1.0 / 3.6},
    {QUANTITY_SPEED, "kt", 1852.0 / 3600.0},
    {QUANTITY_SPEED, "mph", 1609.344 / 3600.0},
    {QUANTITY_SPEED, "ft/s", 0.3048},
    {QUANTITY_ANGLE, "deg", 1.0},
    {QUANTITY_ANGLE, "rad", 57.29577951308232},
    {QUANTITY_AREA, "m2", 1.0},
    {QUANTITY_AREA, "ft2", FOOT *FOOT},
    {QUANTITY_MASS, "kg", 1.0},
    {QUANTITY_MASS, "lb", POUND},
    {QUANTITY_INERTIA, "kg m2", 1.0},
    {QUANTITY_INERTIA, "slug ft2", POUND_FORCE *FOOT},
    {QUANTITY_FORCE, "N", 1.0},
    {QUANTITY_FORCE, "kN", 1000.0},
    {QUANTITY_FORCE, "lbf", POUND_FORCE},
    {QUANTITY_TORQUE, "N m", 1.0},
    {QUANTITY_TORQUE, "ft lbf", POUND_FORCE *FOOT},
    {QUANTITY_RATE, "1/s", 1.0},
    {QUANTITY_RATE, "rpm", 1.0 / 60.0},
    {QUANTITY_TIME, "s", 1.0},
    {QUANTITY_TIME, "min", 60.0},
    {QUANTITY_STIFFNESS, "N/m", 1.0},
    {QUANTITY_STIFFNESS, "lbf/ft", POUND_FORCE / FOOT},
    {QUANTITY_DAMPING, "N s/m", 1.0},
    {QUANTITY_DAMPING, "lbf s/ft", POUND_FORCE / FOOT},
    {QUANTITY_BYTES, "B", 1.0},
    {QUANTITY_BYTES, "K", 1024.0},
    {QUANTITY_BYTES, "KB", 1024.0},
    {QUANTITY_BYTES, "KiB", 1024.0},
    {QUANTITY_BYTES, "M", 1048576.0},
    {QUANTITY_BYTES, "MB", 1048576.0},
    {QUANTITY_BYTES, "MiB", 1048576.0},
    {QUANTITY_BYTES, "G", 1073741824.0},
    {QUANTITY_BYTES, "GB", 1073741824.0},
    {QUANTITY_BYTES, "GiB", 1073741824.0},
};

const char *quantity_units(QuantityKind kind) {
    static const char *const names[QUANTITY_KIND_COUNT] = {
        [QUANTITY_PLAIN] = "",
        [QUANTITY_LENGTH] = "m, km, ft, nmi, mi",
        [QUANTITY_SPEED] = "m/s, km/h, kt, mph, ft/s",
        [QUANTITY_ANGLE] = "deg, rad",
        [QUANTITY_BYTES] = "B, K, M, G",
        [QUANTITY_AREA] = "m2, ft2",
        [QUANTITY_MASS] = "kg, lb",
        [QUANTITY_INERTIA] = "kg m2, slug ft2",
        [QUANTITY_FORCE] = "N, kN, lbf",
        [QUANTITY_TORQUE] = "N m, ft lbf",
        [QUANTITY_RATE] = "1/s, rpm",
        [QUANTITY_TIME] = "s, min",
        [QUANTITY_STIFFNESS] = "N/m, lbf/ft",
        [QUANTITY_DAMPING] = "N s/m, lbf s/ft",
    };
    return names[kind];
}

static const char *skip_spaces(const char *text) {
    return text + strspn(text, " \t");
}

static size_t trimmed_length(const char *text, size_t length) {
    while (length > 0 && (text[length - 1] == ' ' || text[length - 1] == '\t'))
        length--;
    return length;
}

static bool unit_factor(QuantityKind kind, const char *name, size_t length, double *factor) {
    *factor = 1.0;
    if (length == 0)
        return true;
    for (size_t i = 0; i < COUNT_OF(units); i++) {
        if (units[i].kind == kind && strlen(units[i].name) == length && strncasecmp(units[i].name, name, length) == 0) {
            *factor = units[i].factor;
            return true;
        }
    }
    return false;
}

// strtod also takes hexadecimal, "inf" and "nan", which nobody means here: only its decimal form passes.
static bool begins_decimal(const char *text) {
    text += *text == '-' || *text == '+';
    return (*text >= '0' && *text <= '9' && text[1] != 'x' && text[1] != 'X') ||
           (*text == '.' && text[1] >= '0' && text[1] <= '9');
}

static Result parse_piece(QuantityKind kind, const char *text, size_t length, double *out) {
    char piece[64];
    if (length >= sizeof piece)
        return RESULT_USAGE;
    memcpy(piece, text, length);
    piece[length] = '\0';
    const char *begin = skip_spaces(piece);
    if (!begins_decimal(begin))
        return RESULT_USAGE;
    char *end;
    double number = strtod(begin, &end);
    const char *unit = skip_spaces(end);
    double factor;
    if (!unit_factor(kind, unit, trimmed_length(unit, strlen(unit)), &factor))
        return RESULT_USAGE;
    if (!isfinite(number) || fabs(number) > 1e300)
        return RESULT_USAGE;
    *out = number * factor;
    return RESULT_OK;
}

Result quantity_parse(QuantityKind kind, const char *text, double *out) {
    return parse_piece(kind, text, strlen(text), out);
}

Result quantity_parse_list(const QuantityKind *kinds, int count, const char *text, double *out) {
    for (int i = 0; i < count; i++) {
        size_t length = strcspn(text, ",");
        Result result = parse_piece(kinds[i], text, length, &out[i]);
        if (result != RESULT_OK)
            return result;
        bool more = text[length] == ',';
        if (more != (i + 1 < count))
            return RESULT_USAGE;
        text += length + more;
    }
    return RESULT_OK;
}
