#!/usr/bin/env bash
# tools/study_run.sh FOLDER PATTERNS ARGUMENTS...: runs `hb steady ARGUMENTS...`, keeps what it prints as
# FOLDER/steady.txt and those of its files that match PATTERNS (space separated).
set -euo pipefail

folder=$1
read -ra patterns <<<"$2"
shift 2

written=$(mktemp -d)
trap 'rm -rf "$written"' EXIT
hb steady "$@" --out "$written/out" >"$written/steady.txt"

rm -rf "$folder"
mkdir -p "$folder"
cp "$written/steady.txt" "$folder"
for pattern in "${patterns[@]}"; do
  # shellcheck disable=SC2086 # the pattern is meant to expand
  cp "$written/out"/$pattern "$folder"
done
