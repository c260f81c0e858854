#!/usr/bin/env bash
# grid.sh "AB HEIGHTS" "CD HEIGHTS": every pair of heights by `hb sweep` at every 50 rpm, as CSV.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

written=$(mktemp -d)
trap 'rm -rf "$written"' EXIT
echo "AB.section.height,CD.section.height,mass [kg],deflection [mm],growth rate [1/s],feasible"
for ab in $1; do
  for cd in $2; do
    status=0
    hb sweep scene.toml --set AB.section.height="$ab" --set CD.section.height="$cd" --rpm 300:3000:50 \
      --only shape,stability --no-plots --out "$written/out" >/dev/null || status=$?
    ((status == 0 || status == 3)) || exit "$status"
    # Rods are alike but for their height: mass = density width length height.
    awk -F, -v ab="$ab" -v cd="$cd" '
      /^#/ { next }
      /^crank speed/ { for (i = 1; i <= NF; i++) column[$i] = i; next }
      {
        w = $column["deflection [mm]"]; s = $column["growth rate [1/s]"]
        if (w == "" || w == "nan" || w > most) most = w == "" || w == "nan" ? 1e300 : w
        if (first++ == 0 || s > growth) growth = s
      }
      END {
        mass = 6.3706e-5 * 1.3608 * 259 * ab + 7.0198e-5 * 1.1619 * 258 * cd
        printf "%s,%s,%.6f,%.6g,%.6g,%d\n", ab, cd, mass, most, growth, most <= 2 && growth <= -5
      }' "$written"/out/sweep_*.csv
    rm -rf "$written/out"
  done
done
