#!/usr/bin/env bash
set -euo pipefail
awk -f gas_force.awk >gas_force.csv
hb steady scene.toml --rpm 9000 --out 9000rpm >9000rpm.txt
