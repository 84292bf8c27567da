#define _POSIX_C_SOURCE 200809L
#include "app/reproduce/reproduce_report.h"

#include "app/bench/bench.h"
#include "app/csv.h"
#include "base/log.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#define CELL_BYTES 96

static const char *const GROUP_NAMES[REPORT_GROUP_COUNT] = {"", "paper", "ours"};

ReportCell report_number(double value) {
    return (ReportCell){.kind = isfinite(value) ? REPORT_NUMBER : REPORT_NONE, .number = value};
}

ReportCell report_text(const char *text) {
    ReportCell cell = {.kind = REPORT_TEXT};
    snprintf(cell.text, sizeof cell.text, "%s", text);
    return cell;
}

void report_note(ReportNotes *notes, const char *format, ...) {
    if (notes->count == REPORT_NOTES_MAX)
        return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(notes->text[notes->count++], REPORT_NOTE_BYTES, format, arguments);
    va_end(arguments);
}

ReportTable *report_add_table(Report *report, const ReportTable *form) {
    ReportTable *table = &report->tables[report->table_count++];
    *table = *form;
    return table;
}

ReportCell *report_add_row(ReportTable *table) {
    size_t columns = (size_t)table->column_count;
    if (table->row_count == table->row_capacity) {
        int capacity = table->row_capacity ? 2 * table->row_capacity : 8;
        ReportCell *cells = realloc(table->cells, sizeof *cells * columns * (size_t)capacity);
        if (!cells) {
            log_error("%s: no memory for %d rows", table->name, capacity);
            return NULL;
        }
        table->cells = cells;
        table->row_capacity = capacity;
    }
    ReportCell *row = table->cells + columns * (size_t)table->row_count++;
    memset(row, 0, sizeof *row * columns);
    return row;
}

void report_clear(Report *report) {
    for (int i = 0; i < report->table_count; i++)
        free(report->tables[i].cells);
    report->table_count = 0;
}

// ---- Markdown ---------------------------------------------------------------------------------------------------

static const ReportCell *cell_at(const ReportTable *table, int row, int column) {
    return &table->cells[row * table->column_count + column];
}

typedef struct Width {
    int chars;  // of the widest cell
    bool shown; // some row has something
    bool text;
} Width;

static int format_cell(const ReportCell *cell, int decimals, char *out, size_t size) {
    if (cell->kind == REPORT_NUMBER)
        return snprintf(out, size, "%.*f", decimals, cell->number);
    return snprintf(out, size, "%s", cell->kind == REPORT_TEXT ? cell->text : "-");
}

static int format_title(const ReportColumn *column, char *out, size_t size) {
    bool key = column->group == REPORT_KEY;
    return snprintf(out, size, "%s%s%s", GROUP_NAMES[column->group], key ? "" : ": ", column->title);
}

static Width width_of(const ReportTable *table, int column) {
    char text[CELL_BYTES];
    Width width = {.chars = format_title(&table->columns[column], text, sizeof text)};
    for (int row = 0; row < table->row_count; row++) {
        const ReportCell *cell = cell_at(table, row, column);
        int chars = format_cell(cell, table->columns[column].decimals, text, sizeof text);
        width.chars = chars > width.chars ? chars : width.chars;
        width.shown = width.shown || cell->kind != REPORT_NONE;
        width.text = width.text || cell->kind == REPORT_TEXT;
    }
    return width;
}

static void write_padded(const char *text, Width width, FILE *to) {
    fprintf(to, width.text ? " %-*s |" : " %*s |", width.chars, text);
}

static void write_rule(Width width, FILE *to) {
    for (int i = 0; i < width.chars + 1; i++)
        fputc('-', to);
    fputs(width.text ? "-|" : ":|", to);
}

// Columns without a figure in any row are left out.
static void write_rows(const ReportTable *table, const Width *widths, FILE *to) {
    char text[CELL_BYTES];
    for (int row = 0; row < table->row_count; row++) {
        fputc('|', to);
        for (int i = 0; i < table->column_count; i++) {
            format_cell(cell_at(table, row, i), table->columns[i].decimals, text, sizeof text);
            if (widths[i].shown)
                write_padded(text, widths[i], to);
        }
        fputc('\n', to);
    }
}

static void write_table(const ReportTable *table, FILE *to) {
    char title[CELL_BYTES];
    Width widths[REPORT_COLUMNS_MAX];
    fprintf(to, "\n### %s\n\nThe paper's figures: %s.\n\n|", table->name, table->source);
    for (int i = 0; i < table->column_count; i++) {
        widths[i] = width_of(table, i);
        format_title(&table->columns[i], title, sizeof title);
        if (widths[i].shown)
            write_padded(title, widths[i], to);
    }
    fputs("\n|", to);
    for (int i = 0; i < table->column_count; i++)
        if (widths[i].shown)
            write_rule(widths[i], to);
    fputc('\n', to);
    write_rows(table, widths, to);
}

