#!/usr/bin/env bash
# tools/setup.sh [command|tests]: installs the Debian packages that are missing, and only those: what builds and runs the
# command (default), or what the tests, the benchmarks, the page tests and the Python package need too. Needs root or sudo when something is
# missing.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

purpose=${1:-command}
packages=(
  g++ cmake ninja-build git
  libeigen3-dev libfftw3-dev libtomlplusplus-dev libcli11-dev libfmt-dev nlohmann-json3-dev
  libsundials-cvode6 libsundials-nvecserial6 libnlopt-dev libnlopt-cxx-dev libmimalloc-dev libjs-dygraphs
  gnuplot-nox fonts-dejavu-core
)
case $purpose in
  command) ;;
  tests) packages+=(libsundials-dev libgtest-dev libbenchmark-dev libopenmpi-dev openmpi-bin chromium chromium-driver python3-selenium
    scdoc pkg-config file clang-format valgrind
    python3-dev python3-numpy pybind11-dev python3-pytest python3-matplotlib python3-pandas python3-xarray python3-scipy
    mypy) ;;
  *)
    echo "tools/setup.sh: found $purpose, allowed: command, tests" >&2
    exit 2
    ;;
esac

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done

# Headers of SUNDIALS: of the package that holds them 300 others hang, MPI and PETSc among them, which the two libraries
# above do not use. So it is unpacked here, not installed (cmake/dependencies.cmake).
sundials=build/sundials
has_sundials() { [[ -e /usr/include/cvode/cvode.h || -e $sundials/usr/include/cvode/cvode.h ]]; }
unpack_sundials() {
  mkdir -p "$sundials"
  (cd "$sundials" && rm -f libsundials-dev_*.deb && apt-get download libsundials-dev </dev/null &&
    dpkg-deb -x libsundials-dev_*.deb .)
}
if ((!${#missing[@]})); then
  has_sundials || unpack_sundials || { echo "Cannot download libsundials-dev: apt-get update may help" >&2; exit 1; }
  exit 0
fi

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    printf 'These packages are missing; install them as root and try again:\n  apt-get install --no-install-recommends %s\n' \
      "${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

echo "Installing ${missing[*]} (Debian's packages and what they depend on; a minute or two)" >&2
"${as_root[@]}" apt-get update </dev/null
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install --yes --no-install-recommends "${missing[@]}" </dev/null
has_sundials || unpack_sundials
