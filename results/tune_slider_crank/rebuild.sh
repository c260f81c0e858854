#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

rm -rf tuned
hb tune scene.toml --minimise force:rod.0 --vary rod.section.width=0.005:0.014 --vary rod.section.height=0.006:0.024 \
  --keep 'stress<=150' --keep 'stable>=20' --over rpm=6000:12000 --speeds 8 --out tuned >tune.txt
mv tune.txt tuned
rm tuned/*.png tuned/tune.json tuned/plots.gp tuned/campbell_*.csv tuned/map*.csv

# The same by brute force: everywhere coarsely, then finely around the best section that keeps both conditions.
./grid.sh "$(seq -s' ' 5 1.5 14)" "$(seq -s' ' 6 3 24)" >grid_coarse.csv
./grid.sh "$(seq -s' ' 5 0.1 5.3)" "$(seq -s' ' 10 0.2 13)" >grid_fine.csv
for grid in coarse fine; do
  echo "least bearing force of the $grid grid with both conditions kept:"
  head -1 "grid_$grid.csv"
  awk -F, '$6 == 1' "grid_$grid.csv" | sort -t, -g -k3 | head -1
done >grid.txt

# And by time integration.
for rpm in 6000 9000 12000; do
  hb check tuned/tuned.toml --rpm $rpm || (($? == 1)) # 1: a disagreement, which check.txt shows
done >check.txt
