// Our own: recursive descent over the grammar in diamond_select.h, to steps in postfix order. Every value has a type,
// a number or a truth, so that 'error && 5' is an error of the person and not a surprise. What the steps mean is
// Yalcin, Weiss, De Floriani 2011, sections 4 and 6.
#include "terrain/diamond/diamond_select.h"

#include "base/log.h"
#include "terrain/diamond/diamond_lex.h"
#include "terrain/diamond/diamond_select_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NESTING_MAX 64
#define TEXT_MAX 4096 // characters

typedef enum Type { NUMBER, TRUTH } Type;

typedef struct Value {
    Type type;
    bool promises; // true wherever the tolerance is
    int position;
} Value;

typedef struct Parser {
    DiamondSelect *select;
    DiamondToken token; // not yet taken
    int depth;          // of the stack
    int nesting;        // of brackets and signs
    int constants;      // of the bound program
    int steps;          // of the bound program, at most
    bool failed;        // said so already
} Parser;

static const Value NOTHING = {NUMBER, false, 0};

// ---- messages ----

static void fail_with(Parser *p, int position, const char *expected, const char *found) {
    if (!p->failed)
        log_error("selection '%s', character %d: expected %s, found %s", p->select->text, position + 1, expected,
                  found);
    p->failed = true;
}

static void fail_at_token(Parser *p, const char *expected) {
    const DiamondToken *t = &p->token;
    char found[80];
    if (t->kind == DIAMOND_TOKEN_END) {
        fail_with(p, t->position, expected, "the end");
    } else if (t->kind == DIAMOND_TOKEN_BAD_UNIT) {
        snprintf(found, sizeof found, "'%.*s'", t->length < 60 ? t->length : 60, t->text);
        fail_with(p, t->position, "a number, with m, km, ft, nmi, mi or nothing after it", found);
    } else {
        bool size = t->kind == DIAMOND_TOKEN_BAD_SIZE;
        snprintf(found, sizeof found, "'%.*s'", t->length < 60 ? t->length : 60, t->text);
        fail_with(p, t->position, size ? "a number of at most 1e30 and 63 digits" : expected, found);
    }
}

static void expect_type(Parser *p, Value value, Type type, const char *where) {
    char expected[96];
    if (value.type == type)
        return;
    snprintf(expected, sizeof expected, "%s %s", type == TRUTH ? "a condition" : "a number", where);
    fail_with(p, value.position, expected, type == TRUTH ? "a number; compare it" : "a condition");
}

// ---- tokens and steps ----

static void advance(Parser *p) {
    p->token = diamond_lex(p->select->text, p->token.position + p->token.length);
}

static bool take(Parser *p, const char *sign) {
    if (p->failed || !diamond_token_is(&p->token, sign))
        return false;
    advance(p);
    return true;
}

static void expect(Parser *p, const char *sign, const char *expected) {
    if (!p->failed && !take(p, sign))
        fail_at_token(p, expected);
}

static void emit(Parser *p, DiamondOp op, const double *arguments, int count) {
    DiamondSelect *s = p->select;
    int operands = diamond_op_operands(op);
    p->depth += 1 - operands;
    p->constants += diamond_op_constants(op);
    bool fits =
        s->step_count < DIAMOND_STEPS_MAX && p->constants <= DIAMOND_CONSTANTS_MAX && p->depth <= DIAMOND_STACK_MAX;
    if (!fits)
        fail_with(p, p->token.position, "a shorter selection", "more than its program can hold");
    if (p->failed)
        return;
    DiamondSelectStep *step = &s->steps[s->step_count++];
    step->op = op;
    for (int i = 0; i < count; i++)
        step->arguments[i] = arguments[i];
}

// ---- operands ----

static Value parse_or(Parser *p);

static const struct {
    const char *name;
    DiamondOp op;
    Type type;
    int arguments;
    const char *form; // for messages
} NAMES[] = {
    {"error", DIAMOND_OP_ERROR, NUMBER, 0, ""},
    {"px", DIAMOND_OP_PX, NUMBER, 0, ""},
    {"distance", DIAMOND_OP_DISTANCE, NUMBER, 0, ""},
    {"height", DIAMOND_OP_HEIGHT, NUMBER, 0, ""},
    {"level", DIAMOND_OP_LEVEL, NUMBER, 0, ""},
    {"step", DIAMOND_OP_STEP, NUMBER, 0, ""},
    {"tau", DIAMOND_OP_TAU, NUMBER, 0, ""},
    {"tolerance", DIAMOND_OP_TOLERANCE, TRUTH, 0, ""},
    {"inview", DIAMOND_OP_INVIEW, TRUTH, 0, ""},
    {"within", DIAMOND_OP_WITHIN, TRUTH, 3, "within(LAT, LON, METRES)"},
    {"box", DIAMOND_OP_BOX, TRUTH, 4, "box(WEST, SOUTH, EAST, NORTH)"},
};

