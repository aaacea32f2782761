#!/usr/bin/env bash
# Every link of the pages in the package leads to something in the package.
# usage: pages.sh FOLDER-OF-PACKAGES
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
dpkg-deb -x "$1"/headpin_*.deb "$folder"
python3 -B "$(dirname "${BASH_SOURCE[0]}")/../readme/links.py" "$folder/usr/share/doc/headpin"
