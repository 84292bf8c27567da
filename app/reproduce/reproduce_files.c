#define _POSIX_C_SOURCE 200809L
#include "app/reproduce/reproduce_report.h"
#include "base/log.h"
#include "base/paths.h"
#include "terrain/mesh/mesh_file.h"

#include <stdlib.h>

typedef enum Form { FORM_TEXT, FORM_JSON, FORM_CSV } Form;

// `table`: for CSV only.
static Result print_form(const Report *report, const ReportTable *table, Form form, FILE *to) {
    if (form == FORM_JSON)
        return report_write_json(report, to);
    if (form == FORM_TEXT)
        report_write_text(report, to);
    else
        report_write_csv(table, to);
    return RESULT_OK;
}

static Result write_form(const Report *report, const ReportTable *table, Form form, const char *path) {
    char *bytes = NULL;
    size_t count = 0;
    FILE *memory = open_memstream(&bytes, &count);
    Result result = memory ? print_form(report, table, form, memory) : RESULT_MEMORY;
    bool complete = memory && !ferror(memory);
    if (memory && fclose(memory) != 0)
        complete = false;
    if (!memory || (result == RESULT_OK && !complete)) {
        log_error("%s: no memory to write it", path);
        result = RESULT_MEMORY;
    }
    if (result == RESULT_OK)
        result = mesh_file_write(path, bytes, count);
    free(bytes);
    return result;
}

Result report_write_files(const Report *report, const char *folder) {
    char path[PATHS_BYTES_MAX];
    snprintf(path, sizeof path, "%s/%s.md", folder, report->paper);
    Result result = write_form(report, NULL, FORM_TEXT, path);
    snprintf(path, sizeof path, "%s/%s.json", folder, report->paper);
    if (result == RESULT_OK)
        result = write_form(report, NULL, FORM_JSON, path);
    for (int i = 0; i < report->table_count && result == RESULT_OK; i++) {
        snprintf(path, sizeof path, "%s/%s_%s.csv", folder, report->paper, report->tables[i].id);
        result = write_form(report, &report->tables[i], FORM_CSV, path);
    }
    return result;
}
