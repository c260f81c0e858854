#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
awk -f gas_force.awk >gas_force.csv
hb steady scene.toml --rpm 9000 --out 9000rpm >9000rpm.txt
