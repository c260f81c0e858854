set terminal svg size 760,620 font 'Helvetica,13' background '#ffffff'
set output 'grid.svg'
set datafile separator ','
set key outside below samplen 2
set title "{/:Bold Lightest rods: brute force and hb tune}\nevery pair of heights computed at every 50 rpm from 300 to 3000"
set xlabel 'height of AB [mm]'
set ylabel 'height of CD [mm]'
set xrange [3.5:31.5]
set yrange [3.5:31.5]
tuned = "<awk '/section.height/ && !v[$1] {v[$1] = $3} END {print v[\"AB.section.height\"] \",\" v[\"CD.section.height\"]}' tuned/tune.txt"
ab = 6.3706e-5 * 1.3608 * 259
cd = 7.0198e-5 * 1.1619 * 258
plot for [m = 3:13] (0.1 * m - ab * x) / cd with lines lc '#cccccc' title (m == 3 ? 'equal mass, steps of 0.1 kg' : ''), \
  'grid_coarse.csv' using 1:($6 == 1 ? $2 : NaN) with points pt 7 ps 0.8 lc '#009e73' title 'keeps both conditions', \
  'grid_coarse.csv' using 1:($6 == 0 ? $2 : NaN) with points pt 6 ps 0.7 lc '#d55e00' title 'does not', \
  'grid_fine.csv' using 1:($6 == 1 ? $2 : NaN) with points pt 7 ps 0.3 lc '#009e73' notitle, \
  'grid_fine.csv' using 1:($6 == 0 ? $2 : NaN) with points pt 6 ps 0.25 lc '#d55e00' notitle, \
  tuned using 1:2 with points pt 2 ps 1.6 lw 2 lc '#000000' title 'hb tune'
