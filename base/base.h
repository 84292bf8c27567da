// base/base.h: result codes and the attributes every header uses.
// No units, no frames.
// Owns nothing.
#pragma once
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// One row per code: identifier, text for people.
#define RESULT_TABLE(X)                                                                                                \
    X(OK, "done")                                                                                                      \
    X(USAGE, "wrong usage")                                                                                            \
    X(NOT_FOUND, "not found")                                                                                          \
    X(IO, "reading or writing failed")                                                                                 \
    X(FORMAT, "the file is damaged or of another kind")                                                                \
    X(UNSUPPORTED, "not supported")                                                                                    \
    X(RANGE, "a value is out of range")                                                                                \
    X(MEMORY, "out of memory")                                                                                         \
    X(DEVICE, "a device or driver is missing or failed")                                                               \
    X(BUDGET, "a budget was reached")

typedef enum Result {
#define RESULT_ENUM(name, text) RESULT_##name,
    RESULT_TABLE(RESULT_ENUM)
#undef RESULT_ENUM
} Result;

// The identifier without its prefix ("FORMAT") and the text; static storage.
const char *result_name(Result result);
const char *result_text(Result result);

#define MUST_USE __attribute__((warn_unused_result))
#define PRINTF_LIKE(text, first) __attribute__((format(printf, text, first)))
#define COUNT_OF(array) (sizeof(array) / sizeof((array)[0]))

// Several builds of one function, chosen when the program starts. Without contraction of multiply-adds
// (-ffp-contract=off) all of them give the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) &&               \
    !defined(__SANITIZE_THREAD__)
#define SIMD_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define SIMD_CLONES
#endif

#ifdef __cplusplus
}
#endif
