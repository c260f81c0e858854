#!/usr/bin/env bash
# tools/test.sh [PRESET]: installs what is missing, builds everything and runs the tests (default preset: release).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${1:-release}
tools/setup.sh
tools/build.sh "$preset"
ctest --preset "$preset" --parallel "$(nproc)" --timeout 600 </dev/null
