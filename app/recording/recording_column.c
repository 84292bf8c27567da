// Rice codes: R. Rice, J. Plaunt, "Adaptive variable-length coding for efficient compression of spacecraft television
// data", IEEE Trans. Comm. Tech. 19, 1971: the quotient by 2^k in ones and a zero, then k bits of the rest.
#include "app/recording/recording_column.h"

#include <string.h>

#define RICE_BITS 4
#define RICE_MAX 15
#define ESCAPE 20 // ones: the 16 bits follow as they are
#define HISTORY 4
#define RANKS_BITS 6
#define RANKS_MAX ((1 << RANKS_BITS) - 1)

typedef enum Predictor {
    PREDICT_CONSTANT, // all are as the first; no bits follow
    PREDICT_LAST,     // as the one before
    PREDICT_LINE2,    // on the line through the two before
    PREDICT_LINE4     // on the line of least squares through the four before
} Predictor;

typedef struct Coding {
    Predictor predictor;
    int rice;
    size_t bits; // with the head
} Coding;

// ---- bits ----

static void write_bits(RecordingBits *to, uint32_t value, int count) {
    for (int i = 0; i < count; i++) {
        if (to->bit == to->bits) {
            to->over = true;
            return;
        }
        to->bytes[to->bit / 8] |= (uint8_t)((value >> i & 1) << to->bit % 8);
        to->bit++;
    }
}

static uint32_t read_bits(RecordingBits *from, int count) {
    uint32_t value = 0;
    for (int i = 0; i < count; i++) {
        if (from->bit == from->bits) {
            from->over = true;
            return 0;
        }
        value |= (uint32_t)(from->bytes[from->bit / 8] >> from->bit % 8 & 1) << i;
        from->bit++;
    }
    return value;
}

static size_t code_bits(uint16_t code, int rice) {
    int quotient = code >> rice;
    return quotient < ESCAPE ? (size_t)(quotient + 1 + rice) : ESCAPE + 16;
}

static void write_code(RecordingBits *to, uint16_t code, int rice) {
    int quotient = code >> rice;
    if (quotient < ESCAPE) {
        write_bits(to, (1u << quotient) - 1, quotient + 1);
        write_bits(to, code, rice);
    } else {
        write_bits(to, (1u << ESCAPE) - 1, ESCAPE);
        write_bits(to, code, 16);
    }
}

static uint16_t read_code(RecordingBits *from, int rice) {
    int quotient = 0;
    while (quotient < ESCAPE && read_bits(from, 1))
        quotient++;
    if (quotient == ESCAPE)
        return (uint16_t)read_bits(from, 16);
    return (uint16_t)((uint32_t)quotient << rice | read_bits(from, rice));
}

// ---- predictions ----

typedef struct History {
    int before[HISTORY]; // the latest first
} History;

static History begin_history(int16_t first) {
    return (History){{first, first, first, first}};
}

static void add_history(History *history, int16_t value) {
    for (int i = HISTORY - 1; i > 0; i--)
        history->before[i] = history->before[i - 1];
    history->before[0] = value;
}

static int half_down(int value) {
    return value >= 0 ? value / 2 : -((1 - value) / 2);
}

// The next value of the least-squares line through n equidistant ones weighs the i-th latest by (4n + 2 - 6i)/(n(n -
// 1)).
static int predict(const History *history, Predictor predictor) {
    const int *x = history->before;
    switch (predictor) {
    case PREDICT_LINE2:
        return 2 * x[0] - x[1];
    case PREDICT_LINE4:
        return half_down(2 * x[0] + x[1] - x[3] + 1);
    case PREDICT_CONSTANT:
    case PREDICT_LAST:
        break;
    }
    return x[0];
}

// Errors near zero become small numbers: 0, -1, 1, -2, ... Beyond 16 bits they wrap.
static uint16_t zigzag(int error) {
    uint16_t bits = (uint16_t)error;
    return (uint16_t)(bits << 1 ^ (bits >> 15 ? 0xFFFF : 0));
}

static int unzigzag(uint16_t code) {
    return code >> 1 ^ (code & 1 ? 0xFFFF : 0);
}

// Of steps 1..count-1; their sum.
static uint64_t error_codes(const int16_t *values, int count, Predictor predictor, uint16_t *out) {
    History history = begin_history(values[0]);
    uint64_t sum = 0;
    for (int i = 1; i < count; i++) {
        out[i] = zigzag(values[i] - predict(&history, predictor));
        sum += out[i];
        add_history(&history, values[i]);
    }
    return sum;
}

// ---- a plain sequence ----

static size_t head_bits(int16_t first, bool constant) {
    return 2 + (constant ? 0 : RICE_BITS) + 1 + (first == 0 ? 0 : 16);
}

static bool is_constant(const int16_t *values, int count) {
    for (int i = 1; i < count; i++)
        if (values[i] != values[0])
            return false;
    return true;
}

