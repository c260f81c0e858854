#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

../../tools/study_run.sh sweep 'campbell_rod.svg growth_rod.svg critical.csv unstable_bands.csv' sweep scene.toml --rpm 300:9000:30
../../tools/study_run.sh 3000rpm 'deflection_rod.svg' steady scene.toml --rpm 3000
