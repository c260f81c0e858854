#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

rm -rf tuned
hb tune scene.toml --minimise mass --vary AB.section.height=5:30 --vary CD.section.height=5:30 \
  --keep 'stable>=5' --keep 'deflection<=2' --over rpm=300:3000 --speeds 12 --out tuned >tune.txt
mv tune.txt tuned
rm tuned/*.png tuned/tune.json tuned/plots.gp tuned/campbell_*.csv tuned/map*.csv

# The same by brute force: everywhere coarsely, then finely around the lightest design that keeps both conditions.
./grid.sh "$(seq -s' ' 5 5 30)" "$(seq -s' ' 5 5 30)" >grid_coarse.csv
./grid.sh "$(seq -s' ' 19.6 0.1 20.6)" "$(seq -s' ' 18.4 0.1 19.4)" >grid_fine.csv
for grid in coarse fine; do
  echo "lightest design of the $grid grid that keeps both conditions:"
  head -1 "grid_$grid.csv"
  awk -F, '$6 == 1' "grid_$grid.csv" | sort -t, -g -k3 | head -1
done >grid.txt
gnuplot grid.gp

# And by time integration, at speeds of both ends and where the tuned design bends most.
for rpm in 300 1500 3000; do
  hb check tuned/tuned.toml --rpm $rpm || (($? == 1)) # 1: a disagreement, which check.txt shows
done >check.txt
