#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

written=$(mktemp -d)
trap 'rm -rf "$written"' EXIT
hb tune scene.toml --minimise mass --vary AB.section.height=5:30 --vary CD.section.height=5:30 \
  --keep 'stable>=5' --keep 'deflection<=2' --over rpm=300:3000 --speeds 12 --out "$written/out" >"$written/tune.txt"
cp "$written/tune.txt" "$written/out/"{tuned.toml,before_after.svg,history.csv,curves_before.csv,curves_after.csv} .
