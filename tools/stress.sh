#!/usr/bin/env bash
# tools/stress.sh [TIMES [SEED]]: the stress tests of the numerics on TIMES as many random systems (default 100: more than
# 10 000 verdicts) from another seed (default: today's date), with one line per family of systems.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/build.sh release test_stress
export HB_STRESS=${1:-100} HB_STRESS_SEED=${2:-$(date +%Y%m%d)}
echo "$HB_STRESS times the systems, seed $HB_STRESS_SEED"
# Of bands a share of few sweeps is asked for, which other seeds miss.
build/release/tests/test_stress --gtest_brief=1 '--gtest_filter=-Random/Bands.*'
