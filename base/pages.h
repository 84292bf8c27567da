// base/pages.h: memory that the system gives page by page, when it is first touched.
// Bytes.
// Nothing is owned. Any thread.
#pragma once
#include "base/base.h"

#include <stddef.h>

// For zeros just asked for (calloc, mmap) that several threads will read before they write them: makes every page the
// process's own. A page that is read first is one that all share, and parting it later stops every other thread of the
// process for a moment, which may be dearer than all that is reckoned on it.
void pages_own(void *zeros, size_t bytes);
