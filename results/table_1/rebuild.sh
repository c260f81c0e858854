#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

table_1 ../six_link/scene.toml >table_1.csv
