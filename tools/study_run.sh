#!/usr/bin/env bash
# tools/study_run.sh FOLDER PATTERNS COMMAND ARGUMENTS...: runs `hb COMMAND ARGUMENTS...`, keeps what it prints as
# FOLDER/COMMAND.txt and those of its files that match PATTERNS (space separated).
set -euo pipefail

folder=$1
read -ra patterns <<<"$2"
command=$3
shift 3

written=$(mktemp -d)
trap 'rm -rf "$written"' EXIT
status=0
hb "$command" "$@" --out "$written/out" >"$written/$command.txt" || status=$?
# 3: a result, which says in words what it did not reach.
((status == 0 || status == 3)) || exit "$status"

rm -rf "$folder"
mkdir -p "$folder"
cp "$written/$command.txt" "$folder"
for pattern in "${patterns[@]}"; do
  # shellcheck disable=SC2086 # the pattern is meant to expand
  cp "$written/out"/$pattern "$folder"
done
