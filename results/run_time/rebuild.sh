#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

run=../../tools/study_run.sh
for rpm in 300 1500 3000; do
  $run six_link_${rpm}rpm 'bench.csv bench_*.svg' bench ../six_link/scene.toml --rpm $rpm
done
$run six_link_as_printed_300rpm 'bench.csv bench_*.svg' bench ../six_link_as_printed/scene.toml --rpm 300
$run slider_crank_9000rpm 'bench.csv bench_*.svg' bench ../slider_crank/scene.toml --rpm 9000
$run four_bar_300rpm 'bench.csv bench_*.svg' bench ../four_bar/scene.toml --rpm 300
$run mathieu 'bench.csv bench_*.svg' bench ../mathieu/scene.toml --omega 1
