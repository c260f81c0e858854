#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

hb report ../six_link/scene.toml --rpm 200:3000:100 --x rpm=200:3000:57 --y '*.J=20:120:41' --out six_link.html || (($? == 3))
hb report ../slider_crank/scene.toml --rpm 1000:9000:250 --out slider_crank.html || (($? == 3))
