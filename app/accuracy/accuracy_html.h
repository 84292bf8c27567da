// app/accuracy/accuracy_html.h: a report as one page of HTML, with its styles, script and pictures in it.
// Units are in the columns' titles.
// Everything is borrowed.
#pragma once
#include "app/accuracy/accuracy_report.h"

// The pictures are read from the folder, where they were written before. IO, NOT_FOUND: a part is missing; logged.
// Whether all was taken, ferror(to) tells.
MUST_USE Result accuracy_write_html(const Accuracy *accuracy, const char *folder, FILE *to);
