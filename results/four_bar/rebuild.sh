#!/usr/bin/env bash
set -euo pipefail
hb steady scene.toml --rpm 300 --out 300rpm >300rpm.txt
