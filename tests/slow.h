// tests/slow.h: what is left out where a sanitizer makes it take minutes, and others see the same code.
// No units.
// Macros; after the headers of cmocka.
#pragma once

// In a test whose threads are those of others beside it.
#ifdef __SANITIZE_THREAD__
#define SKIP_WHERE_THREADS_ARE_WATCHED()                                                                               \
    do {                                                                                                               \
        print_message("the thread sanitizer sees its threads in other tests\n");                                       \
        skip();                                                                                                        \
    } while (0)
#else
#define SKIP_WHERE_THREADS_ARE_WATCHED() (void)0
#endif
