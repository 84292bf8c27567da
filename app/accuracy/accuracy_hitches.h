// app/accuracy/accuracy_hitches.h: frames that took much longer than their run's others, and why.
// Milliseconds.
// Values; the Accuracy is borrowed.
#pragma once
#include "app/accuracy/accuracy.h"

#define ACCURACY_HITCH_TIMES 1.5 // what the frame takes in other rounds, or others of its flight take
#define ACCURACY_HITCHES_MAX 12  // of one DEM: those that are told
#define ACCURACY_CAUSE_BYTES 96

typedef struct AccuracyHitch {
    const AccuracyRun *run;
    int pose;
    double ms, times;                 // of what it is compared with
    char cause[ACCURACY_CAUSE_BYTES]; // in words: once, or in all rounds the stage that took most of what is too much
} AccuracyHitch;

// Of one DEM, the worst first, without jumps: frames of which one round took much longer than their own median, which
// is the system's doing, and frames whose median is much longer than that of their run's in the same flight. `found`:
// how many there are in all. Returns how many are in `out`. Without memory for sorting: none.
int accuracy_hitches(const Accuracy *accuracy, int dem, AccuracyHitch out[ACCURACY_HITCHES_MAX], int *found);
