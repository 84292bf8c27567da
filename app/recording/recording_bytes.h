// app/recording/recording_bytes.h: numbers as bytes, least first, and the checksum of headers.
// Bytes.
// Nothing owned; any thread.
#pragma once
#include "base/base.h"

static inline void recording_put16(uint8_t *to, uint16_t value) {
    to[0] = (uint8_t)value;
    to[1] = (uint8_t)(value >> 8);
}
static inline void recording_put32(uint8_t *to, uint32_t value) {
    recording_put16(to, (uint16_t)value);
    recording_put16(to + 2, (uint16_t)(value >> 16));
}
static inline void recording_put64(uint8_t *to, uint64_t value) {
    recording_put32(to, (uint32_t)value);
    recording_put32(to + 4, (uint32_t)(value >> 32));
}
static inline uint16_t recording_get16(const uint8_t *from) {
    return (uint16_t)(from[0] | from[1] << 8);
}
static inline uint32_t recording_get32(const uint8_t *from) {
    return recording_get16(from) | (uint32_t)recording_get16(from + 2) << 16;
}
static inline uint64_t recording_get64(const uint8_t *from) {
    return recording_get32(from) | (uint64_t)recording_get32(from + 4) << 32;
}

// CRC-32 as in IEEE 802.3, zlib and PNG (reflected polynomial EDB88320, all bits inverted before and after); `crc` is
// 0, or that of the bytes before.
uint32_t recording_crc32(uint32_t crc, const void *bytes, size_t count);
