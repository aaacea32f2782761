#!/usr/bin/env bash
# A long session as a laboratory has it: a Fastrak over a pseudo-terminal, buttons over LCM, both eyes, recorded.
# Fails unless nothing crashed, no tick is missing, memory stayed flat, and the recording is whole and replays to the bit.
#
# usage: tests/soak.sh HEADPIN TRIAL [MINUTES]
set -euo pipefail
# shellcheck source=tests/laboratory.sh
source "$(dirname "${BASH_SOURCE[0]}")/laboratory.sh"
minutes=${3:-60}
start_unit
start_session $((60 * minutes))

# Resident memory of the session and of what draws for it [kB].
memory() {
  local process total=0 kb
  for process in $live $(cat /proc/$live/task/*/children 2>/dev/null); do
    kb=$(awk '/^VmRSS/ {print $2}' "/proc/$process/status" 2>/dev/null) || kb=0
    total=$((total + ${kb:-0}))
  done
  echo "$total"
}
: >memory.txt
while kill -0 $live 2>/dev/null; do
  sleep 2
  memory >>memory.txt
done
wait $live || { echo "the session has failed:" >&2; cat live.txt >&2; exit 1; }
tail -n 2 live.txt

"$headpin" info session.lcmlog --json >info.json
"$headpin" replay session.lcmlog --verify --json >replay.json
python3 - "$minutes" <<'PYTHON'
import json
import sys

live, info, replayed = (json.load(open(name + ".json")) for name in ("live", "info", "replay"))
memory = [int(line) for line in open("memory.txt") if int(line) > 0][:-1]  # the last one may be of its end
wrong = []


def expect(good, text):
    if not good:
        wrong.append(text)


expect(live["drawing_failures"] == 0, f"drawing failed {live['drawing_failures']} times")
expect(live["duration_s"] >= 60 * int(sys.argv[1]), "it ended early")
expect(info["complete"], "the recording is not complete")
expect(info["ticks"] == live["ticks"] == replayed["verified_ticks"],
       f"ticks: {live['ticks']} made, {info['ticks']} recorded, {replayed['verified_ticks']} verified")
expect(replayed["state_hash"] == live["state_hash"], "the replay comes to another state")
expect(info["frames"] == live["frames"] > 0, f"frames: {live['frames']} drawn, {info['frames']} recorded")
expect(live["samples"] > 0, "no samples")
# After a fifth of the time everything is there that is needed; latencies are kept, some 2 MB an hour.
begin, most = memory[len(memory) // 5], max(memory[len(memory) // 5:])
expect(most - begin < 16_000, f"memory grew from {begin} to {most} kB")
print(f"{live['ticks']} ticks, {live['overruns']} overruns; {live['frames']} frames, {live['late_frames']} late; "
      f"memory {begin} to at most {most} kB")
for text in wrong:
    print(text, file=sys.stderr)
sys.exit(bool(wrong))
PYTHON
