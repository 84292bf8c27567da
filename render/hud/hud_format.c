#include "render/hud/hud_paint.h"

#include "terrain/geodesy.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define THIN_SPACE "\xE2\x80\x89"
#define MINUS "\xE2\x88\x92"
#define SAYABLE_MOST 1e12 // beyond it no instrument means what it shows

// Copies digits and what follows them, with a thin space before each group of three of the integer part.
static void group_thousands(char *out, size_t size, const char *digits) {
    size_t integer = strspn(digits, "0123456789"), at = 0;
    for (size_t i = 0; digits[i] && at + sizeof THIN_SPACE + 1 < size; i++) {
        if (i > 0 && i < integer && (integer - i) % 3 == 0)
            at += (size_t)snprintf(out + at, size - at, THIN_SPACE);
        out[at++] = digits[i];
    }
    out[at] = '\0';
}

static void format_magnitude(char *out, size_t size, double magnitude, int decimals) {
    char digits[32];
    snprintf(digits, sizeof digits, "%.*f", decimals, magnitude);
    group_thousands(out, size, digits);
}

static bool is_sayable(double value) {
    return isfinite(value) && fabs(value) <= SAYABLE_MOST;
}

static bool rounds_to_zero(double value, int decimals) {
    return fabs(value) < 0.5 * pow(10.0, -decimals);
}

void hud_format_fixed(char out[HUD_NUMBER_BYTES], double value, int decimals) {
    if (!is_sayable(value)) {
        snprintf(out, HUD_NUMBER_BYTES, "---");
        return;
    }
    const char *sign = value < 0.0 && !rounds_to_zero(value, decimals) ? MINUS : "";
    int at = snprintf(out, HUD_NUMBER_BYTES, "%s", sign);
    format_magnitude(out + at, HUD_NUMBER_BYTES - (size_t)at, fabs(value), decimals);
}

void hud_format_signed(char out[HUD_NUMBER_BYTES], double value, int decimals) {
    if (!is_sayable(value) || value < 0.0 || rounds_to_zero(value, decimals)) {
        hud_format_fixed(out, value, decimals);
        return;
    }
    out[0] = '+';
    format_magnitude(out + 1, HUD_NUMBER_BYTES - 1, value, decimals);
}

void hud_format_heading(char out[HUD_NUMBER_BYTES], double heading_rad) {
    if (!is_sayable(heading_rad)) {
        snprintf(out, HUD_NUMBER_BYTES, "---");
        return;
    }
    double degrees = fmod(round(heading_rad / GEODESY_RAD_PER_DEG), 360.0);
    snprintf(out, HUD_NUMBER_BYTES, "%03.0f", degrees <= 0.0 ? degrees + 360.0 : degrees);
}

void hud_format_bytes(char out[HUD_NUMBER_BYTES], double bytes, const char **unit) {
    static const char *const UNITS[] = {"B", "kB", "MB", "GB"};
    size_t step = 0;
    while (step + 1 < COUNT_OF(UNITS) && bytes >= 999.5) {
        bytes /= 1000.0;
        step++;
    }
    *unit = UNITS[step];
    hud_format_fixed(out, bytes, step == 0 || bytes >= 99.95 ? 0 : 1);
}
