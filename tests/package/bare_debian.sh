#!/usr/bin/env bash
# Installs the packages in a Debian 12 with nothing in it, and uses them there. Needs root,
# debootstrap and a mirror.
# usage: bare_debian.sh FOLDER-OF-PACKAGES [FOLDER]   (kept when it is given, and used again)
set -euo pipefail
packages=$(realpath "$1")
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
mirror=${DEBIAN_MIRROR:-http://deb.debian.org/debian}
if [ $# -gt 1 ]; then
  root=$2
else
  root=$(mktemp -d)
  trap 'rm -rf "$root"' EXIT
fi
[ -e "$root/etc/debian_version" ] || debootstrap --variant=minbase bookworm "$root" "$mirror" >/dev/null

mkdir -p "$root/packages" "$root/client"
cp "$packages"/*.deb "$root/packages"
cp "$here"/engine_client/* "$root/client"
within() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive bash -euo pipefail -c "$1"; }

within 'apt-get update -qq; apt-get install -y -qq --no-install-recommends /packages/headpin_*.deb >/dev/null'
within 'cd /tmp; rm -rf try; mkdir try; cd try
  headpin replay /usr/share/headpin/trials/demo.lcmlog -o demo.lcmlog
  headpin frames demo.lcmlog -o frames --frames 200
  [ ! -e /usr/share/headpin/page.html ] || headpin report demo.lcmlog -o demo.html
  headpin synthesize --scenario german-ninepins -o nine.lcmlog
  headpin replay nine.lcmlog | grep "ninepins: [0-9]"
  ! find /usr/lib /usr/include -name "*headpin_*" | grep .  # the engine comes in its own package'
within 'apt-get install -y -qq --no-install-recommends man-db cmake g++ make pkg-config /packages/libheadpin-dev_*.deb /packages/libheadpin-engine*.deb >/dev/null
  ! dpkg -s liblcm-dev 2>/dev/null  # Eigen alone
  man --warnings headpin-replay 2>&1 >/dev/null | (! grep .)
  cd /tmp/try; cmake -S /client -B client >/dev/null; cmake --build client >/dev/null; client/client
  g++ /client/client.cpp -o plain $(pkg-config --cflags --libs headpin-engine); ./plain
  g++ /client/client.cpp -o shared $(pkg-config --cflags headpin-engine) -lheadpin-engine; ./shared
  ldd shared | grep "libheadpin-engine.so"'
within 'apt-get install -y -qq --no-install-recommends /packages/python3-headpin_*.deb >/dev/null
  cd /tmp/try; python3 -c "import headpin; t = headpin.Trial(\"demo.lcmlog\"); assert t.verify() is None; print(t.frames(200).image.shape)"
  apt-get remove -y -qq python3-headpin >/dev/null
  [ ! -e /usr/lib/python3/dist-packages/headpin ] && ! python3 -c "import headpin" 2>/dev/null  # nothing is left of it'
echo "packages installed and used in $(cat "$root/etc/debian_version")"
