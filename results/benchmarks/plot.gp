# One log-log picture per system and quantity, from error_against_time.csv.
set datafile separator ","
set terminal svg size 720,480 font "sans,12"
set logscale xy
set format xy "10^{%T}"
set xlabel "run time [s]"
set key outside right
set grid
set xrange [1e-6:10]
set yrange [1e-17:10]
systems = system("awk -F, '!/^#/ && NR > 2 && !seen[$1]++ { print $1 }' error_against_time.csv")
do for [quantity in "steady growth"] {
  set ylabel (quantity eq "steady" ? "max |q - q_{ref}| / max |q_{ref}|" : "|growth rate - reference| / max(|reference|, Omega)")
  do for [name in systems] {
    rows = sprintf("awk -F, '$1 == \"%s\" && $3 == \"%s\"' error_against_time.csv", name, quantity)
    methods = system(rows . " | awk -F, '!seen[$4]++ { print $4 }'")
    if (words(methods) == 0) { continue }
    set output sprintf("%s_%s.svg", name, quantity)
    set title sprintf("%s: %s", name, quantity eq "steady" ? "periodic state" : "growth rate") noenhanced
    plot for [method in methods] \
      sprintf("< %s | awk -F, '$4 == \"%s\" { print $9 \",\" ($7 > 1e-17 ? $7 : 1e-17) }'", rows, method) \
      using 1:2 with linespoints title method noenhanced
  }
}

# What propagates a turn best, from propagators.csv.
set ylabel "|growth rate - reference| / max(|reference|, Omega)"
systems = system("awk -F, '!/^#/ && NR > 2 && !seen[$1]++ { print $1 }' propagators.csv")
do for [name in systems] {
  rows = sprintf("awk -F, '$1 == \"%s\"' propagators.csv", name)
  methods = system(rows . " | awk -F, '!seen[$3]++ { print $3 }'")
  set output sprintf("%s_propagators.svg", name)
  set title sprintf("%s: 8, 16, .. equal cells over a turn", name) noenhanced
  plot for [method in methods] \
    sprintf("< %s | awk -F, '$3 == \"%s\" { print $7 \",\" ($5 > 1e-17 ? $5 : 1e-17) }'", rows, method) \
    using 1:2 with linespoints title method noenhanced
}