static void write_notes(const ReportNotes *notes, const char *before, FILE *to) {
    for (int i = 0; i < notes->count; i++)
        fprintf(to, "- %s%s.\n", before, notes->text[i]);
}

void report_write_text(const Report *report, FILE *to) {
    BenchMachine machine = bench_machine();
    fprintf(to, "## %s%s\n\n", report->title, report->quick ? " (quick)" : "");
    fprintf(to, "- The paper's machine: %s.\n", report->paper_hardware);
    fprintf(to,
            "- Ours: %s, %d processors, up to %d threads used; %s; compiler %s%s; measured in %.0f s, the machine's "
            "load %.1f before.\n",
            machine.processor, machine.processors, report->threads,
            report->renderer[0] ? report->renderer : "nothing drawn", machine.compiler,
            machine.optimized ? "" : ", not optimized", report->wall_s, report->load);
    write_notes(&report->set_up, "", to);
    write_notes(&report->left_out, "Left out: ", to);
    for (int i = 0; i < report->table_count; i++)
        write_table(&report->tables[i], to);
}

// ---- CSV --------------------------------------------------------------------------------------------------------

static void write_csv_cell(const ReportCell *cell, FILE *to) {
    if (cell->kind == REPORT_NUMBER)
        fprintf(to, "%.17g", cell->number);
    else if (cell->kind == REPORT_TEXT)
        csv_put_text(cell->text, to);
}

void report_write_csv(const ReportTable *table, FILE *to) {
    for (int i = 0; i < table->column_count; i++) {
        const ReportColumn *column = &table->columns[i];
        fprintf(to, "%s%s%s%s", i ? "," : "", GROUP_NAMES[column->group], column->group == REPORT_KEY ? "" : "_",
                column->key);
    }
    fputs("\r\n", to);
    for (int row = 0; row < table->row_count; row++) {
        for (int i = 0; i < table->column_count; i++) {
            if (i)
                fputc(',', to);
            write_csv_cell(cell_at(table, row, i), to);
        }
        fputs("\r\n", to);
    }
}

// ---- JSON -------------------------------------------------------------------------------------------------------

static void add_cell(Json *parent, const char *key, const ReportCell *cell) {
    if (cell->kind == REPORT_TEXT)
        json_add_text(parent, key, cell->text);
    else
        json_add_number(parent, key, cell->kind == REPORT_NUMBER ? cell->number : NAN);
}

static void add_row(Json *rows, const ReportTable *table, int row) {
    Json *objects[REPORT_GROUP_COUNT] = {json_append_object(rows)};
    for (int group = REPORT_PAPER; group < REPORT_GROUP_COUNT; group++)
        objects[group] = json_add_object(objects[REPORT_KEY], GROUP_NAMES[group]);
    for (int i = 0; i < table->column_count; i++)
        add_cell(objects[table->columns[i].group], table->columns[i].key, cell_at(table, row, i));
}

static void add_table(Json *tables, const ReportTable *table) {
    Json *object = json_append_object(tables);
    json_add_text(object, "id", table->id);
    json_add_text(object, "name", table->name);
    json_add_text(object, "source", table->source);
    Json *rows = json_add_array(object, "rows");
    for (int row = 0; row < table->row_count; row++)
        add_row(rows, table, row);
}

static void add_notes(Json *json, const char *name, const ReportNotes *notes) {
    Json *array = json_add_array(json, name);
    for (int i = 0; i < notes->count; i++)
        json_append_text(array, notes->text[i]);
}

static void add_hardware(Json *json, const Report *report) {
    Json *hardware = json_add_object(json, "hardware");
    json_add_text(hardware, "paper", report->paper_hardware);
    Json *ours = json_add_object(hardware, "ours");
    bench_add_machine(ours);
    json_add_integer(ours, "threads", report->threads);
    json_add_number(ours, "load_average", report->load);
    json_add_text(ours, "renderer", report->renderer[0] ? report->renderer : NULL);
}

Result report_write_json(const Report *report, FILE *to) {
    Json *json = json_create();
    json_add_text(json, "paper", report->paper);
    json_add_text(json, "title", report->title);
    add_hardware(json, report);
    json_add_bool(json, "quick", report->quick);
    json_add_number(json, "wall_s", report->wall_s);
    add_notes(json, "set_up", &report->set_up);
    add_notes(json, "left_out", &report->left_out);
    Json *tables = json_add_array(json, "tables");
    for (int i = 0; i < report->table_count; i++)
        add_table(tables, &report->tables[i]);
    Result result = json_write(json, to);
    json_destroy(&json);
    return result;
}
