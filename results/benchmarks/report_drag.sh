#!/usr/bin/env bash
# How pages of 400 speeds follow their slider: report_drag.sh HB writes report_drag.csv. Takes some minutes; Debian's
# Python, for which python3-selenium is installed.
set -euo pipefail
hb=$(realpath "$1")
cd "$(dirname "${BASH_SOURCE[0]}")"
pages=$(mktemp -d)
trap 'rm -rf "$pages"' EXIT
report() { "$hb" report "$@" || (($? == 3)); }
report ../first_steps/scene.toml --rpm 300:9000:x400 --x rpm=300:9000:200 --y rod.section.height=6mm:12mm:200 \
  --out "$pages/slider_crank_with_map.html"
report ../six_link/scene.toml --rpm 200:3000:x400 --out "$pages/six_link.html"
/usr/bin/python3 -B ../../tools/benchmarks/report_drag.py "$pages/slider_crank_with_map.html" "$pages/six_link.html" >report_drag.csv
