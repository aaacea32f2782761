#!/usr/bin/env bash
# Installs the wheel by pip into an environment of its own, and uses it there.
# usage: wheel.sh PYTHON FOLDER-OF-WHEEL TRIAL
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$1" -m venv --system-site-packages "$folder/env"  # numpy is the system's
"$folder/env/bin/pip" install -q --no-index --no-deps --disable-pip-version-check "$2"/headpin-*.whl
trial=$(realpath "$3")
cd "$folder"
env -u PYTHONPATH env/bin/python -B - "$trial" "$folder" <<'EOT'
import os
import sys

import headpin

trial, folder = sys.argv[1:]
assert headpin.__file__.startswith(folder), headpin.__file__
scenarios = os.listdir(os.path.join(os.path.dirname(headpin.__file__), "share/headpin/scenarios"))
assert "german-ninepins.toml" in scenarios, scenarios
again = headpin.Trial(trial).replay()
assert again.score["skittles_down"] > 0, again.score
print(f"headpin {headpin.__version__}, {again.score['skittles_down']} skittles down, {len(scenarios)} scenarios")
EOT
