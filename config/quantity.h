// config/quantity.h: numbers with units, as people type them.
// Results in metres, metres a second, degrees, bytes, and otherwise SI units.
// Pure functions; any thread.
#pragma once
#include "base/base.h"

typedef enum QuantityKind {
    QUANTITY_PLAIN,
    QUANTITY_LENGTH, // m (or nothing), km, ft, nmi, mi
    QUANTITY_SPEED,  // m/s (or nothing), km/h, kt, mph, ft/s
    QUANTITY_ANGLE,  // deg (or nothing), rad
    QUANTITY_BYTES,  // B (or nothing), K, M, G, also KiB, KB ...: powers of 1024
    QUANTITY_AREA,   // the SI unit (or nothing), and those of quantity_units
    QUANTITY_MASS,
    QUANTITY_INERTIA,
    QUANTITY_FORCE,
    QUANTITY_TORQUE,
    QUANTITY_RATE, // revolutions a second
    QUANTITY_TIME,
    QUANTITY_STIFFNESS,
    QUANTITY_DAMPING,
    QUANTITY_KIND_COUNT
} QuantityKind;

// The whole of `text` is one decimal number and its unit, spaces allowed around both. USAGE otherwise, and for numbers
// that are not finite; nothing is logged.
MUST_USE Result quantity_parse(QuantityKind kind, const char *text, double *out);
// As quantity_parse for `count` comma-separated quantities of the given kinds.
MUST_USE Result quantity_parse_list(const QuantityKind *kinds, int count, const char *text, double *out);
// Units for messages: "m, km, ft, nmi, mi"; "" for plain numbers.
const char *quantity_units(QuantityKind kind);
