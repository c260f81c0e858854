#!/usr/bin/env bash
# Error against run time of every method: error_against_time.csv, propagators.csv and a picture per system; scaling.csv;
# whole commands: commands.csv, scale.csv. An hour on a machine without other work.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

../../tools/build.sh release hb_command hb_error_against_time hb_propagators hb_scaling hb_yardsticks hb_benchmarks >/dev/null
../../build/release/bin/hb_scaling >scaling.csv
../../build/release/bin/hb_error_against_time >error_against_time.csv
../../build/release/bin/hb_propagators >propagators.csv
../../build/release/tools/benchmarks/hb_benchmarks --benchmark_filter='theory_error|nonlinear' --benchmark_repetitions=15 \
  --benchmark_min_time=0.05 --benchmark_format=json | python3 exact_model.py >exact_model.csv
gnuplot plot.gp
python3 -B ../../tools/benchmarks/commands.py
python3 -B ../../tools/benchmarks/scale.py
./tables.py
