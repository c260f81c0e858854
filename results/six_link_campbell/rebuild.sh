#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

../../tools/study_run.sh 200-6000rpm \
  'campbell_*.svg campbell_*.png growth_*.svg growth_*.png peaks_*.svg peaks_*.png critical.csv unstable_bands.csv' \
  sweep scene.toml --rpm 200:6000:20
