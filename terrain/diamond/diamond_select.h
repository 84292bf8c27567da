// terrain/diamond/diamond_select.h: what to split, as people write it: 'error > 5 || within(36.6, -84.2, 2000)'.
// Metres and degrees as people type them; lengths may have units (2km, 500ft).
// A DiamondSelect is owned by whoever created it and constant afterwards: any thread may read it.
//
// Source: Yalcin, Weiss, De Floriani 2011, sections 4 and 6: any predicate, saturated or not. The language is our own.
//
//   or:      and ('||' and)*            and:  not ('&&' not)*          not:  '!' not | comparison
//   comparison: sum (('<' '<=' '>' '>=') sum)?     sum: product (('+' '-') product)*     product: sign ('*' sign)*
//   sign: '-' sign | number | name | name '(' numbers ')' | '(' or ')'
#pragma once
#include "base/base.h"

typedef struct DiamondModel DiamondModel;
typedef struct DiamondSelect DiamondSelect;

// Fields of the model beyond positions and errors that an operation reads.
#define DIAMOND_FIELD_DATUM 1u   // datum_m
#define DIAMOND_FIELD_DEGREES 2u // east_deg, north_deg

// X(identifier, operands taken from the stack, constants, what it leaves on the stack). Truth is 1.0f, else 0.0f.
// e: error_m, r: reach_m, v: position - eye, d2: diamond_distance2(v), s: view.slack_m, c: the constants.
#define DIAMOND_OP_TABLE(X)                                                                                            \
    X(CONSTANT, 0, 1, "c[0]")                                                                                          \
    X(ERROR, 0, 0, "e")                                                                                                \
    X(PX, 0, 0, "diamond_px(e, r, d2, view.px_per_rad, s)")                                                            \
    X(DISTANCE, 0, 0, "diamond_root(d2)")                                                                              \
    X(HEIGHT, 0, 0, "datum_m")                                                                                         \
    X(LEVEL, 0, 0, "float(diamond_level)")                                                                             \
    X(STEP, 0, 0, "float(1 << plane)")                                                                                 \
    X(TAU, 0, 0, "view.tau_px")                                                                                        \
    X(TOLERANCE, 0, 0, "diamond_tolerance(e, r, d2, view.nu, s)")                                                      \
    X(INVIEW, 0, 0, "diamond_inview(v, r, s, view.plane)")                                                             \
    X(WITHIN, 0, 10, "diamond_within(position, r, s, c)")                                                              \
    X(BOX, 0, 6, "diamond_box(east_deg, north_deg, r, c)")                                                             \
    X(ADD, 2, 0, "a + b")                                                                                              \
    X(SUBTRACT, 2, 0, "a - b")                                                                                         \
    X(MULTIPLY, 2, 0, "a * b")                                                                                         \
    X(NEGATE, 1, 0, "-a")                                                                                              \
    X(LESS, 2, 0, "a < b")                                                                                             \
    X(LESS_EQUAL, 2, 0, "a <= b")                                                                                      \
    X(GREATER, 2, 0, "a > b")                                                                                          \
    X(GREATER_EQUAL, 2, 0, "a >= b")                                                                                   \
    X(AND, 2, 0, "a != 0 && b != 0")                                                                                   \
    X(OR, 2, 0, "a != 0 || b != 0")                                                                                    \
    X(NOT, 1, 0, "a == 0")

typedef enum DiamondOp {
#define DIAMOND_OP_ENUM(id, operands, constants, meaning) DIAMOND_OP_##id,
    DIAMOND_OP_TABLE(DIAMOND_OP_ENUM) DIAMOND_OP_COUNT
#undef DIAMOND_OP_ENUM
} DiamondOp;

#define DIAMOND_STEPS_MAX 128
#define DIAMOND_CONSTANTS_MAX 256
#define DIAMOND_STACK_MAX 16

typedef struct DiamondStep {
    uint8_t op;     // DiamondOp
    uint16_t first; // of its constants
} DiamondStep;

// In postfix order, bound to one model: places are relative to its origin.
typedef struct DiamondProgram {
    int step_count, constant_count;
    DiamondStep steps[DIAMOND_STEPS_MAX];
    float constants[DIAMOND_CONSTANTS_MAX];
} DiamondProgram;

// The sides of the view that `inview` asks about: a camera without bank.
typedef struct DiamondLens {
    double tan_right, tan_up; // of half the angles of view, > 0
} DiamondLens;

// `lens`: NULL where there is none; then `inview` is refused. USAGE, with a message that has the position, what was
// expected and what was found; MEMORY.
MUST_USE Result diamond_select_create(const char *text, const DiamondLens *lens, DiamondSelect **out);
void diamond_select_destroy(DiamondSelect **select);

const char *diamond_select_text(const DiamondSelect *select);
const DiamondLens *diamond_select_lens(const DiamondSelect *select); // NULL: none
unsigned diamond_select_fields(const DiamondSelect *select);         // DIAMOND_FIELD_*
// Whether it contains the tolerance as an alternative, so that tau is kept at every sample.
bool diamond_select_promises(const DiamondSelect *select);
// `select` NULL: the tolerance.
void diamond_select_bind(const DiamondSelect *select, const DiamondModel *model, DiamondProgram *out);
