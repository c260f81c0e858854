#!/usr/bin/env bash
# tools/rebuild_results.sh [STUDY...]: builds, then computes the studies in results/ anew (default: all but the attack,
# which takes an hour, and the benchmarks and run times, which want a quiet machine).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/setup.sh
tools/build.sh release hb_command hb_python table_1 march
export PATH="$PWD/build/release/bin:$PATH"

studies=("$@")
((${#studies[@]})) || mapfile -t studies < <(cd results && ls -d */ | tr -d / | grep -vx -e attack -e benchmarks -e run_time)
for study in "${studies[@]}"; do
  echo "results/$study" >&2
  "results/$study/rebuild.sh" </dev/null
done
