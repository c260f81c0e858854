#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
# shellcheck source-path=SCRIPTDIR source=../tune_study.sh
source ../tune_study.sh

columns="width [mm],height [mm],force [N],stress [MPa],growth rate [1/s],feasible"
# By `hb steady` at every 1000 rpm.
point() {
  local rpm
  for rpm in $(seq 6000 1000 12000); do
    computed hb steady scene.toml --set rod.section.width="${1}e-3" --set rod.section.height="${2}e-3" --rpm "$rpm" \
      --no-plots --out "$written/out" >"$written/steady.txt"
    awk -F, '
      /^#/ { next }
      /^crank angle/ { for (i = 1; i <= NF; i++) column[$i] = i; next }
      {
        x = $column["rod.0 x [N]"]; y = $column["rod.0 y [N]"]
        if (sqrt(x * x + y * y) > most) most = sqrt(x * x + y * y)
      }
      END { printf "%.9g ", most }' "$written/out/joint_forces.csv"
    awk '/bending moment/ { moment = $3 } /growth rate/ { growth = $3 } END { print moment, growth }' \
      "$written/steady.txt"
    rm -rf "$written/out"
  done | awk -v b="$1" -v h="$2" '
    { if ($1 > force) force = $1; if ($2 > moment) moment = $2; if (NR == 1 || $3 > growth) growth = $3 }
    END {
      stress = 6 * moment / (b * h * h * 1e-9) * 1e-6
      printf "%s,%s,%.6f,%.6f,%.6g,%d\n", b, h, force, stress, growth, stress <= 150 && growth <= -20
    }'
}

tune --minimise force:rod.0 --vary rod.section.width=0.005:0.014 --vary rod.section.height=0.006:0.024 \
  --keep 'stress<=150' --keep 'stable>=20' --over rpm=6000:12000 --speeds 8

# Everywhere coarsely, then finely around the best section that keeps both conditions.
grid coarse "$(seq -s' ' 5 1.5 14)" "$(seq -s' ' 6 3 24)"
grid fine "$(seq -s' ' 5 0.1 5.3)" "$(seq -s' ' 10 0.2 13)"
best "least bearing force"

check 6000 9000 12000
