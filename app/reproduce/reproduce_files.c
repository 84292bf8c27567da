#include "app/reproduce/reproduce_report.h"
#include "app/text_file.h"
#include "base/paths.h"

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
    TextFile file;
    Result result = text_file_begin(path, &file);
    return result == RESULT_OK ? text_file_end(&file, print_form(report, table, form, file.to)) : result;
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