static double parse_argument(Parser *p, const char *form, bool last) {
    double sign = take(p, "-") ? -1.0 : 1.0, number = p->token.number;
    if (p->failed)
        return 0.0;
    if (p->token.kind != DIAMOND_TOKEN_NUMBER) {
        fail_at_token(p, form);
        return 0.0;
    }
    advance(p);
    expect(p, last ? ")" : ",", form);
    return sign * number;
}

static bool is_degrees(double value, double most) {
    return value >= -most && value <= most;
}

static void check_arguments(Parser *p, DiamondOp op, const double *a, int position) {
    if (op == DIAMOND_OP_WITHIN && !(is_degrees(a[0], 90.0) && is_degrees(a[1], 540.0) && a[2] >= 0.0))
        fail_with(p, position, "a latitude of -90 to 90, a longitude of -540 to 540, and a radius of 0 or more",
                  "other numbers");
    if (op == DIAMOND_OP_BOX && !(is_degrees(a[0], 540.0) && is_degrees(a[2], 540.0) && is_degrees(a[1], 90.0) &&
                                  is_degrees(a[3], 90.0) && a[1] <= a[3]))
        fail_with(p, position, "longitudes of -540 to 540, latitudes of -90 to 90, the south below the north",
                  "other numbers");
    if (op == DIAMOND_OP_INVIEW && !p->select->has_lens)
        fail_with(p, position, "a criterion that needs no camera", "'inview'");
}

static Value parse_named(Parser *p, size_t index) {
    Value value = {NAMES[index].type, NAMES[index].op == DIAMOND_OP_TOLERANCE, p->token.position};
    double arguments[DIAMOND_ARGUMENTS_MAX] = {0};
    int count = NAMES[index].arguments;
    advance(p);
    if (count > 0)
        expect(p, "(", NAMES[index].form);
    for (int i = 0; i < count; i++)
        arguments[i] = parse_argument(p, NAMES[index].form, i == count - 1);
    check_arguments(p, NAMES[index].op, arguments, value.position);
    emit(p, NAMES[index].op, arguments, count);
    return value;
}

static Value parse_operand(Parser *p) {
    Value value = {NUMBER, false, p->token.position};
    if (p->token.kind == DIAMOND_TOKEN_NUMBER) {
        emit(p, DIAMOND_OP_CONSTANT, &p->token.number, 1);
        advance(p);
        return value;
    }
    for (size_t i = 0; i < COUNT_OF(NAMES); i++)
        if (diamond_token_is(&p->token, NAMES[i].name))
            return parse_named(p, i);
    if (take(p, "(")) {
        value = parse_or(p);
        expect(p, ")", "an operator or ')'");
        return value;
    }
    fail_at_token(p, "a number, '(', or one of error, px, distance, height, level, step, tau, tolerance, inview, "
                     "within(...), box(...)");
    return value;
}

// ---- operators, the tightest first ----

static bool enter(Parser *p) {
    if (!p->failed && ++p->nesting > NESTING_MAX)
        fail_with(p, p->token.position, "at most 64 nested brackets and signs", "one more");
    return !p->failed;
}

static Value parse_sign(Parser *p) {
    int position = p->token.position;
    if (!enter(p))
        return NOTHING;
    Value value;
    if (take(p, "-")) {
        value = parse_sign(p);
        expect_type(p, value, NUMBER, "after '-'");
        emit(p, DIAMOND_OP_NEGATE, NULL, 0);
        value = (Value){NUMBER, false, position};
    } else {
        value = parse_operand(p);
    }
    p->nesting--;
    return value;
}

typedef struct Operator {
    const char *sign;
    DiamondOp op;
} Operator;

static const Operator *take_one_of(Parser *p, const Operator *operators, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (take(p, operators[i].sign))
            return &operators[i];
    return NULL;
}

