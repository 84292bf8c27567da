// app/version.h: which version this is.
// No units.
// Static text; any thread.
#pragma once

const char *version_text(void); // "1.2.3"
