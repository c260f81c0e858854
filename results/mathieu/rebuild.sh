#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
for omega in 1 2.05; do
  hb steady scene.toml --omega $omega --out omega_$omega >omega_$omega.txt
done
