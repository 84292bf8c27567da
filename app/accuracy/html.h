// app/accuracy/html.h: the few parts of HTML that a report is made of, escaped and well-formed.
// No units.
// Writes to a FILE of the caller, whose errors show in ferror; owns nothing.
#pragma once
#include "base/base.h"

#include <stdio.h>

void html_text(const char *text, FILE *to);                            // with &, <, > and " escaped
void html_format(FILE *to, const char *format, ...) PRINTF_LIKE(2, 3); // the same of what is printed
// <TAG>text</TAG>
void html_element(const char *tag, const char *text, FILE *to);

// A table whose columns can be sorted; rows of cells follow, then html_end_table. A title that begins with '<' is of a
// column of texts, without it.
void html_begin_table(const char *const *titles, int count, FILE *to);
void html_begin_row(FILE *to);
void html_cell_text(const char *text, const char *css_class, FILE *to); // css_class: more of them, or ""
void html_cell_number(double value, int decimals, FILE *to);            // an en dash for what is not finite
void html_end_row(FILE *to);
void html_end_table(FILE *to);

// <figure class="CLASS"> with the bytes of a picture in the document itself. `type`: "image/png"
typedef struct HtmlPicture {
    const char *type, *name, *css_class, *caption; // name: alt text
    const unsigned char *bytes;
    size_t count;
} HtmlPicture;
void html_picture(const HtmlPicture *picture, FILE *to);
