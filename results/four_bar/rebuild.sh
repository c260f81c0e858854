#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
hb steady scene.toml --rpm 300 --out 300rpm >300rpm.txt
