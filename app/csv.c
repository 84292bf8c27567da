#include "app/csv.h"

void csv_put_text(const char *text, FILE *to) {
    fputc('"', to);
    for (; *text; text++)
        fprintf(to, *text == '"' ? "\"\"" : "%c", *text);
    fputc('"', to);
}
