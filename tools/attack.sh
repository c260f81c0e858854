#!/usr/bin/env bash
# Random attacks on what hb claims, bounded in time. Exit status 1: something did not hold, and the case is named.
#   tools/attack.sh exponents [SECONDS [SEED]]   exponents, errors and verdicts against a reference in 113 bits
#   tools/attack.sh sweeps [SECONDS [SEED]]      bands and gaps of sweeps at random steps against single verdicts
#   tools/attack.sh maps [SECONDS [SEED]]        points and boundary curves of maps against single verdicts
#   tools/attack.sh one_mode [SECONDS [SEED]]    the same of maps of one mode, growth rates too
#   tools/attack.sh linkages [SECONDS [SEED]]    random linkages against a Newton-Euler model, growth rates three ways
#   tools/attack.sh all [SECONDS [SEED]]         these five, a fifth of the time each
#   tools/attack.sh faults [ARGUMENT...]         kills, full disks, limits, mutated inputs
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# One program for so many seconds: run NAME SECONDS SEED [FLAG...].
run() {
  local name=$1 seconds=$2 seed=$3
  shift 3
  build/release/tools/attack/attack_"$name" --cases 1000000 --seconds "$seconds" --seed "$seed" "$@" || failed=1
}

exponents() {  # half of the time all exponents, a sixth each the leading ones, propagation and Hill's determinant
  run exponents $(($1 / 2)) "$2"
  run exponents $(($1 / 6)) $(($2 + 1)) --leading
  run exponents $(($1 / 6)) $(($2 + 2)) --method propagation
  run exponents $(($1 / 6)) $(($2 + 3)) --method determinant
}

part=${1:-exponents}
shift || true
failed=0
case $part in
  exponents | sweeps | maps | one_mode | linkages | all)
    seconds=${1:-120} seed=${2:-1}
    parts=("$part")
    [[ $part != all ]] || parts=(exponents sweeps maps one_mode linkages)
    tools/build.sh release "${parts[@]/#/attack_}" >&2
    for part in "${parts[@]}"; do
      share=$((seconds / ${#parts[@]}))
      if [[ $part == exponents ]]; then exponents "$share" "$seed"; else run "$part" "$share" "$seed"; fi
    done
    exit "$failed"
    ;;
  faults)
    exec tools/attack/faults.sh "$@"
    ;;
  *)
    echo "tools/attack.sh: found $part, allowed: exponents, sweeps, maps, one_mode, linkages, all, faults" >&2
    exit 2
    ;;
esac
