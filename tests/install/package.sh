#!/usr/bin/env bash
# package.sh BUILD SCENE FOLDER: the Debian package of a build, unpacked into a folder and run there.
set -euo pipefail
build=$1 scene=$2 folder=$3
rm -rf "$folder"
mkdir -p "$folder"
(cd "$build" && cpack -G DEB -B "$folder" >"$folder/cpack.log") || { cat "$folder/cpack.log"; exit 1; }
package=$(ls "$folder"/*.deb)
dpkg-deb --field "$package" Depends | grep -q libnlopt || { echo "the package does not name NLopt"; exit 1; }
dpkg-deb --extract "$package" "$folder/root"
"$folder/root/usr/bin/hb" steady "$scene" --rpm 300 --only stability >"$folder/steady.txt"
grep -q stable "$folder/steady.txt"
for file in include/hb/hb.hpp share/bash-completion/completions/hb share/doc/hb/LICENSE share/doc/hb/manual.md; do
  [[ -f $folder/root/usr/$file ]] || { echo "the package lacks $file"; exit 1; }
done
