#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

# Three terms per rod: the tongues of the first modes, and what the next ones change.
run() { ../../tools/study_run.sh "$1" 'map.svg map.png map_boundaries.csv map_grid.csv' map scene.toml --modes 3 --x "$2" --y "$3"; }
run second_moment rpm=200:4000:77 '*.J=20:200:61'
run internal_damping rpm=200:4000:77 '*.damping_internal=1e-5:4e-4:61'
run crank_length rpm=200:4000:77 crank.length=20:65:61
