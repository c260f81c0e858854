#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

run=../../tools/study_run.sh
$run sweep 'campbell_rod.svg growth_rod.svg critical.csv unstable_bands.csv' sweep scene.toml --rpm 300:9000:30
$run 3000rpm 'deflection_rod.svg' steady scene.toml --rpm 3000
$run higher_section 'compare_rod.svg' compare scene.toml scene.toml --set-b rod.section.height=10mm --rpm 3000
awk -f decay.awk >decay.csv
$run damping 'fit.svg' fit scene.toml --decay decay.csv
