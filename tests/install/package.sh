#!/usr/bin/env bash
# package.sh BUILD SCENE WORK: the Debian package of a build, unpacked into a folder and run there.
set -euo pipefail
build=$1 scene=$2 work=$3
rm -rf "$work"
mkdir -p "$work"
(cd "$build" && cpack -G DEB -B "$work" >"$work/cpack.log") || { cat "$work/cpack.log"; exit 1; }
package=$(ls "$work"/*.deb)
dpkg-deb --field "$package" Depends | grep -q libfftw3 || { echo "the package does not name FFTW"; exit 1; }
dpkg-deb --extract "$package" "$work/root"
"$work/root/usr/bin/hb" steady "$scene" --rpm 300 --only stability >"$work/steady.txt"
grep -q stable "$work/steady.txt"
for file in include/hb/hb.hpp share/bash-completion/completions/hb share/doc/hb/LICENSE share/doc/hb/manual.md; do
  [[ -f $work/root/usr/$file ]] || { echo "the package lacks $file"; exit 1; }
done
