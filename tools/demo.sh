#!/usr/bin/env bash
# tools/demo.sh [FOLDER]: installs what is missing, builds, and computes the six-link mechanism at 300 rpm; tables and
# pictures go to FOLDER (default: build/demo).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

folder=${1:-build/demo}
echo "Installs what is missing, then compiles for about four minutes on two cores; the answer comes last." >&2
tools/setup.sh command
tools/build.sh release hb_command
build/release/bin/hb steady results/six_link/scene.toml --rpm 300 --out "$folder" </dev/null
