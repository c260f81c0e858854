#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
# shellcheck source-path=SCRIPTDIR source=../tune_study.sh
source ../tune_study.sh

columns="AB.section.height,CD.section.height,mass [kg],deflection [mm],growth rate [1/s],feasible"
# By `hb sweep` at every 50 rpm. Rods are alike but for their height: mass = density width length height.
point() {
  computed hb sweep scene.toml --set AB.section.height="$1" --set CD.section.height="$2" --rpm 300:3000:50 \
    --only shape,stability --no-plots --out "$written/out" >/dev/null
  awk -F, -v ab="$1" -v cd="$2" '
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
}

tune --minimise mass --vary AB.section.height=5:30 --vary CD.section.height=5:30 \
  --keep 'stable>=5' --keep 'deflection<=2' --over rpm=300:3000 --speeds 12

# Everywhere coarsely, then finely around the lightest design that keeps both conditions.
grid coarse "$(seq -s' ' 5 5 30)" "$(seq -s' ' 5 5 30)"
grid fine "$(seq -s' ' 19.6 0.1 20.6)" "$(seq -s' ' 18.4 0.1 19.4)"
best "lightest design"
gnuplot grid.gp

# At speeds of both ends, the upper one where the tuned design bends most.
check 300 1500 3000
# And with all modes that matter.
computed hb steady tuned/tuned.toml --rpm 3000 --modes 20 --only shape >modes.txt
