#!/usr/bin/env bash
# grid.sh "WIDTHS" "HEIGHTS" [mm]: every section by `hb steady` and `hb sweep` at every 1000 rpm, as CSV.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

written=$(mktemp -d)
trap 'rm -rf "$written"' EXIT
echo "width [mm],height [mm],force [N],stress [MPa],growth rate [1/s],feasible"
for width in $1; do
  for height in $2; do
    for rpm in $(seq 6000 1000 12000); do
      status=0
      hb steady scene.toml --set rod.section.width="${width}e-3" --set rod.section.height="${height}e-3" --rpm "$rpm" \
        --no-plots --out "$written/out" >"$written/steady.txt" || status=$?
      ((status == 0 || status == 3)) || exit "$status"
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
    done | awk -v b="$width" -v h="$height" '
      { if ($1 > force) force = $1; if ($2 > moment) moment = $2; if (NR == 1 || $3 > growth) growth = $3 }
      END {
        stress = 6 * moment / (b * h * h * 1e-9) * 1e-6
        printf "%s,%s,%.6f,%.6f,%.6g,%d\n", b, h, force, stress, growth, stress <= 150 && growth <= -20
      }'
  done
done
