#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

../../tools/study_run.sh chart 'map.svg map.png map_boundaries.csv' map scene.toml \
  --x hill.stiffness.0.cos.0.0=-5:20:101 --y hill.stiffness.1.cos.0.0=0:20:26
awk -f distance.awk chart/map_boundaries.csv ../../tests/reference/mathieu_characteristic.csv >distance.txt
cat distance.txt
