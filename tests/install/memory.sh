#!/usr/bin/env bash
# memory.sh PROGRAM: every `new` of the program is that of the C++ library, which throws where memory ends.
set -euo pipefail
wrong=$(nm -D "$1" | grep ' U _Zn' | grep -v '@GLIBCXX\|@CXXABI' || true)
[[ -z $wrong ]] || { echo "not of the C++ library: $wrong"; exit 1; }
