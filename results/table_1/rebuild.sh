#!/usr/bin/env bash
set -euo pipefail
table_1 ../six_link/scene.toml >table_1.csv
