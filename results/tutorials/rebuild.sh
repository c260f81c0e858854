#!/usr/bin/env bash
# The pictures of the tutorials.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
export PYTHONPATH="$PWD/../../build/release/python"
for script in ../../tools/python/tutorials/*.py; do
  /usr/bin/python3 -B "$script" . # Debian's Python, which the package is built for
done
