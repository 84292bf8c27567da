// app/reproduce/reproduce_report.h: tables with a paper's figures beside ours, as Markdown, JSON and CSV.
// Units are in the columns' titles.
// A report owns its tables and notes; column lists are static and borrowed.
#pragma once
#include "base/base.h"

#include <stdio.h>

#define REPORT_TABLES_MAX 8
#define REPORT_COLUMNS_MAX 40
#define REPORT_NOTES_MAX 24
#define REPORT_NOTE_BYTES 320
#define REPORT_TEXT_BYTES 48

typedef enum ReportGroup {
    REPORT_KEY,   // what the row is about: beside "paper" and "ours" in JSON
    REPORT_PAPER, // the paper's figure
    REPORT_OURS,
    REPORT_GROUP_COUNT
} ReportGroup;

typedef struct ReportColumn {
    ReportGroup group;
    const char *key;   // in JSON; in CSV with "paper_" or "ours_" before it
    const char *title; // in Markdown, with the unit
    int decimals;      // in Markdown; JSON and CSV have all digits
} ReportColumn;

typedef enum ReportKind { REPORT_NONE, REPORT_NUMBER, REPORT_TEXT } ReportKind;
typedef struct ReportCell {
    ReportKind kind; // NONE: null in JSON, nothing in CSV, "-" in Markdown
    double number;
    char text[REPORT_TEXT_BYTES];
} ReportCell;

ReportCell report_number(double value); // NONE when not finite
ReportCell report_text(const char *text);

typedef struct ReportTable {
    const char *id;     // "table1": part of the CSV file's name
    const char *name;   // "Table 1: preprocessing"
    const char *source; // where in the paper: "table 1, section 5"
    const ReportColumn *columns;
    int column_count;
    ReportCell *cells; // [row_count][column_count]
    int row_count, row_capacity;
} ReportTable;

typedef struct ReportNotes {
    char text[REPORT_NOTES_MAX][REPORT_NOTE_BYTES];
    int count;
} ReportNotes;

typedef struct Report {
    const char *paper; // "loeffler"
    const char *title, *paper_hardware;
    char renderer[160]; // ""; nothing was drawn
    int threads;
    bool quick;
    double wall_s, load;  // the load average of the minute before
    ReportNotes set_up;   // what ours was run on
    ReportNotes left_out; // of the full experiment
    ReportTable tables[REPORT_TABLES_MAX];
    int table_count;
} Report;

// A sentence without a full stop; what does not fit is cut off.
void report_note(ReportNotes *notes, const char *format, ...) PRINTF_LIKE(2, 3);
// Of at most REPORT_TABLES_MAX.
ReportTable *report_add_table(Report *report, const ReportTable *form);
// A row of empty cells, valid until the next one is added; NULL without memory, said in the log.
ReportCell *report_add_row(ReportTable *table);
void report_clear(Report *report);

// Tables in Markdown, the machines and what was left out before them.
void report_write_text(const Report *report, FILE *to);
void report_write_csv(const ReportTable *table, FILE *to);
MUST_USE Result report_write_json(const Report *report, FILE *to);

// PAPER.md, PAPER.json and PAPER_TABLE.csv for each table, each whole or not at all. IO, MEMORY; logged.
MUST_USE Result report_write_files(const Report *report, const char *folder);
