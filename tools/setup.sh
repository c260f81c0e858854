#!/usr/bin/env bash
# Installs the Debian packages that are missing, and only those. Needs root or sudo when something is missing.
set -euo pipefail

packages=(
  g++ cmake ninja-build git
  libeigen3-dev libfftw3-dev libtomlplusplus-dev libcli11-dev libfmt-dev nlohmann-json3-dev
  libsundials-dev libnlopt-dev libnlopt-cxx-dev
  libgtest-dev libbenchmark-dev
  libopenmpi-dev openmpi-bin
  gnuplot-nox fonts-dejavu-core
)

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done
((${#missing[@]})) || exit 0

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    printf 'These packages are missing; install them as root and try again:\n  apt-get install --no-install-recommends %s\n' \
      "${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

echo "Installing ${missing[*]}" >&2
"${as_root[@]}" apt-get update </dev/null
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install --yes --no-install-recommends "${missing[@]}" </dev/null
