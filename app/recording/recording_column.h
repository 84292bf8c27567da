// app/recording/recording_column.h: one input over the steps of a chunk in few bits: a prediction's errors, Rice-coded.
// Codes of recording.h; bits, least first.
// Nothing owned; any thread. Lossless for every sequence of int16. The same values give the same bits.
#pragma once
#include "base/base.h"

#define RECORDING_COLUMN_STEPS_MAX 1024
#define RECORDING_COLUMN_HEAD_BITS 24 // at most; then at most RECORDING_COLUMN_STEP_BITS a step
#define RECORDING_COLUMN_STEP_BITS 36

typedef struct RecordingBits {
    uint8_t *bytes;   // read, or written; those written to are zero before
    size_t bit, bits; // the next one; how many there are
    bool over;        // read or written beyond the end
} RecordingBits;

// 0..RECORDING_COLUMN_STEPS_MAX values.
void recording_column_write(RecordingBits *to, const int16_t *values, int count);
// As many. Every sequence of bits is read as something; false: it ended too early.
bool recording_column_read(RecordingBits *from, int16_t *out, int count);
