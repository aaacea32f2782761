#!/usr/bin/env bash
# Installs what was built, moves it elsewhere, and uses all of it there.
# usage: install_and_use.sh BUILD WORK COMPILER SANITIZE
set -euo pipefail
build=$1 work=$2 compiler=$3 flags=
[ "$4" = ON ] && flags=-fsanitize=address,undefined
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
rm -rf "$work"
mkdir -p "$work"
cd "$work"

fail() { echo "FAILED: $*"; exit 1; }
quietly() { "$@" >log.txt 2>&1 || { cat log.txt; fail "$*"; }; }

echo "== the program"
quietly cmake --install "$build" --prefix "$work/first"
mv first elsewhere
prefix=$work/elsewhere
headpin=$prefix/bin/headpin
mkdir away
(
  cd away
  env -i "$headpin" synthesize --scenario german-ninepins --seed 3 -o throw.lcmlog >/dev/null
  env -i "$headpin" replay throw.lcmlog | grep -q "score sheet .*ninepins: [0-9]" || fail "no ninepins"
  env -i "$headpin" replay "$prefix/share/headpin/trials/demo.lcmlog" | grep -q "of 10"
  example=$(env -i "$headpin" info --help | grep '^ *headpin info .*demo.lcmlog')
  env -i PATH="$prefix/bin" "$(command -v sh)" -c "$example" >/dev/null || fail "the example of info: $example"
  env -i "$headpin" import "$prefix/share/headpin/throws/example.csv" -o own.lcmlog >/dev/null
  if [ -e "$prefix/share/headpin/page.html" ]; then
    env -i "$headpin" report own.lcmlog -o own.html
    grep -q 'data-block="log"' own.html || fail "no trial in the page"
  fi
)
for file in share/doc/headpin/copyright share/headpin/types/tracked_device_t.lcm; do
  [ -s "$prefix/$file" ] || fail "$file is missing"
done
[ ! -e "$build/devices/headpin-types.jar" ] || cmp "$build/devices/headpin-types.jar" "$prefix/share/java/headpin-types.jar"

echo "== the documentation"
if command -v python3 >/dev/null; then
  quietly python3 -B "$here/../readme/links.py" "$prefix/share/doc/headpin"
fi
topics=$("$headpin" help topics | sed -n 's/^  \([a-z-]\+\) .*/\1/p')
[ "$(wc -w <<<"$topics")" -ge 20 ] || fail "topics not found: $topics"
for topic in $topics; do
  page=$("$headpin" help "$topic" | tail -n 1)
  case $page in
    "$prefix"/share/doc/headpin/docs/*.md) [ -s "$page" ] || fail "$topic: $page is missing" ;;
    *) fail "$topic: expected a page in $prefix/share/doc, found $page" ;;
  esac
done

echo "== the manual"
commands=$("$headpin" --help | sed -n '/^Subcommands:/,$p' | sed -n 's/^  \([a-z]\+\) .*/\1/p')
[ "$(wc -w <<<"$commands")" -ge 10 ] || fail "commands not found in --help: $commands"
for page in headpin $(printf 'headpin-%s ' $commands); do
  file=$prefix/share/man/man1/$page.1.gz
  [ -s "$file" ] || fail "$file is missing"
  if command -v man >/dev/null; then
    said=$(LC_ALL=C MANWIDTH=80 man --warnings -l "$file" 2>&1 >page.txt) || true
    [ -z "$said" ] || fail "man $page: $said"
    # Every option that --help knows is in its page.
    [ "$page" = headpin ] || for option in $("$headpin" "${page#headpin-}" --help | grep -o -- '^  *\(-.,\)\?--[a-z-]*' | grep -o -- '--[a-z-]*'); do
      grep -q -e "$option" page.txt || fail "$page does not tell of $option"
    done
  fi
