# Draws what bench_convergence and bench_slopes wrote: log-log plots with lines to compare slopes with.
#
#   gnuplot -c bench/convergence.gnuplot CONVERGENCE.csv SLOPES.csv FOLDER
#
# makes FOLDER/convergence-samples.png, convergence-time.png and convergence-slopes.png.

convergence = ARG1
slopes = ARG2
folder = ARG3

set datafile separator comma
set logscale xy
set format y "10^{%L}"
set grid
array kColours[6] = ["#888888", "#d08030", "#b0a0c0", "#2060b0", "#109050", "#c03060"]
array kMethods[6] = ["independent,uniform", "independent,ring", "independent,greedy", \
                     "sobol,uniform", "sobol,ring", "sobol,greedy"]
scenes = system(sprintf("awk -F, 'NR > 1 && !seen[$1]++ { print $1 }' '%s'", convergence))

curve(scene, method) = sprintf("< grep '^%s,%s,' '%s'", scene, method, convergence)

# One panel for each scene, the keys in the last one.
do for [plot_of in "samples time"] {
  x = plot_of eq "samples" ? 5 : 8
  x_name = plot_of eq "samples" ? "samples per pixel" : "seconds of rendering"
  set terminal pngcairo size 1200,800 font "sans,11"
  set output sprintf("%s/convergence-%s.png", folder, plot_of)
  set multiplot layout 2,3
  set key off
  set xlabel x_name
  do for [scene in scenes] {
    set title scene noenhanced
    set ylabel "relMSE"
    # The line of slope -1 through the first point of the first method.
    level = real(system(sprintf("awk -F, '$1 == \"%s\" { print $%d * $6; exit }' '%s'", \
                                scene, x, convergence)))
    plot level / x with lines dashtype 2 linecolor "black", \
         for [m = 1:6] curve(scene, kMethods[m]) using x:6:7 with yerrorlines \
           linecolor rgb kColours[m] linewidth 2 pointtype 7 pointsize 0.6
  }
  unset title; unset xlabel; unset ylabel; unset border; unset tics; unset grid
  set key center center
  set xrange [1:2]; set yrange [1:2]
  plot for [m = 1:6] 0.1 with linespoints title kMethods[m] \
         linecolor rgb kColours[m] linewidth 2 pointtype 7, \
       0.1 with lines dashtype 2 linecolor "black" title "slope -1"
  set border; set tics; set grid
  set autoscale
  unset multiplot
}

set terminal pngcairo size 800,600 font "sans,11"
set output folder . "/convergence-slopes.png"
set key bottom left
set xlabel "samples"
set ylabel "variance of the mean"
of(integrand, sampler, growing) = \
  sprintf("< grep '^%s,%s,%s,' '%s'", integrand, sampler, growing, slopes)
plot of("slanted edge 2-D", "independent", "samples") using 4:5 with linespoints \
       linecolor rgb kColours[1] title "slanted edge, independent", \
     of("slanted edge 2-D", "sobol", "replicates") using 4:5 with linespoints \
       linecolor rgb kColours[2] title "slanted edge, Sobol' replicates of 16", \
     of("slanted edge 2-D", "sobol", "samples") using 4:5 with linespoints \
       linecolor rgb kColours[3] title "slanted edge, one Sobol' replicate", \
     of("smooth 2-D", "sobol", "samples") using 4:5 with linespoints \
       linecolor rgb kColours[4] title "smooth, one Sobol' replicate", \
     0.25 / x with lines dashtype 2 linecolor "black" title "slope -1", \
     0.18 / x**1.5 with lines dashtype 3 linecolor "black" title "slope -1.5", \
     3 / x**3 with lines dashtype 4 linecolor "black" title "slope -3"
