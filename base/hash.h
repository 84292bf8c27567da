// base/hash.h: one number that tells whether much is the same.
// No units.
// Pure functions.
#pragma once
#include <stdint.h>

// Another value into a hash of those before. By the multiplier of Fibonacci hashing, 2^64 over the golden ratio: Knuth,
// The Art of Computer Programming 3, section 6.4.
static inline uint64_t hash_mix(uint64_t hash, uint64_t value) {
    hash = (hash ^ value) * UINT64_C(0x9e3779b97f4a7c15);
    return hash ^ hash >> 29;
}
