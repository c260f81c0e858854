#!/usr/bin/env bash
# Processor seconds and peak memory of whole commands: commands.sh HB [HB_BEFORE [RUNS [WORD]]] writes commands.csv (of
# the commands that contain WORD), with the ratio of the two where an earlier program is given. Both run in turn, so that a busy machine slows both; processor
# time, not the clock's. The claimed error stands beside the time; Mathieu's boundary is compared with another method in
# tests/engine/sweep.cpp.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
hb=$1 before=${2:-} runs=${3:-5} word=${4:-}
six=results/six_link/scene.toml mathieu=results/mathieu/scene.toml
coefficient=hill.stiffness.1.cos.0.0
commands=(
  "steady $six --rpm 1000 --json"
  "steady $six --rpm 1000 --json --only growth"
  "sweep $six --rpm 200:1500:10 --json --only steady,stability --no-search"
  "sweep $six --rpm 200:1500:10 --json --no-search"
  "sweep $six --rpm 200:1500:10 --json"
  "sweep $six --rpm 200:1500:10 --json --only growth"
  "sweep $six --rpm 200:3000:20 --json --only steady,stability --no-search"
  "sweep $six --rpm 200:3000:20 --json"
  "sweep $mathieu --omega 0.32:4:0.01 --json"
  "map $mathieu --x omega=0.5:3:1000 --y $coefficient=0.05:1:1000"
  "map $mathieu --x omega=0.5:3:1000 --y $coefficient=0.05:1:1000 --json"
  "map $six --x rpm=300:3000:20 --y *.J=30:100:20 --modes 1"
  "map $six --x rpm=300:3000:20 --y *.J=30:100:20 --modes 1 --no-boundaries"
)
# User and system seconds, and kilobytes.
measure() {
  local times memory
  times=$(mktemp) memory=$(mktemp)
  { TIMEFORMAT='%3U %3S'; time /usr/bin/time -o "$memory" -f "%M" "$@" >/dev/null 2>&1 || true; } 2>"$times"
  awk 'NR == FNR { s = $1 + $2; next } END { print s, $1 }' "$times" "$memory"
  rm -f "$times" "$memory"
}
median() { sort -n | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }
# The largest error claimed of the steady states and, relative to Omega, of the growth rates.
claimed() {
  case "$*" in *--json*) ;; *) echo ","; return ;; esac
  "$hb" "$@" | python3 -c '
import json, sys
d = json.load(sys.stdin)
flat = lambda v: [x for y in v for x in flat(y)] if isinstance(v, list) else [v]
rods = d.get("rods", {}).values()
q = [x for r in rods for x in flat(r.get("error_bound", [])) if x is not None]
s = [x for r in rods for x in flat(r.get("exponent_error", r.get("growth_error", []))) if x is not None]
print("%s,%s" % ("%.1e" % max(q) if q else "", "%.1e" % max(s) if s else ""))'
}
{
  echo "# $(grep -m1 'model name' /proc/cpuinfo | cut -d: -f2 | xargs), one thread, median of $runs"
  echo "command,seconds,seconds before,ratio,peak MB,peak MB before,claimed error of q,claimed error of growth [1/time]"
  for line in "${commands[@]}"; do
    [[ $line == *"$word"* ]] || continue
    set -f
    set -- $line
    set +f
    new=() old=() memory= memory_before=
    for ((run = 0; run < runs; ++run)); do
      read -r seconds memory < <(measure "$hb" "$@")
      new+=("$seconds")
      [[ -n $before ]] || continue
      # An earlier program may not know a flag: then it has no row.
      read -r seconds memory_before < <(measure "$before" "$@")
      old+=("$seconds")
    done
    now=$(printf '%s\n' "${new[@]}" | median)
    then_=
    if [[ -n $before ]] && "$before" "$@" >/dev/null 2>&1; then then_=$(printf '%s\n' "${old[@]}" | median); fi
    awk -v line="$line" -v now="$now" -v old="$then_" -v m="$memory" -v mb="$memory_before" -v c="$(claimed "$@")" 'BEGIN {
      printf "\"hb %s\",%s,%s,%s,%.0f,%s,%s\n", line, now, old, old == "" ? "" : sprintf("%.2f", now / old), m / 1024, old == "" ? "" : sprintf("%.0f", mb / 1024), c }'
  done
} >results/benchmarks/commands.csv
