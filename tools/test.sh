#!/usr/bin/env bash
# tools/test.sh [PRESET]: installs what is missing, builds everything and runs the tests (default preset: release). The
# preset developer (warnings are errors, sanitizers) has most tests of lib, engine and analyses, those of the Python
# package about lifetime, bad input and stopping, and a run of each subcommand.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${1:-release}
tools/setup.sh tests
tools/build.sh "$preset"
ctest --preset "$preset" --parallel "$(nproc)" --timeout 600 </dev/null
