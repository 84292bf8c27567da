# The plots of a report of `overfly bench`. The data, and what is named in capitals here, stand before this text:
# DEMS, VARIANTS, TAUS, TARGETS, BOUNDS, METHODS, SIZES, FLIGHTS, FRAMES, TAU_SHOWN, SOFTWARE, NAME[], KIND[], DEM[],
# STEM[], TAU[], TARGET[], BOUND[], METHOD[], SIZE[], FLIGHT[], and the blocks
# $runs, $front, $track, $times, $equal, $sizes, $workers, whose parts follow one another with two empty lines between.
# To plot them again: gnuplot plots.gp
INK = "#123456"  # the colour of text and axes: a style sheet in each picture turns it into what the reader's theme asks
GRID = "#654321" # the same of the grid
array COLOUR[12] = ["#2c7fd4", "#d9652b", "#2a9d64", "#b3478c", "#9a7b1f", "#7059c9", "#c93c4b", "#2f9fae", \
                    "#7a8a2a", "#a6635c", "#5f7d96", "#8c8c8c"]
colour(v) = COLOUR[(v - 1) % 12 + 1]
point(v) = v % 7 == 1 ? 7 : v % 7 == 2 ? 5 : v % 7 == 3 ? 9 : v % 7 == 4 ? 13 : v % 7 == 5 ? 11 : v % 7 == 6 ? 15 : 6
dash(v) = KIND[v] > 0 ? 2 : 1
SLOW = SOFTWARE ? "frame time, ms, by a software renderer" : "frame time, ms"

# Logarithmic axes with a label at 1, 2, 3, 5 and 7 of each decade; and linear ones again.
LOG_X = 'set logscale x; set xtics norotate center (1 1); do for [e=-3:4] { do for [m in "1 2 3 5 7"] \
{ set xtics add (gprintf("%g", m*10.0**e) m*10.0**e) } }'
LOG_Y = 'set logscale y; set ytics (1 1); do for [e=-4:7] { do for [m in "1 2 3 5 7"] \
{ set ytics add (gprintf(e < 3 ? "%g" : "%.0s%c", m*10.0**e) m*10.0**e) } }'
TAU_X = 'set logscale x; set xtics norotate center (1 1); do for [t=1:TAUS] { set xtics add (sprintf("%g", TAU[t]) TAU[t]) }'
LINEAR = 'unset logscale; set xtics norotate center autofreq; set ytics autofreq'

set terminal svg size 820,500 dynamic font "sans-serif,13" rounded noenhanced
set border 3 lc rgb INK lw 1
set tics nomirror textcolor rgb INK
set grid lc rgb GRID lt 1 lw 0.5
set key textcolor rgb INK outside right top Left reverse samplen 2 spacing 1.15
set autoscale noextend
set offsets graph 0.04, graph 0.04, graph 0.06, graph 0.04
set pointsize 0.6
set bars 0.4
set xlabel "x" textcolor rgb INK
set ylabel "y" textcolor rgb INK
set title "" textcolor rgb INK

