#!/usr/bin/env bash
# Live, emulate and drawing by a program built with ThreadSanitizer: fails when that says anything of ours.
# A session with a Fastrak over a pseudo-terminal, buttons over LCM and both eyes, recorded; then frames of it by
# two processes, and a replay of it.
#
# usage: tests/threads.sh HEADPIN TRIAL [SECONDS]
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=tests/laboratory.sh
source "$here/laboratory.sh"
mkdir races
# Who races goes on, so that all of them are told; exit codes are the program's own.
export TSAN_OPTIONS="suppressions=$here/threads.supp log_path=$folder/races/of exitcode=0 print_suppressions=0"
start_unit
start_session "${3:-10}"
wait "$live" || { cat live.txt >&2; exit 1; }
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
