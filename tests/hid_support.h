// tests/hid_support.h: descriptors of sticks that are sold, and what must hold for any bytes at all.
// Bytes as devices send them.
// Static tables; values.
#pragma once
#include "input/hid/hid_descriptor.h"

typedef struct HidSample {
    const char *name;
    const uint8_t *bytes;
    size_t count;
} HidSample;

// Published by their owners; the sources stand beside the bytes.
extern const HidSample hid_x52, hid_hotas4, hid_raptor, hid_extreme3d, hid_t16000m, hid_t16000m_short, hid_twcs,
    hid_t_rudder;
#define HID_SAMPLES                                                                                                    \
    { &hid_x52, &hid_hotas4, &hid_raptor, &hid_extreme3d, &hid_t16000m, &hid_t16000m_short, &hid_twcs, &hid_t_rudder }

// Parses the bytes and decodes reports of every id and length that `seed` makes up. NULL, or which promise was broken.
const char *hid_exercise(const uint8_t *bytes, size_t count, uint64_t seed);
// The next number of a sequence (splitmix64, Steele et al. 2014); the state is any number.
uint64_t hid_random(uint64_t *state);