do for [d=1:DEMS] {
    at(v) = (d - 1) * VARIANTS + v - 1

    # Measured error against frame time: each method a line over its tolerances.
    set output "pareto-".STEM[d].".svg"
    set title DEM[d].": what accuracy costs (towards the lower left is better)"
    eval LOG_X
    eval LOG_Y
    set xlabel "measured error, px: the largest of all samples and frames"
    set ylabel SLOW
    plot $front index d-1 using 1:2 with lines lc rgb "#b09060" lw 7 title "Pareto front", \
        for [v=1:VARIANTS] $runs index at(v) using 3:4:5:6 with yerrorlines lc rgb colour(v) dt dash(v) pt point(v) \
        lw 1.5 title NAME[v]

    # Without drawing, where a software renderer would hide the difference.
    set output "refine-".STEM[d].".svg"
    set title DEM[d].": what accuracy costs in refinement alone"
    set ylabel "select and refine, ms, median"
    plot for [v=1:VARIANTS] $runs index at(v) using 3:8:9:10 with yerrorlines lc rgb colour(v) dt dash(v) pt point(v) \
        lw 1.5 title NAME[v]

    set output "claimed-".STEM[d].".svg"
    set title DEM[d].": claimed against measured"
    eval TAU_X
    set xlabel "claimed error, px: the tolerance, or what the budget left of it"
    set ylabel "measured error, px: the largest of all samples and frames"
    plot x with lines lc rgb INK dt 3 lw 1 title "claimed = measured", for [v=1:VARIANTS] $runs index at(v) \
        using 2:3 with linespoints lc rgb colour(v) dt dash(v) pt point(v) lw 1.5 title NAME[v]

    set output "triangles-".STEM[d].".svg"
    set title DEM[d].": triangles against the tolerance"
    set xlabel "tolerance, px"
    set ylabel "triangles a frame, mean"
    plot for [v=1:VARIANTS] $runs index at(v) using 1:7 with linespoints lc rgb colour(v) dt dash(v) pt point(v) \
        lw 1.5 title NAME[v]

    eval LOG_X
    set output "bound-".STEM[d].".svg"
    set title DEM[d].": the price of a true bound (kinds of --error)"
    set xlabel "measured error, px: the largest of all samples and frames"
    if (BOUNDS > 0) {
        plot for [k=1:BOUNDS] $runs index at(BOUND[k]) using 3:7 with linespoints lc rgb colour(k) dt k pt point(k) \
            lw 1.5 title NAME[BOUND[k]]
    } else {
        plot [1:10] [1:10] 0.5 with lines title "no method with nested errors"
    }
    eval LINEAR

    set terminal svg size 820,640 dynamic font "sans-serif,13" rounded noenhanced
    set output "track-".STEM[d].".svg"
    set multiplot layout 2,1
    set title DEM[d].sprintf(": along the flights, tau %g px", TAU_SHOWN)
    set xlabel ""
    set ylabel "measured error, px"
    set xtics norotate center ("" 0)
    do for [f=1:FLIGHTS] { set xtics add (FLIGHT[f] (f - 0.5) * FRAMES) }
    do for [f=1:FLIGHTS-1] { set arrow f from f * FRAMES - 0.5, graph 0 to f * FRAMES - 0.5, graph 1 nohead lc rgb INK lw 0.5 }
    eval LOG_Y
    plot for [v=1:VARIANTS] $track index at(v) using 1:2 with lines lc rgb colour(v) dt dash(v) lw 1.2 \
        title NAME[v]
    set title ""
    set xlabel sprintf("flight, %d frames each", FRAMES)
    set ylabel SLOW
    unset logscale
    set ytics autofreq
    plot for [v=1:VARIANTS] $track index at(v) using 1:3 with lines lc rgb colour(v) dt dash(v) lw 1.2 \
        title NAME[v]
    unset multiplot
    unset arrow
    eval LINEAR
    set terminal svg size 820,500 dynamic font "sans-serif,13" rounded noenhanced

    set output "times-".STEM[d].".svg"
    set title DEM[d].sprintf(": distribution of frame times, tau %g px, all rounds", TAU_SHOWN)
    set xlabel SLOW
    set ylabel "share of the frames that take at most so long"
    set yrange [0:1.02]
    plot for [v=1:VARIANTS] $times index at(v) using 1:2 with steps lc rgb colour(v) dt dash(v) lw 1.5 title NAME[v]
    set yrange [*:*]

    # Bars of each method, one for each measured error that is asked for; none where its line does not reach it.
    set output "equal-".STEM[d].".svg"
    set title DEM[d].": time at equal measured error"
    set xlabel ""
    set ylabel SLOW
    set xtics rotate by -28 left ("" 0)
    do for [v=1:VARIANTS] { set xtics add (NAME[v] v) }
    set xrange [0.4:VARIANTS+0.6]
    set yrange [0:*]
    set boxwidth 0.7/TARGETS
    plot 0 with lines lc rgb INK lw 0.5 notitle, for [t=1:TARGETS] $equal index (d-1)*TARGETS+t-1 using ($1+(t-(TARGETS+1)/2.0)*0.8/TARGETS):2 with boxes \
        fs solid 0.85 noborder lc rgb colour(t) title sprintf("%g px", TARGET[t]), \
        for [t=1:TARGETS] $equal index (d-1)*TARGETS+t-1 using ($1+(t-(TARGETS+1)/2.0)*0.8/TARGETS):2:3:4 \
        with yerrorbars lc rgb INK lw 1 pt 0 notitle
    eval LINEAR
    set xrange [*:*]
    set yrange [*:*]
}

set output "preprocessing.svg"
set title "building the errors: rough ground"
set xlabel "samples a side"
set ylabel "ms, median"
eval LOG_X
eval LOG_Y
set xtics (1 1)
do for [k=1:14] { set xtics add (sprintf("%d", 2**k + 1) 2**k + 1) }
plot for [k=1:SIZES] $sizes index k-1 using 1:2:3:4 with yerrorlines lc rgb colour(k) pt point(k) lw 1.5 title SIZE[k]
eval LINEAR

set output "workers.svg"
set title "gain by workers: refinement from scratch over ".DEM[1].", building errors over rough ground"
set xlabel "workers"
set ylabel "times as fast as one"
set xtics 1
set key inside left top
set offsets 0, 0, 0, 0
set yrange [0:*]
plot x with lines lc rgb INK dt 3 lw 1 title "ideal", for [m=1:METHODS] $workers index m-1 using 1:2:3:4 \
    with yerrorlines lc rgb colour(m) pt point(m) lw 1.5 title METHOD[m]
