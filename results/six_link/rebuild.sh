#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

../../tools/study_run.sh 300rpm '*.svg *.csv' steady scene.toml --rpm 300
for rpm in 1500 2400 3000; do
  ../../tools/study_run.sh ${rpm}rpm 'forces_*.svg response_*.svg torque.svg joint_forces.csv' steady scene.toml --rpm $rpm
done
