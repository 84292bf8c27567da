// app/reproduce/reproduce_figures.h: what the papers measured, to stand beside ours.
// Units as named; sides in samples.
// Constant tables, each with the table and section of its paper.
#pragma once
#include "base/base.h"

// Which machine a paper's figures are from, in its own words.
typedef struct FiguresPaper {
    const char *title, *hardware;
} FiguresPaper;
extern const FiguresPaper figures_loeffler, figures_biedermann, figures_yalcin, figures_ye;

// Loeffler, Schwanke, Schumann 2010, table 1: preprocessing, recursive and parallel scheme on two machines.
typedef struct FiguresPreprocess {
    int side; // 2^n + 1; the paper says 1k, 2k, 4k, 8k
    double single_recursive_s, single_parallel_s, quad_recursive_s, quad_parallel_s;
} FiguresPreprocess;
const FiguresPreprocess *figures_preprocess(int side); // NULL: not in the table

// Table 2: frames a second and triangles a frame of static patches and of the hybrid method.
typedef struct FiguresHybrid {
    int side;
    double tau_px, patch_fps, patch_triangles, hybrid_fps, hybrid_triangles;
} FiguresHybrid;
const FiguresHybrid *figures_hybrid(int side, double tau_px);

// Biedermann, Rivara, table 1: serial and parallel tessellation by vertices a frame.
typedef struct FiguresUncoupled {
    int vertices;
    double serial_fps, parallel_fps, increase_percent;
} FiguresUncoupled;
#define FIGURES_UNCOUPLED_COUNT 10
extern const FiguresUncoupled figures_uncoupled[FIGURES_UNCOUPLED_COUNT];

// Yalcin, Weiss, De Floriani 2011, table 1.
typedef struct FiguresDiamond {
    int side;
    double generation_ms, generation_root_ms, generation_deepest_ms, evaluation_ms, closure_max_ms, closure_ms;
    double indices_ms, dynamic_ms, dynamic_fps, static_fps;
} FiguresDiamond;
const FiguresDiamond *figures_diamond(int side);

// Ye, Wang, section 4; "30000-odd" and "approximately 25" in its words.
typedef struct FiguresStatic {
    const char *method; // ours that stands for it
    double triangles, fps;
} FiguresStatic;
const FiguresStatic *figures_static(const char *method);
