#!/usr/bin/env bash
# The pages, which are not kept (each holds the plotting library), and pictures of them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

report() { hb report "$@" || (($? == 3)); }
report ../first_steps/scene.toml --rpm 300:9000:150 --x rpm=300:9000:59 --y rod.section.height=6mm:12mm:25 --band damping=0.5:2 \
  --out first_steps.html
report ../six_link/scene.toml --rpm 200:3000:100 --x rpm=200:3000:57 --y '*.J=20:120:41' --out six_link.html
report ../slider_crank/scene.toml --rpm 1000:9000:250 --out slider_crank.html
report ../four_bar/scene.toml --rpm 100:600:20 --out four_bar.html
report ../six_link/scene.toml --rpm 1300:1560:10 --modes 1 --theory nonlinear --out nonlinear.html

# Debian's Python, for which python3-selenium is installed.
/usr/bin/python3 -B pictures.py \
  first_steps.html '#speed=27&angle=60&play=0' - first_steps.png \
  first_steps.html '#speed=27&angle=60&play=0' '#map-section' first_steps_map.png \
  first_steps.html '#speed=27&angle=60&play=0' '.card:has([data-view=stress])' first_steps_stress.png \
  first_steps.html '#speed=27&angle=60&play=0' '.cards:has([data-chart=growth]) .card:not(.wide)' first_steps_speeds.png \
  six_link.html '#speed=9&angle=120&play=0' - six_link.png \
  six_link.html '#speed=9&angle=120&play=0' '#speeds' six_link_speeds.png \
  slider_crank.html '#speed=20&angle=300&play=0' - slider_crank.png \
  four_bar.html '#speed=10&angle=90&play=0' - four_bar.png \
  nonlinear.html '#speed=19&angle=45&play=0' - nonlinear.png
