#!/usr/bin/env bash
# tools/build.sh PRESET [TARGET...]: configures and builds a preset of CMakePresets.json (default: all targets) with as
# many jobs as cores and memory allow.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=$1
shift
targets=()
for target in "$@"; do targets+=(--target "$target"); done

# A compiler job on Eigen templates takes up to about 1.5 GB.
memory_jobs=$(awk '/^MemAvailable:/ { print int($2 / 1572864) }' /proc/meminfo)
jobs=$(nproc)
((memory_jobs < jobs)) && jobs=$memory_jobs
((jobs < 1)) && jobs=1

cmake --preset "$preset" </dev/null
cmake --build --preset "$preset" --parallel "$jobs" "${targets[@]}" </dev/null
