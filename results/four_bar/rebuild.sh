#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

../../tools/study_run.sh 300rpm '*.svg joint_forces.csv response_*.csv torque.csv' steady scene.toml --rpm 300
