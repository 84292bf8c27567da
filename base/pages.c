#include "base/pages.h"

#define PAGE 4096 // or less than the system's

void pages_own(void *zeros, size_t bytes) {
    volatile unsigned char *byte = zeros;
    for (size_t at = 0; at < bytes; at += PAGE)
        byte[at] = 0;
    if (bytes > 0)
        byte[bytes - 1] = 0;
}
