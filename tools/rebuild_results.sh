#!/usr/bin/env bash
# tools/rebuild_results.sh [STUDY...]: builds, then computes the studies in results/ anew (default: all of them).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/setup.sh
tools/build.sh release hb_command table_1 march
export PATH="$PWD/build/release/bin:$PATH"

studies=("$@")
((${#studies[@]})) || mapfile -t studies < <(cd results && ls -d */ | tr -d /)
for study in "${studies[@]}"; do
  echo "results/$study" >&2
  "results/$study/rebuild.sh" </dev/null
done
