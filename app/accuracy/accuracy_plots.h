// app/accuracy/accuracy_plots.h: a report's plots, as SVG files for light and dark readers.
// Units are in the plots' titles.
// Everything is borrowed; files are written to a folder of the caller.
#pragma once
#include "app/accuracy/accuracy_report.h"

#define ACCURACY_PLOT_BYTES 96

// Whether gnuplot is there. NOT_FOUND; logged.
MUST_USE Result accuracy_check_plots(void);
// plots.gp, with all data, and what it draws. IO, MEMORY, NOT_FOUND: the script; logged.
MUST_USE Result accuracy_write_plots(const Accuracy *accuracy, const char *folder);
// Their names, "pareto-tatra.svg"; those of one DEM one after another, then those of all.
int accuracy_plot_count(const Accuracy *accuracy);
int accuracy_plots_of_dem(void);
const char *accuracy_plot_what(const Accuracy *accuracy, int plot); // in words
void accuracy_plot_name(const Accuracy *accuracy, int plot, char out[ACCURACY_PLOT_BYTES]);

// The DEM's name without its ending, of letters, digits, '-' and '_' only; with a number behind it where two are the
// same.
void accuracy_stem(const Accuracy *accuracy, int dem, char out[64]);
// The tolerance whose frames are shown one by one: the one nearest to a pixel.
int accuracy_tau_shown(const Accuracy *accuracy);
// A whole file; the caller frees the bytes, after which a 0 stands. NOT_FOUND, IO; logged.
MUST_USE Result accuracy_read_file(const char *path, char **bytes, size_t *count);
