#!/usr/bin/env bash
# Replays whole trials with other compilers and on other machines: the bundled throw, a session of two
# games and a game of ten pins, recorded by build/release/headpin. Every tick is compared with the
# recording; the first that differs is named with its body.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
headpin=build/release/headpin
work=build/matrix
mkdir -p "$work"
[ -x $headpin ] || { echo "expected $headpin, which records the trials: ./dev build makes it"; exit 1; }

"$headpin" synthesize --participant 7 --force -o "$work/session.lcmlog" >"$work/record.log"
"$headpin" synthesize --participant 7 --scenario regulation-ten-pin --throws 21 --force \
  -o "$work/ten-pin.lcmlog" >>"$work/record.log"
trials=()
for trial in assets/trials/demo.lcmlog "$work/session.lcmlog" "$work/ten-pin.lcmlog"; do
  trials+=("$work/$(basename "$trial" .lcmlog)-states.lcmlog")
  "$headpin" replay "$trial" --force -o "${trials[-1]}" >>"$work/record.log"
done

# make NAME COMPILER: the program, by that compiler.
make() {
  local options=(-DCMAKE_CXX_COMPILER="$2")
  case $1 in
    AArch64 | RISC-V) options+=(-DCMAKE_SYSTEM_NAME=Linux) ;;
    WebAssembly)
      options=(-DCMAKE_TOOLCHAIN_FILE="$(em-config EMSCRIPTEN_ROOT)/cmake/Modules/Platform/Emscripten.cmake")
      ;;
  esac
  cmake -S tests/determinism -B "$work/trial-$1" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    "${options[@]}" &&
    cmake --build "$work/trial-$1"
}

reference="" failed=0
for machine in "g++ g++" "clang++ clang++" "AArch64 aarch64-linux-gnu-g++ qemu-aarch64" \
  "RISC-V riscv64-linux-gnu-g++ qemu-riscv64" "WebAssembly em++ node"; do
  read -r name compiler runner <<<"$machine"
  found=$work/trial-$name.txt
  if ! command -v "$compiler" >/dev/null || ! command -v ${runner:-env} >/dev/null; then
    echo "skipped: no $compiler, or no $runner to run what it builds"
  elif ! make "$name" "$compiler" >"$work/trial-$name.log" 2>&1; then
    tail -n 40 "$work/trial-$name.log"
    failed=1
  elif ! $runner "$work"/trial-"$name"/trial_hash* "${trials[@]}" >"$found" ||
    ! cmp -s "${reference:=$found}" "$found"; then
    echo "DIFFERENT: whole trials, $name"
    cat "$found"
    failed=1
  else
    [ "$reference" != "$found" ] || cat "$found"
    echo "same bits: whole trials, $name"
  fi
done
exit $failed
