#!/usr/bin/env bash
# The theory error of the six-link mechanism along the speed beside the true change; a thick connecting rod with and
# without shear, and what shear does to its frequencies.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
../../tools/build.sh release hb_command >/dev/null
hb="$PWD/../../build/release/bin/hb"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Six-link: indicator every 10 rpm, true change where a motion without linearisation was found.
"$hb" sweep ../six_link/scene.toml --rpm 200:2400:10 --modes 1 --only steady --no-plots --out "$work/sweep" >/dev/null
for rod in AB CD; do grep -v "^#" "$work/sweep/sweep_$rod.csv" >"indicator_$rod.csv"; done
# Beyond 1718 rpm the branch from low speed has turned back: no motion of one turn is known there.
for rpm in 200 250 300 400 500 600 700 800 900 1000 1100 1200 1300 1400 1450 1480 1500 1550 1600 1650 1700; do
  for theory in linear nonlinear; do
    "$hb" steady ../six_link/scene.toml --rpm $rpm --modes 1 --only steady --theory $theory --json \
      >"$work/${theory}_$rpm.json"
  done
done
python3 true_change.py "$work" >true_change.csv

# The connecting rod of a two-stroke engine, with the shear of steel (G = 79.3 GPa) and without.
scene="$work/thick_rod.toml"
sed "s/damping_internal = 1e-6/damping_internal = 1e-6, shear = { G = 79.3e9, k = 0.45 }/" ../slider_crank/scene.toml \
  >"$scene"
cp ../slider_crank/gas_force.csv "$work"
for k in 0.45 0.8333333333333334; do
  "$hb" steady "$scene" --set rod.shear.k=$k --rpm 9000 --modes 5 --json >"$work/shear_$k.json"
  "$hb" scene "$scene" --set rod.shear.k=$k --json >"$work/scene_$k.json"
done
"$hb" steady ../slider_crank/scene.toml --rpm 9000 --modes 5 --json >"$work/shear_none.json"
python3 thick_rod.py "$work" >thick_rod.csv
# Campbell: frequencies of the running rod, from 1000 to 9000 rpm.
"$hb" sweep ../slider_crank/scene.toml --rpm 1000:9000:400 --modes 5 --no-plots --out "$work/none" >/dev/null
"$hb" sweep "$scene" --rpm 1000:9000:400 --modes 5 --no-plots --out "$work/with" >/dev/null
grep -v "^#" "$work/none/sweep_rod.csv" >campbell_without_shear.csv
grep -v "^#" "$work/with/sweep_rod.csv" >campbell_with_shear.csv
gnuplot plot.gp
