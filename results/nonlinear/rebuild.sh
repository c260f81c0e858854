#!/usr/bin/env bash
# Motion without linearisation beside the linear theory: the six-link mechanism, the slider-crank of the IVP test set, a
# four-bar.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

run=../../tools/study_run.sh
branches='branches_*.svg branches_*.csv bifurcations.csv'

"$run" six_link "$branches" sweep ../six_link/scene.toml --rpm 1200:1620:20 --modes 1 --theory nonlinear --period 2 \
  --only steady,stability
"$run" six_link_200-1710rpm "$branches" sweep ../six_link/scene.toml --rpm 200:1710:10 --modes 1 --theory nonlinear \
  --only steady,stability --no-search
# Beyond 1718 rpm: from the motion at 1900 rpm, past six folds of the branch.
hb steady ../six_link/scene.toml --rpm 1900 --modes 1 --theory nonlinear --only steady,stability --json >motion_1900rpm.json
"$run" six_link_1720-2400rpm "$branches" sweep ../six_link/scene.toml --rpm 1720:2400:20 --modes 1 --theory nonlinear \
  --only steady,stability --no-search --start motion_1900rpm.json
# Marched over time from several starts, also where no stable motion is known.
march ../six_link/scene.toml 1540 2400 20 >march.txt
march ../six_link/scene.toml 3000 3000 1 >>march.txt
"$run" six_link_1585rpm check.json check ../six_link/scene.toml --rpm 1585 --modes 1 --theory nonlinear --period 2 --tol 1e-7
"$run" slider_crank check.json check slider_crank.toml --omega 150 --theory nonlinear
"$run" four_bar "$branches" sweep ../four_bar/scene.toml --rpm 200:400:10 --modes 1 --theory nonlinear --only steady,stability

# Largest |q_1| and |q_2| of the slider-crank, without linearisation and linear, and the linear answer's theory error.
peaks() {
  hb steady slider_crank.toml --omega "$1" --only steady --theory "$2" |
    awk '$1 == ++k && NF == 3 { printf "%s ", $2; next } { k = 0 } $1 == "theory" { error = $3 } END { printf "%s", error }'
}
for omega in 60 150 212.8; do
  echo "$omega rad/s: nonlinear $(peaks "$omega" nonlinear)linear $(peaks "$omega" linear)"
done >slider_crank.txt
