# Sourced by soak.sh and threads.sh, with HEADPIN and TRIAL as the first arguments: a network of its own, a folder that
# is removed at the end, and functions for a session with an emulated Fastrak.
# shellcheck shell=bash disable=SC2034
if [ -z "${HEADPIN_ALONE:-}" ]; then  # so that no LCM messages of others arrive
  exec unshare -n env HEADPIN_ALONE=1 "$0" "$@"
fi
headpin=$(realpath "$1") trial=$(realpath "$2")
ip link set lo up
ip link set lo multicast on
ip route add 224.0.0.0/4 dev lo
url='udpm://239.255.76.67:7667?ttl=0'
folder=$(mktemp -d)
unit=
end() {
  [ -z "$unit" ] || kill "$unit" 2>/dev/null || true
  rm -rf "$folder"
}
trap end EXIT
cd "$folder" || exit

# Starts a Fastrak on the pseudo-terminal `line`, with buttons over LCM, that plays the trial; its process is $unit.
start_unit() {
  "$headpin" emulate "$trial" --loop --link line --mouse "$url" >/dev/null 2>emulate.txt &
  unit=$!
  until [ -e line ]; do kill -0 "$unit"; sleep 0.1; done
}

# Starts a recorded session with this unit in the trial's scenario: start_session SECONDS. Its process is $live; it writes
# live.json and live.txt.
start_session() {
  "$headpin" info "$trial" --scenario >room.toml
  "$headpin" live --fastrak line --lcm "$url" --scenario room.toml --record session.lcmlog --duration "$1" --json \
    >live.json 2>live.txt &
  live=$!
}
