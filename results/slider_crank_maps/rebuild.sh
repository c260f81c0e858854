#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

# One term: the tongues of the first mode.
run() { ../../tools/study_run.sh "$1" 'map.svg map.png map_boundaries.csv map_grid.csv' map scene.toml --modes 1 --x "$2" --y "$3"; }
run rod_mass rpm=1000:12000:77 rod.mass=0.005:0.06:61
run crank_length rpm=1000:12000:77 crank.length=0.008:0.06:61