// The parameter that a geometric distribution of this mean wants, or a neighbour.
static void try_predictor(const int16_t *values, int count, Predictor predictor, Coding *best) {
    uint16_t codes[RECORDING_COLUMN_STEPS_MAX];
    uint64_t mean = error_codes(values, count, predictor, codes) / (uint64_t)(count - 1);
    int middle = 0;
    while (mean >> (middle + 1) && middle < RICE_MAX - 1)
        middle++;
    for (int rice = middle > 0 ? middle - 1 : 0; rice <= middle + 1; rice++) {
        size_t bits = head_bits(values[0], false);
        for (int i = 1; i < count; i++)
            bits += code_bits(codes[i], rice);
        if (bits < best->bits)
            *best = (Coding){predictor, rice, bits};
    }
}

static Coding choose(const int16_t *values, int count) {
    Coding best = {PREDICT_CONSTANT, 0, SIZE_MAX};
    if (is_constant(values, count)) {
        best.bits = head_bits(values[0], true);
        return best;
    }
    for (int predictor = PREDICT_LAST; predictor <= PREDICT_LINE4; predictor++)
        try_predictor(values, count, (Predictor)predictor, &best);
    return best;
}

static void write_plain(RecordingBits *to, const Coding *coding, const int16_t *values, int count) {
    uint16_t codes[RECORDING_COLUMN_STEPS_MAX];
    bool constant = coding->predictor == PREDICT_CONSTANT;
    write_bits(to, coding->predictor, 2);
    write_bits(to, (uint32_t)coding->rice, constant ? 0 : RICE_BITS);
    write_bits(to, values[0] == 0, 1);
    write_bits(to, (uint16_t)values[0], values[0] == 0 ? 0 : 16);
    if (constant)
        return;
    error_codes(values, count, coding->predictor, codes);
    for (int i = 1; i < count; i++)
        write_code(to, codes[i], coding->rice);
}

static void read_plain(RecordingBits *from, int16_t *out, int count) {
    Predictor predictor = (Predictor)read_bits(from, 2);
    int rice = predictor == PREDICT_CONSTANT ? 0 : (int)read_bits(from, RICE_BITS);
    out[0] = read_bits(from, 1) ? 0 : (int16_t)read_bits(from, 16);
    History history = begin_history(out[0]);
    for (int i = 1; i < count; i++) {
        int error = predictor == PREDICT_CONSTANT ? 0 : unzigzag(read_code(from, rice));
        out[i] = (int16_t)(uint16_t)(predict(&history, predictor) + error);
        add_history(&history, out[i]);
    }
}

// ---- few distinct values, as of a coarse sensor: these in order, and which of them it is at each step ----

typedef struct Ranks {
    int16_t distinct[RANKS_MAX];
    int count;
    int16_t at[RECORDING_COLUMN_STEPS_MAX];
} Ranks;

static int find_place(const Ranks *ranks, int16_t value) {
    int place = 0;
    while (place < ranks->count && ranks->distinct[place] < value)
        place++;
    return place;
}

static bool add_distinct(Ranks *ranks, int16_t value) {
    int place = find_place(ranks, value);
    if (place < ranks->count && ranks->distinct[place] == value)
        return true;
    if (ranks->count == RANKS_MAX)
        return false;
    memmove(&ranks->distinct[place + 1], &ranks->distinct[place],
            sizeof ranks->distinct[0] * (size_t)(ranks->count - place));
    ranks->distinct[place] = value;
    ranks->count++;
    return true;
}

static bool find_ranks(const int16_t *values, int count, Ranks *out) {
    out->count = 0;
    for (int i = 0; i < count; i++)
        if (!add_distinct(out, values[i]))
            return false;
    for (int i = 0; i < count; i++)
        out->at[i] = (int16_t)find_place(out, values[i]);
    return true;
}

static bool read_ranks(RecordingBits *from, int16_t *out, int count) {
    int16_t distinct[RANKS_MAX];
    int distinct_count = (int)read_bits(from, RANKS_BITS);
    if (distinct_count == 0)
        return false;
    read_plain(from, distinct, distinct_count);
    read_plain(from, out, count);
    for (int i = 0; i < count; i++) {
        if (out[i] < 0 || out[i] >= distinct_count)
            return false;
        out[i] = distinct[out[i]];
    }
    return true;
}

// ---- a column ----

void recording_column_write(RecordingBits *to, const int16_t *values, int count) {
    Ranks ranks;
    if (count == 0)
        return;
    Coding plain = choose(values, count);
    if (plain.predictor != PREDICT_CONSTANT && find_ranks(values, count, &ranks)) {
        Coding distinct = choose(ranks.distinct, ranks.count), at = choose(ranks.at, count);
        if (RANKS_BITS + distinct.bits + at.bits < plain.bits) {
            write_bits(to, 1, 1);
            write_bits(to, (uint32_t)ranks.count, RANKS_BITS);
            write_plain(to, &distinct, ranks.distinct, ranks.count);
            write_plain(to, &at, ranks.at, count);
            return;
        }
    }
    write_bits(to, 0, 1);
    write_plain(to, &plain, values, count);
}

bool recording_column_read(RecordingBits *from, int16_t *out, int count) {
    if (count == 0)
        return true;
    bool ranked = read_bits(from, 1);
    if (!ranked)
        read_plain(from, out, count);
    else if (!read_ranks(from, out, count))
        return false;
    return !from->over;
}
