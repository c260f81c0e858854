#!/usr/bin/env bash
# completion.sh HB COMPLETION SCENE: what the completion offers at the end of a line.
set -euo pipefail
hb=$1 scene=$3
source "$2"
failed=0

# offers "LINE" WORD...: each WORD is among the completions of the line's last word (empty after a blank).
offers() {
  local line=$1
  shift
  read -ra COMP_WORDS <<<"$line"
  [[ $line == *' ' ]] && COMP_WORDS+=('')
  COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
  _hb || true
  for word in "$@"; do
    if [[ " ${COMPREPLY[*]} " != *" $word "* ]]; then
      echo "\"$line\" does not offer $word: ${COMPREPLY[*]}"
      failed=1
    fi
  done
}

subcommands=$("$hb" --help | sed -n '/^Subcommands:/,$s/^  \([a-z]*\) .*/\1/p')
[[ $subcommands == *steady* && $subcommands == *report* ]] || { echo "no subcommands found"; exit 1; }
offers "$hb " $subcommands
offers "$hb st" steady
for subcommand in $subcommands; do
  offers "$hb $subcommand --" $("$hb" "$subcommand" --help | grep -oE -- '--[a-z-]+' | sort -u)
done
offers "$hb steady $scene --set " rod.J= rod.E=
offers "$hb map $scene --x " rpm= rod.J=
offers "$hb new " slider-crank hill
offers "$hb steady ${scene%.toml}" "$scene"
exit $failed
