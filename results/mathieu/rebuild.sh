#!/usr/bin/env bash
set -euo pipefail
for omega in 1 2.05; do
  hb steady scene.toml --omega $omega --out omega_$omega >omega_$omega.txt
done
