#!/usr/bin/env bash
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

run=../../tools/study_run.sh
for study in six_link six_link_as_printed slider_crank four_bar; do
  $run $study 'check.csv check.svg' check ../$study/scene.toml --rpm 200:6000:200 --case-limit 300
done
for study in six_link six_link_as_printed slider_crank four_bar; do
  for rpm in 1 10 30000; do
    $run $study/${rpm}rpm '' check ../$study/scene.toml --rpm $rpm --no-plots --case-limit 600
  done
done
$run mathieu 'check.csv check.svg' check ../mathieu/scene.toml --omega 0.5:3:0.05 --tol 1e-12
