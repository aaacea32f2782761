#!/usr/bin/env bash
# Live, emulate and drawing by a program built with ThreadSanitizer: fails when that says anything of ours.
# A session with a Fastrak over a pseudo-terminal, buttons over LCM and both eyes, recorded; then frames of it by
# two processes, and a replay of it.
#
# usage: tests/threads.sh HEADPIN TRIAL [SECONDS]
set -euo pipefail
if [ -z "${HEADPIN_THREADS_ALONE:-}" ]; then  # in a network of its own, so that nobody else's LCM is heard
  exec unshare -n env HEADPIN_THREADS_ALONE=1 "$0" "$@"
fi
headpin=$(realpath "$1") trial=$(realpath "$2") seconds=${3:-10}
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
ip link set lo up
ip link set lo multicast on
ip route add 224.0.0.0/4 dev lo
folder=$(mktemp -d)
unit=
end() {
  [ -z "$unit" ] || kill "$unit" 2>/dev/null || true
  rm -rf "$folder"
}
trap end EXIT
cd "$folder"
mkdir races
# Who races goes on, so that all of them are told; exit codes are the program's own.
export TSAN_OPTIONS="suppressions=$here/threads.supp log_path=$folder/races/of exitcode=0 print_suppressions=0"
url='udpm://239.255.76.67:7667?ttl=0'

"$headpin" emulate "$trial" --loop --link line --mouse "$url" >/dev/null 2>emulate.txt &
unit=$!
until [ -e line ]; do kill -0 "$unit"; sleep 0.1; done
"$headpin" info "$trial" --scenario >room.toml
"$headpin" live --fastrak line --lcm "$url" --scenario room.toml --record session.lcmlog --duration "$seconds" --json \
  >live.json 2>live.txt || { cat live.txt >&2; exit 1; }
kill -INT "$unit"
wait "$unit" || true
unit=
"$headpin" frames session.lcmlog -o frames --frames 1-4 --jobs 2 >/dev/null
"$headpin" replay session.lcmlog --verify --json >replay.json
python3 - <<'PYTHON'
import json
import sys

live, replayed = (json.load(open(name + ".json")) for name in ("live", "replay"))
print(f"{live['ticks']} ticks, {live['samples']} samples, {live['frames']} frames; {replayed['verified_ticks']} verified")
if min(live["samples"], live["frames"]) == 0 or live["ticks"] != replayed["verified_ticks"]:
    sys.exit("expected samples, frames, and every tick verified")
PYTHON
if [ -n "$(ls races)" ]; then
  cat races/*
  echo "ThreadSanitizer has found something: see above" >&2
  exit 1
fi
