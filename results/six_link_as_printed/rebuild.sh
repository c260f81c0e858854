#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
for rpm in 300 2400 3000; do
  hb steady scene.toml --rpm $rpm --out ${rpm}rpm >${rpm}rpm.txt
done
