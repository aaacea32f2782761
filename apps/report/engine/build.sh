#!/usr/bin/env bash
# Makes engine.js and engine.wasm in OUT_DIR, or what of them is out of date. Usage: build.sh OUT_DIR
set -euo pipefail
[ $# -eq 1 ] || { sed -n 2p "$0" >&2; exit 2; }
command -v em++ >/dev/null || { echo "$0: no em++ (Debian's package emscripten)" >&2; exit 1; }
sources=$(dirname "${BASH_SOURCE[0]}")
mkdir -p "$1"
exec 9>"$1/.lock"  # one build at a time
flock 9
cmake -S "$sources" -B "$1" -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_TOOLCHAIN_FILE="$(em-config EMSCRIPTEN_ROOT)/cmake/Modules/Platform/Emscripten.cmake" \
  >"$1/configure.log" || { cat "$1/configure.log" >&2; exit 1; }
cmake --build "$1"
