#!/usr/bin/env bash
# Cost of a crowd against its number, as a picture. Usage: tests/bench/crowd_scaling.sh BUILD OUT.png
# Processor time of one thread per frame of 1/60 s; crowd_bench says what is in a frame.
set -euo pipefail
build=$1 picture=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$build/tests/bench/crowd_bench" --benchmark_filter='population_frame/.*1_thread' --benchmark_format=csv \
  2>/dev/null >"$work/all.csv"
for series in hit_1_thread undisturbed_1_thread; do
  # name, iterations, real_time, cpu_time (ns), …
  sed -n "s|^\"population_frame/$series/\([0-9]*\)/[^\"]*\",[0-9]*,[^,]*,\([^,]*\),.*|\1 \2|p" "$work/all.csv" >"$work/$series"
done
gnuplot <<PLOT
set terminal pngcairo size 900,560 font "Inter,13" linewidth 1.5
set output "$picture"
set logscale xy
set xlabel "characters"
set ylabel "ms per frame, one thread"
set key top left
set grid
set title "A frame of a crowd: sampling, check, model poses; and with 5 % hit every second"
plot "$work/undisturbed_1_thread" using 1:(\$2/1e6) with linespoints pt 7 lc rgb "#0072b2" title "undisturbed", \
     "$work/hit_1_thread" using 1:(\$2/1e6) with linespoints pt 7 lc rgb "#d55e00" title "5 % hit every second", \
     [100:1e5] x*3e-4 with lines dt 2 lc rgb "#888888" title "300 ns per character"
PLOT
cat "$work/hit_1_thread" "$work/undisturbed_1_thread"
