// app/csv.h: texts as CSV (RFC 4180) wants them.
// No units.
// Everything is borrowed.
#pragma once
#include <stdio.h>

// The text in quotes, with its own quotes doubled; no comma. Whether all was taken, ferror(to) tells.
void csv_put_text(const char *text, FILE *to);
