#!/usr/bin/env bash
# tools/stress.sh [TIMES [SEED]]: the stress tests of the numerics on TIMES as many random systems (default 100: more than
# 10 000 verdicts) from another seed (default: today's date), with one line per family of systems.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/build.sh release test_stress_stability test_stress_steady test_stress_boundaries
export HB_STRESS=${1:-100} HB_STRESS_SEED=${2:-$(date +%Y%m%d)}
echo "$HB_STRESS times the systems, seed $HB_STRESS_SEED"
status=0
for test in stability steady boundaries; do
  "build/release/tests/test_stress_$test" --gtest_brief=1 || status=1
done
exit $status
