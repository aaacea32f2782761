#!/usr/bin/env bash
# Builds the engine with several compilers, levels and instruction sets, and for other machines
# (AArch64 and RISC-V under qemu, WebAssembly under node), plays the same games with each and compares
# the hash of every tick; then replays whole trials on them (trial_matrix.sh).
# Once more without AVX, on a processor that qemu plays.
# Usage: build_matrix.sh [--quick]
#   --quick  one low and one high level of each compiler instead of all, no other machine, no trials;
#            the presets release (g++, -O3) and asan (clang++, -O1, sanitizers) are used where they were built
set -euo pipefail
[ $# = 0 ] || [ "$*" = --quick ] || { echo "build_matrix.sh: expected nothing or --quick, found $*" >&2; exit 2; }
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
levels=(-O1 -O2 -O3)
work=build/matrix
mkdir -p "$work"
eigen=$(pkg-config --cflags eigen3)
avx2=() fma=()
grep -qs avx2 /proc/cpuinfo && avx2=(-mavx2)
grep -qsw fma /proc/cpuinfo && fma=(-mfma)

variants=() presets=()
for compiler in g++ clang++; do
  command -v "$compiler" >/dev/null || { echo "skipped: no $compiler"; continue; }
  if [ "${1:-}" = --quick ]; then
    [ $compiler = g++ ] && preset=release || preset=asan
    [ -e "build/$preset/tests/state_hash" ] && presets+=("$preset") || variants+=("$compiler -O1")
    variants+=("$compiler -O3 ${avx2[*]} ${fma[*]}")
    continue
  fi
  for level in "${levels[@]}"; do
    variants+=("$compiler $level")
    [ ${#avx2[@]} -eq 0 ] || variants+=("$compiler $level ${avx2[*]}")
    [ ${#fma[@]} -eq 0 ] || variants+=("$compiler $level ${avx2[*]} ${fma[*]}")
  done
done

if [ "${1:-}" != --quick ]; then
  for machine in "aarch64-linux-gnu-g++ qemu-aarch64" "riscv64-linux-gnu-g++ qemu-riscv64" "em++ node"; do
    read -r compiler runner <<<"$machine"
    if command -v "$compiler" >/dev/null && command -v "$runner" >/dev/null; then
      variants+=("$compiler -O1" "$compiler -O3")
    else
      echo "skipped: no $compiler, or no $runner to run what it builds"
    fi
  done
fi

# The flags that carry the promise are those of base/CMakeLists.txt.
compile() {  # VARIANT ARGUMENT...
  local variant=$1 own=()
  shift
  [[ $variant != em++* ]] || own=(-fwasm-exceptions -include cmake/older_library.h)  # as for the page
  # shellcheck disable=SC2086
  $variant -std=c++20 -DNDEBUG -DEIGEN_DONT_VECTORIZE -I. $eigen "${own[@]}" \
    -ffp-contract=off -fno-tree-vectorize -fno-tree-slp-vectorize "$@"
}

make_ready() {  # VARIANT
  local dir=$work/${1// /}
  mkdir -p "$dir"
  echo '#include "base/math.h"' >"$dir/all.h"  # Eigen takes most of the time: read once
  [[ $1 == em++* ]] || compile "$1" -x c++-header "$dir/all.h" -o "$dir/all.h.gch"
}

make_object() {  # VARIANT|SOURCE
  local dir=$work/${1%|*} source=${1#*|}
  dir=${dir// /}
  compile "${1%|*}" -include "$dir/all.h" -c "$source" -o "$dir/$(basename "$source").o"
}

play() {  # VARIANT
  local name=${1// /} link=() run=()
  case $1 in
    aarch64*) link=(-static) run=(qemu-aarch64) ;;
    riscv64*) link=(-static) run=(qemu-riscv64) ;;
    em++*) link=(-fwasm-exceptions -s SINGLE_FILE=1) run=(node) ;;
  esac
  ${1%% *} "${link[@]}" "$work/$name"/*.o -o "$work/$name/state_hash.js"  # a script from em++ only
  "${run[@]}" "$work/$name/state_hash.js" >"$work/$name.txt"
}

# each FUNCTION: calls it with each word that it reads, on all cores.
each() { xargs -0 -P "$(nproc)" -I{} bash -euo pipefail -c "$1 \"{}\""; }

export -f compile make_ready make_object play
export work eigen
# What takes longest begins first.
sources=(engine/sustained.cpp engine/non_colliding.cpp)
for source in engine/*.cpp base/math.cpp tests/support/bowling.cpp tests/determinism/state_hash.cpp; do
  [[ " ${sources[*]} " == *" $source "* ]] || sources+=("$source")
done
printf '%s\0' "${variants[@]}" | each make_ready
for source in "${sources[@]}"; do printf "%s|$source\\0" "${variants[@]}"; done | each make_object
printf '%s\0' "${variants[@]}" | each play

for preset in "${presets[@]}"; do
  { cmake -DHEADPIN_TESTS=ON "build/$preset" && cmake --build "build/$preset" --target state_hash; } \
    >"$work/$preset.log" || { cat "$work/$preset.log"; exit 1; }
  "build/$preset/tests/state_hash" >"$work/$preset.txt"
done
variants+=("${presets[@]}")

# g++ builds the solver twice, and the program takes the version for AVX where there is AVX: the other is run here.
if [ "${1:-}" != --quick ] && [ -e "$work/g++-O3/state_hash.js" ] && [ "$(uname -m)" = x86_64 ]; then
  if command -v qemu-x86_64 >/dev/null; then
    variants+=("g++ -O3 without AVX")
    qemu-x86_64 -cpu Nehalem "$work/g++-O3/state_hash.js" >"$work/g++-O3withoutAVX.txt"
  else
    echo "skipped: no qemu-x86_64 to be a processor without AVX"
  fi
fi

reference=${variants[0]// /}
cat "$work/$reference.txt"
failed=0
for variant in "${variants[@]}"; do
  if cmp -s "$work/$reference.txt" "$work/${variant// /}.txt"; then
    echo "same bits: $variant"
  else
    echo "DIFFERENT: $variant"
    diff "$work/$reference.txt" "$work/${variant// /}.txt" || true
    failed=1
  fi
done
[ "${1:-}" = --quick ] || tests/determinism/trial_matrix.sh || failed=1
exit $failed
