#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

awk -f gas_force.awk >gas_force.csv
../../tools/study_run.sh 9000rpm '*.svg joint_forces.csv response_*.csv torque.csv' steady scene.toml --rpm 9000
