#!/usr/bin/env bash
# A long session as a laboratory has it: a Fastrak over a pseudo-terminal, buttons over LCM, both eyes, recorded.
# Fails unless nothing crashed, no tick is missing, memory stayed flat, and the recording is whole and replays to the bit.
#
# usage: tests/soak.sh HEADPIN TRIAL [MINUTES]
set -euo pipefail
if [ -z "${HEADPIN_SOAK_ALONE:-}" ]; then  # in a network of its own, so that nobody else's LCM is heard
  exec unshare -n env HEADPIN_SOAK_ALONE=1 "$0" "$@"
fi
headpin=$(realpath "$1") trial=$(realpath "$2") minutes=${3:-60}
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
url='udpm://239.255.76.67:7667?ttl=0'

"$headpin" emulate "$trial" --loop --link line --mouse "$url" >/dev/null 2>emulate.txt &
unit=$!
until [ -e line ]; do kill -0 "$unit"; sleep 0.1; done
"$headpin" info "$trial" --scenario >room.toml
"$headpin" live --fastrak line --lcm "$url" --scenario room.toml --record session.lcmlog --duration $((60 * minutes)) --json \
  >live.json 2>live.txt &
live=$!

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