done
for file in "$prefix"/share/man/man1/*.1.gz; do  # headpin-experiment-plan is of `headpin experiment plan`
  read -r -a words <<<"$(basename "$file" .1.gz | tr - ' ')"
  "$headpin" "${words[@]:1}" --help >page.txt || fail "$file is of no command"
done

echo "== completion in bash"
completed() { # WORD... -> what the last may become
  bash -c 'source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _headpin; printf "%s\n" "${COMPREPLY[@]}"' \
    bash "$prefix/share/bash-completion/completions/headpin" "$@"
}
[ "$(completed headpin repl)" = replay ] || fail "headpin repl"
[ "$(completed headpin replay --ela)" = --elasticity ] || fail "replay --ela"
[ "$(completed headpin replay --json --ela)" = --elasticity ] || fail "replay --json --ela: a flag takes no value"
[ "$(completed headpin replay --shape ell)" = ellipsoid ] || fail "replay --shape ell"
[ "$(completed headpin live --scenario german)" = german-ninepins ] || fail "live --scenario german"
[ "$(completed headpin experiment pl)" = plan ] || fail "experiment pl"
[ "$(completed headpin experiment plan --peo)" = --people ] || fail "experiment plan --peo"
[ -z "$(completed headpin experiment score --peo)" ] || fail "experiment score has no --people"
[ "$(completed headpin replay --set material.lane.fr)" = material.lane.friction= ] || fail "replay --set"
[ "$(completed headpin replay --set game.rules = nine)" = ninepins ] || fail "replay --set game.rules=nine"
[ "$(completed headpin replay --set look.mirror =)" = "$(printf 'true\nfalse')" ] || fail "replay --set look.mirror="
[ "$(completed headpin replay --shape = ell)" = ellipsoid ] || fail "replay --shape=ell"
[ "$(completed headpin help track)" = trackers ] || fail "help track"
[ "$(completed headpin scenario sh)" = show ] || fail "scenario sh"
[ "$(completed headpin scenario --js)" = --json ] || fail "scenario --js"
! grep -q '^complete.*filenames' "$prefix/share/bash-completion/completions/headpin" || fail "words are marked as files"
(cd away && touch "two words.lcmlog" && [ "$(completed headpin info two)" = "two words.lcmlog" ]) ||
  fail "a file with a space"

if command -v zsh >/dev/null; then
  echo "== completion in zsh"
  cat >complete.zsh <<'EOZ'
zmodload zsh/zpty
zpty z zsh -f -i
zpty -w z "PS1='> '; fpath=($1 \$fpath); autoload -U compinit; compinit -u -D; bindkey '^I' complete-word; PATH=$2:\$PATH; print ready"
zpty -r z line $'*\nready*'
zpty -w -n z "headpin $3"$'\t'
zpty -r z line "*headpin $4*" && print found
EOZ
  for pair in "repl replay" "replay\ --ela --elasticity" "replay\ --shape\ el ellipsoid" "experiment\ pl plan" \
    "replay\ --json\ --ela --elasticity" "replay\ --response=pa --response=paper" "scenario\ sh show" \
    "help\ hash hashes" "replay\ --set\ game.rules=nine game.rules=ninepins" \
    "replay\ --set\ material.lane.fr material.lane.friction="; do
    eval "set -- $pair"
    found=$(timeout 60 zsh -f complete.zsh "$prefix/share/zsh/site-functions" "$prefix/bin" "$1" "*$2") ||
      fail "zsh: headpin $1"
    [ "$found" = found ] || fail "zsh: headpin $1: $found"
  done
fi

echo "== the libraries"
client() { # NAME PREFIX [CMAKE-OPTION...]
  local name=$1 at=$2
  shift 2
  quietly cmake -S "$here/$name" -B "$name" -G Ninja "-DCMAKE_PREFIX_PATH=$at" "-DCMAKE_CXX_COMPILER=$compiler" \
    "-DCMAKE_CXX_FLAGS=$flags" "$@"
  quietly cmake --build "$name"
  "$name/client"
}
client client "$prefix"

echo "== the engine alone, with Eigen alone"
quietly cmake --install "$build" --prefix "$work/engine" --component engine
[ -z "$(find engine -name '*headpin_devices*' -o -name '*scene*')" ] || fail "more than the engine"
alone=()
for package in PkgConfig fmt PNG LCM; do alone+=("-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON"); done
client engine_client "$work/engine" "${alone[@]}"
if cmake -S "$here/client" -B no_scene -G Ninja "-DCMAKE_PREFIX_PATH=$work/engine" >log.txt 2>&1; then
  fail "scene was found where the engine alone is"
fi
tr -s ' \n' ' ' <log.txt | grep -q "component scene is not installed" || { cat log.txt; fail "it is not said that scene is missing"; }
! grep LCM log.txt || fail "what scene stands on is looked for, though scene is missing"
folder=$(dirname "$(find engine -name headpin-engine.pc)")
# shellcheck disable=SC2046
"$compiler" $flags "$here/engine_client/client.cpp" -o with_pkg_config \
  $(PKG_CONFIG_PATH=$folder pkg-config --cflags --libs headpin-engine)
./with_pkg_config
PKG_CONFIG_PATH=$folder pkg-config --static --libs headpin-engine | grep -q -e -pthread || fail "--static without -pthread: steps may be shared by threads"

echo "== other flags than the engine's"
# refused SAYS FLAG...: with these the client is not made, and it is said what to do.
refused() {
  local says=$1
  shift
  # shellcheck disable=SC2046
  if "$compiler" $flags "$here/engine_client/client.cpp" -o refused \
    $(PKG_CONFIG_PATH=$folder pkg-config --cflags headpin-engine) "$@" \
    $(PKG_CONFIG_PATH=$folder pkg-config --libs headpin-engine) >log.txt 2>&1; then
    fail "$*: a client came of it"
  fi
  grep -q -e "$says" log.txt || { cat log.txt; fail "$*: '$says' is not said"; }
}
refused "pkg-config --cflags headpin-engine" -UEIGEN_DONT_VECTORIZE
refused "leave out -ffast-math" -ffast-math
refused "leave out the EIGEN_ macros" -DEIGEN_MAX_STATIC_ALIGN_BYTES=32
refused "leave out the EIGEN_ macros" -DEIGEN_DEFAULT_TO_ROW_MAJOR
refused "CompiledWithTheFlagsOf_pkg_config_cflags_headpin_engine" -D_GLIBCXX_DEBUG
refused "CompiledWithTheFlagsOf_pkg_config_cflags_headpin_engine" -D_GLIBCXX_USE_CXX11_ABI=0

! grep -rIl -e "$build" -e "$work/first" -e "$(cd "$here/../.." && pwd)" elsewhere engine ||
  fail "these name the folder they were made in"
