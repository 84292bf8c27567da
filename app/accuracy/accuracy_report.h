// app/accuracy/accuracy_report.h: what was found, for people and for programs.
// As app/accuracy/accuracy.h.
// Everything is borrowed; what is written is of the caller.
#pragma once
#include "app/accuracy/accuracy.h"
#include "app/json.h"
#include "base/base.h"
#include "base/paths.h"

#include <stdio.h>

#define ACCURACY_TEXT_BYTES 2048

// One or two sentences: whether what was promised was kept.
void accuracy_verdict(const Accuracy *accuracy, char out[ACCURACY_TEXT_BYTES]);
// Why a run is condemned, or "".
void accuracy_fault(const Accuracy *accuracy, const AccuracyRun *run, char out[ACCURACY_TEXT_BYTES]);

// A table of all runs, and the verdict.
void accuracy_write_text(const Accuracy *accuracy, FILE *to);
// The document of `bench --json`, which is summary.json as well. The caller destroys it; NULL without memory.
Json *accuracy_make_json(const Accuracy *accuracy);
// A line a frame; the columns before select_ms are the same whenever the same is run.
void accuracy_write_frames(const Accuracy *accuracy, FILE *to);
// A line a run; the same of its columns.
void accuracy_write_summary(const Accuracy *accuracy, FILE *to);

// All of the report: report.html, frames.csv, summary.csv, summary.json, flights, plots and pictures. The folder is
// made. IO, MEMORY, NOT_FOUND: gnuplot or the report's own parts; logged.
MUST_USE Result accuracy_write_report(const Accuracy *accuracy, const char *folder);
// Before anything slow is done: whether that can be done.
MUST_USE Result accuracy_check_report(const Options *options, const char *folder);
