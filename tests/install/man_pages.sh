#!/usr/bin/env bash
# man_pages.sh HB PAGES: a page for each subcommand, with each of its flags, and one that lists the subcommands.
set -euo pipefail
hb=$1 pages=$2
failed=0
plain() { sed 's/\\-/-/g; s/\\&//g; s/\\f.//g' "$1"; }
for subcommand in $("$hb" --help | sed -n '/^Subcommands:/,$s/^  \([a-z]*\) .*/\1/p'); do
  plain "$pages/hb.1" | grep -q "^$subcommand" || { echo "hb.1 lacks $subcommand"; failed=1; }
  for flag in $("$hb" "$subcommand" --help | grep -oE -- '^ +(-h,)?--[a-z-]+' | grep -oE -- '--[a-z-]+'); do
    plain "$pages/hb-$subcommand.1" | grep -qF -- "$flag" || { echo "hb-$subcommand.1 lacks $flag"; failed=1; }
  done
done
[[ -f $pages/hb-steady.1 ]] || failed=1
exit $failed
