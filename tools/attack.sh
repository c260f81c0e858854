#!/usr/bin/env bash
# Random attacks on what hb claims, bounded in time.
#   tools/attack.sh exponents [SECONDS [SEED]]   exponents, errors and verdicts against a reference in 113 bits
#   tools/attack.sh sweeps [SECONDS [SEED]]      bands and gaps at several steps against each other and fine grids of verdicts
#   tools/attack.sh faults [ARGUMENT...]         kills, full disks, limits, mutated inputs
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

part=${1:-exponents}
shift || true
case $part in
  exponents)
    seconds=${1:-120} seed=${2:-1}
    [[ -f build/release/CMakeCache.txt ]] || cmake --preset release >/dev/null
    cmake --build --preset release --target attack_exponents >/dev/null
    program=build/release/tools/attack/attack_exponents
    # Half of the time all exponents, a quarter each the leading ones and propagation alone.
    failed=0
    "$program" --cases 1000000 --seconds $((seconds / 2)) --seed "$seed" || failed=1
    "$program" --cases 1000000 --seconds $((seconds / 4)) --seed "$((seed + 1))" --leading || failed=1
    "$program" --cases 1000000 --seconds $((seconds / 4)) --seed "$((seed + 2))" --method propagation || failed=1
    exit "$failed"
    ;;
  sweeps)
    seconds=${1:-120} seed=${2:-1}
    [[ -f build/release/CMakeCache.txt ]] || cmake --preset release >/dev/null
    cmake --build --preset release --target test_stress >/dev/null
    failed=0
    # Seed after seed; what the time cuts off is not counted.
    SECONDS=0
    for ((; SECONDS < seconds; seed++)); do
      echo "seed $seed"
      status=0
      HB_STRESS_SEED=$seed timeout "$((seconds - SECONDS))" build/release/tests/test_stress --gtest_filter='*Bands*' |
        grep -E 'sweeps,|points:' || status=${PIPESTATUS[0]}
      [[ $status == 0 || $status == 124 ]] || failed=1
    done
    exit "$failed"
    ;;
  faults)
    exec tools/attack/faults.sh "$@"
    ;;
  *)
    echo "tools/attack.sh: found $part, allowed: exponents, sweeps, faults" >&2
    exit 2
    ;;
esac
