#!/usr/bin/env bash
# Looks into the files of packages: what an attacker needs is taken away, and the shared library shows what it should.
# usage: elf.sh FOLDER-OF-PACKAGES
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for package in "$1"/*.deb; do dpkg-deb -x "$package" "$folder"; done
failed=0
expect() { # WHAT FILE TEXT PATTERN
  grep -qE -e "$4" <<<"$3" || { echo "$2: no $1"; failed=1; }
}
refuse() {
  ! grep -qE -e "$4" <<<"$3" || { echo "$2: $1: $(grep -E -m 3 -e "$4" <<<"$3")"; failed=1; }
}
program=$folder/usr/bin/headpin
library=$(find "$folder" -name 'libheadpin-engine.so.*.*.*' -type f)
[ -n "$library" ] || { echo "no shared library"; exit 1; }
module=$(find "$folder" -name '_headpin.*.so')
[ -n "$module" ] || { echo "no module of Python"; exit 1; }
for file in "$program" "$library" "$module"; do
  headers=$(readelf -Wl "$file") dynamic=$(readelf -Wd "$file") symbols=$(nm -D "$file") notes=$(readelf -Wn "$file")
  expect "read-only relocations" "$file" "$headers" GNU_RELRO
  expect "binding at the start" "$file" "$dynamic" 'BIND_NOW|FLAGS.*NOW'
  expect "code that can be anywhere" "$file" "$headers" 'Elf file type is DYN'
  expect "guards of the stack" "$file" "$symbols" __stack_chk_fail
  refuse "a stack that runs" "$file" "$headers" 'GNU_STACK.*RWE'
  refuse "a path of the builder" "$file" "$dynamic" 'RPATH|RUNPATH'
  [ "$(uname -m)" != x86_64 ] || expect "marks of where calls may go" "$file" "$(objdump -d --no-show-raw-insn "$file" | head -n 200000)" endbr64
  echo "$(basename "$file"): $(grep -oE 'IBT|SHSTK' <<<"$notes" | sort -u | tr '\n' ' ')"
done
expect "checked calls" "$program" "$(nm -D "$program")" '_chk@'
expect "soname" "$library" "$(readelf -Wd "$library")" 'SONAME.*libheadpin-engine\.so\.[0-9]+\.[0-9]+\]'
exported=$(nm -DC --defined-only "$library")
expect "step()" "$library" "$exported" 'T headpin::engine::step\('
refuse "symbols of others" "$library" "$(grep -vE ' (headpin::|(vtable|typeinfo|typeinfo name|VTT|guard variable) for headpin::|HEADPIN_)' <<<"$exported")" .
expect "start of the module" "$module" "$(nm -D --defined-only "$module")" ' T PyInit__headpin$'
refuse "symbols of headpin" "$module" "$(nm -D --defined-only "$module" | grep -v ' PyInit__headpin$')" headpin
refuse "what is for itself" "$library" "$exported" "headpin::engine::detail"

# Plugins: one with the static library in it, one beside the shared one; a program loads both.
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
archive=$(find "$folder" -name libheadpin_engine.a)
read -r -a flags <<<"$(PKG_CONFIG_PATH=$(dirname "$(find "$folder" -name headpin-engine.pc)") \
  pkg-config --cflags headpin-engine)"
cd "$folder"
g++ -std=c++20 -O1 "${flags[@]}" -fPIC -shared "$here/plugin/plugin.cpp" -o with_static.so -Wl,--no-undefined \
  "$archive" "$(dirname "$archive")/libheadpin_base.a"
g++ -std=c++20 -O1 "${flags[@]}" -fPIC -shared "$here/plugin/plugin.cpp" -o with_shared.so -Wl,--no-undefined \
  -L"$(dirname "$library")" -lheadpin-engine
g++ "$here/plugin/host.cpp" -o host
LD_LIBRARY_PATH=$(dirname "$library") ./host ./with_static.so ./with_shared.so || { echo "a plugin does not work"; failed=1; }
expect "the shared engine" with_shared.so "$(readelf -Wd with_shared.so)" 'NEEDED.*libheadpin-engine\.so'
exit $failed
