# shellcheck shell=bash
# What the studies of `hb tune` share; sourced by their rebuild.sh in the study's folder. A study defines
#   columns     of its grids, the last one `feasible`, the third one what is minimised
#   point A B   a line of them for one pair of numbers; files it needs go to $written

written=$(mktemp -d)
trap 'rm -rf "$written"' EXIT

# tune ARGUMENTS...: the design into tuned/.
tune() {
  rm -rf tuned
  hb tune scene.toml "$@" --out tuned >tune.txt
  mv tune.txt tuned
  rm tuned/.hb-tune tuned/*.png tuned/tune.json tuned/tune.gp tuned/campbell_*.csv tuned/tune_map.csv
}

# grid NAME "FIRST NUMBERS" "SECOND NUMBERS": brute force over every pair, as grid_NAME.csv.
grid() {
  local a b
  {
    echo "${columns:?}"
    for a in $2; do
      for b in $3; do
        point "$a" "$b"
      done
    done
  } >"grid_$1.csv"
}

# best SENTENCE: of each grid.
best() {
  local grid
  for grid in coarse fine; do
    echo "$1 of the $grid grid with both conditions kept:"
    head -1 "grid_$grid.csv"
    awk -F, '$NF == 1' "grid_$grid.csv" | sort -t, -g -k3 | head -1
  done >grid.txt
}

# check RPM...: the tuned design against time integration.
check() {
  local rpm
  for rpm in "$@"; do
    hb check tuned/tuned.toml --rpm "$rpm" || (($? == 1)) # 1: a disagreement, which check.txt shows
  done >check.txt
}

# computed COMMAND...: a result that says in words what it did not reach (3) counts.
computed() {
  local status=0
  "$@" || status=$?
  ((status == 0 || status == 3))
}
