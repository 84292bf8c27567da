#include "app/reproduce/reproduce_figures.h"

#include <string.h>

// Section 5.
const FiguresPaper figures_loeffler = {
    "Loeffler, Schwanke, Schumann 2010: A Hybrid Approach for High Quality Real-Time Terrain Rendering and Optimized "
    "A-Priori Error Estimation",
    "quad-core CPU at 2.83 GHz with GeForce GTX 280; single-core Pentium 4 at 3 GHz"};
// Section 5.
const FiguresPaper figures_biedermann = {
    "Biedermann, Rivara: Uncoupled Parallel View Dependant Level of Detail Rendering of Bintree Triangulations",
    "dual Turion64 at 1.6 GHz, 1 GB RAM, NVIDIA GeForce 6100, Windows XP"};
// Section 9.
const FiguresPaper figures_yalcin = {
    "Yalcin, Weiss, De Floriani 2011: GPU Algorithms for Diamond-based Multiresolution Terrain Processing",
    "NVIDIA GeForce GTX 260 (216 shader cores, 877 MB GDDR3), OpenCL 1.0 and OpenGL 3.3, Windows 7"};
// Section 4.
const FiguresPaper figures_ye = {"Ye, Wang: View-dependent Real-time Terrain Rendering Using Static LOD",
                                 "x86 Family Model 8, 261616 KB RAM, NVIDIA TNT2, 1024x768x16"};

// Table 1, section 5.
static const FiguresPreprocess preprocess[] = {
    {1025, 1.43, 0.28, 0.58, 0.05},
    {2049, 5.17, 1.18, 2.27, 0.20},
    {4097, 20.03, 4.71, 9.18, 0.76},
    {8193, 65.3, 16.9, 36.8, 3.18},
};

// Table 2, section 5.
static const FiguresHybrid hybrid[] = {
    {1025, 0.5, 284, 1082e3, 299, 947e3}, {1025, 1.0, 286, 1079e3, 427, 472e3}, {1025, 2.0, 291, 1037e3, 570, 175e3},
    {2049, 0.5, 143, 2732e3, 172, 665e3}, {2049, 1.0, 191, 1885e3, 343, 343e3}, {2049, 2.0, 261, 1223e3, 566, 147e3},
    {4097, 0.5, 82, 4642e3, 113, 758e3},  {4097, 1.0, 121, 3001e3, 274, 339e3}, {4097, 2.0, 212, 1522e3, 497, 136e3},
};

// Table 1, section 5.
const FiguresUncoupled figures_uncoupled[FIGURES_UNCOUPLED_COUNT] = {
    {180000, 17.03, 23.78, 39.64}, {160000, 17.42, 25.31, 45.29}, {140000, 20.22, 33.10, 63.70},
    {120000, 21.05, 35.71, 69.64}, {100000, 23.61, 39.85, 68.78}, {80000, 28.60, 44.57, 55.84},
    {60000, 39.42, 57.35, 45.48},  {40000, 52.19, 68.16, 30.60},  {20000, 71.04, 73.06, 2.84},
    {5000, 81.03, 81.18, 0.19},
};

// Table 1, section 9.
static const FiguresDiamond diamond[] = {
    {513, 260, 62.16, 0.46, 0.07, 2.27, 0.90, 0.17, 1.14, 150, 780},
    {1025, 1118, 249.1, 1.81, 0.19, 6.02, 1.17, 0.52, 1.89, 95, 220},
    {2049, 4615, 999.7, 7.12, 0.63, 20.41, 1.82, 2.16, 4.60, 41, 62},
    {4097, 20401, 3997, 33.41, 12.39, 76.1, 3.41, 51.72, 67.52, 5, 10},
};

// Section 4: no table; "30000-odd and 20000-odd triangles respectively, reaching frame rates of approximately 25fps and
// 30fps", "ROAM produces constantly 10000 triangles", "near 27fps".
static const FiguresStatic statics[] = {{"geomipmap", 30000, 25}, {"geomipmap-ye", 20000, 30}, {"roam", 10000, 27}};

const FiguresPreprocess *figures_preprocess(int side) {
    for (size_t i = 0; i < COUNT_OF(preprocess); i++)
        if (preprocess[i].side == side)
            return &preprocess[i];
    return NULL;
}

const FiguresHybrid *figures_hybrid(int side, double tau_px) {
    for (size_t i = 0; i < COUNT_OF(hybrid); i++)
        if (hybrid[i].side == side && hybrid[i].tau_px == tau_px)
            return &hybrid[i];
    return NULL;
}

const FiguresDiamond *figures_diamond(int side) {
    for (size_t i = 0; i < COUNT_OF(diamond); i++)
        if (diamond[i].side == side)
            return &diamond[i];
    return NULL;
}

const FiguresStatic *figures_static(const char *method) {
    for (size_t i = 0; i < COUNT_OF(statics); i++)
        if (strcmp(statics[i].method, method) == 0)
            return &statics[i];
    return NULL;
}
