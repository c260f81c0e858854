# theory_error.svg, shear.svg from the tables beside; PNG of both with `gnuplot -e png=1 plot.gp` for looking at.
set datafile separator ','
set datafile missing '-'
if (exists('png')) set terminal pngcairo size 1000,640 font 'sans,11'; else set terminal svg size 800,520 font 'sans,12' background 'white'
suffix = exists('png') ? '.png' : '.svg'
set key top left Left reverse
set grid

set output 'theory_error'.suffix
set title 'Six-link mechanism, one mode: first nonlinear correction (lines) and true change (points) of q'
set xlabel 'rpm'
without = 14  # column of the frequency of mode i: without + 2 i
set ylabel 'change / max |q|'
set logscale y
set format y '10^{%L}'
set xrange [200:2400]
set yrange [1e-6:1e3]
set arrow 1 from 200,0.05 to 2400,0.05 nohead dashtype 2 linecolor rgb '#999999'
set label 1 'beyond the linear theory: 0.05' at 2380,0.075 right textcolor rgb '#666666'
plot 'indicator_AB.csv' using 1:5 skip 1 with lines linecolor rgb '#0072B2' linewidth 1.5 title 'AB', \
     'indicator_CD.csv' using 1:5 skip 1 with lines linecolor rgb '#D55E00' linewidth 1.5 title 'CD', \
     'true_change.csv' using 1:3 skip 2 with points pointtype 7 pointsize 0.8 linecolor rgb '#0072B2' title 'AB, true', \
     'true_change.csv' using 1:5 skip 2 with points pointtype 5 pointsize 0.8 linecolor rgb '#D55E00' title 'CD, true'
unset arrow 1
unset label 1
unset logscale y
set format y '%g'

set output 'shear'.suffix
set title 'Two-stroke connecting rod: frequencies without shear (dashed) and with it (k = 0.45)'
set ylabel 'frequency [kHz]'
set xrange [1000:9000]
set yrange [0:*]
set key off
plot for [i=1:5] 'campbell_without_shear.csv' using 1:(column(without + 2*i)/1000) skip 1 with lines dashtype 2 linecolor rgb '#666666', \
     for [i=1:5] 'campbell_with_shear.csv' using 1:(column(without + 2*i)/1000) skip 1 with lines linecolor rgb '#0072B2' linewidth 1.5
