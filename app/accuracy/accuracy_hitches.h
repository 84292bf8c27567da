// app/accuracy/accuracy_hitches.h: frames that took much longer than their run's others, and why.
// Milliseconds.
// Values; the Accuracy is borrowed.
#pragma once
#include "app/accuracy/accuracy.h"

#define ACCURACY_HITCH_TIMES 1.5 // the median of the run's frames
#define ACCURACY_HITCHES_MAX 12  // of one DEM: those that are told
#define ACCURACY_CAUSE_BYTES 96

typedef struct AccuracyHitch {
    const AccuracyRun *run;
    int pose;
    double times;                     // the run's median
    char cause[ACCURACY_CAUSE_BYTES]; // in words: the stage that took most of what is too much, and what it did
} AccuracyHitch;

// Of one DEM, the longest for its run first, without jumps. `found`: how many there are in all. Returns how many are in
// `out`.
int accuracy_hitches(const Accuracy *accuracy, int dem, AccuracyHitch out[ACCURACY_HITCHES_MAX], int *found);