static void join(Parser *p, Value a, Value b, const Operator *sign, Type type) {
    char where[16];
    snprintf(where, sizeof where, "beside '%s'", sign->sign);
    expect_type(p, a, type, where);
    expect_type(p, b, type, where);
    emit(p, sign->op, NULL, 0);
}

static Value parse_product(Parser *p) {
    static const Operator operators[] = {{"*", DIAMOND_OP_MULTIPLY}};
    Value value = parse_sign(p);
    const Operator *found;
    while ((found = take_one_of(p, operators, COUNT_OF(operators))))
        join(p, value, parse_sign(p), found, NUMBER);
    return value;
}

static Value parse_sum(Parser *p) {
    static const Operator operators[] = {{"+", DIAMOND_OP_ADD}, {"-", DIAMOND_OP_SUBTRACT}};
    Value value = parse_product(p);
    const Operator *found;
    while ((found = take_one_of(p, operators, COUNT_OF(operators))))
        join(p, value, parse_product(p), found, NUMBER);
    return value;
}

static Value parse_comparison(Parser *p) {
    static const Operator operators[] = {{"<=", DIAMOND_OP_LESS_EQUAL},
                                         {">=", DIAMOND_OP_GREATER_EQUAL},
                                         {"<", DIAMOND_OP_LESS},
                                         {">", DIAMOND_OP_GREATER}};
    Value value = parse_sum(p);
    const Operator *found = take_one_of(p, operators, COUNT_OF(operators));
    if (!found)
        return value;
    join(p, value, parse_sum(p), found, NUMBER);
    return (Value){TRUTH, false, value.position};
}

static Value parse_not(Parser *p) {
    int position = p->token.position;
    if (!enter(p))
        return NOTHING;
    Value value;
    if (take(p, "!")) {
        value = parse_not(p);
        expect_type(p, value, TRUTH, "after '!'");
        emit(p, DIAMOND_OP_NOT, NULL, 0);
        value = (Value){TRUTH, false, position};
    } else {
        value = parse_comparison(p);
    }
    p->nesting--;
    return value;
}

static Value parse_and(Parser *p) {
    static const Operator both = {"&&", DIAMOND_OP_AND};
    Value value = parse_not(p);
    while (take(p, both.sign)) {
        Value other = parse_not(p);
        join(p, value, other, &both, TRUTH);
        value.promises = value.promises && other.promises;
    }
    return value;
}

static Value parse_or(Parser *p) {
    static const Operator either = {"||", DIAMOND_OP_OR};
    Value value = parse_and(p);
    while (take(p, either.sign)) {
        Value other = parse_and(p);
        join(p, value, other, &either, TRUTH);
        value.promises = value.promises || other.promises;
    }
    return value;
}

// ---- the selection ----

static bool parse(DiamondSelect *select) {
    Parser p = {.select = select};
    advance(&p);
    Value value = parse_or(&p);
    if (!p.failed && p.token.kind != DIAMOND_TOKEN_END)
        fail_at_token(&p, "an operator or the end");
    if (!p.failed)
        expect_type(&p, value, TRUTH, "as the whole selection");
    select->promises = value.promises;
    return !p.failed;
}

Result diamond_select_create(const char *text, const DiamondLens *lens, DiamondSelect **out) {
    size_t length = strlen(text);
    if (length > TEXT_MAX) {
        log_error("a selection of %zu characters: give one of at most %d", length, TEXT_MAX);
        return RESULT_USAGE;
    }
    DiamondSelect *select = calloc(1, sizeof *select + length + 1);
    if (!select)
        return RESULT_MEMORY;
    memcpy(select->text, text, length + 1);
    select->has_lens = lens;
    if (lens)
        select->lens = *lens;
    if (!parse(select)) {
        diamond_select_destroy(&select);
        return RESULT_USAGE;
    }
    *out = select;
    return RESULT_OK;
}

void diamond_select_destroy(DiamondSelect **select) {
    free(*select);
    *select = NULL;
}

const char *diamond_select_text(const DiamondSelect *select) {
    return select->text;
}

const DiamondLens *diamond_select_lens(const DiamondSelect *select) {
    return select->has_lens ? &select->lens : NULL;
}

bool diamond_select_promises(const DiamondSelect *select) {
    return select->promises;
}
