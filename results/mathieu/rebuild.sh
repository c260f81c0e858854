#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

for omega in 1 2.05; do
  ../../tools/study_run.sh omega_$omega '*.svg *.csv' steady scene.toml --omega $omega
done
