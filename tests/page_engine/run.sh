#!/usr/bin/env bash
# Builds the page's engine and holds it against the program. Usage: run.sh HEADPIN ENGINE_FOLDER
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
"$here/../../apps/report/engine/build.sh" "$2"
node "$here/engine.test.mjs" "$1" "$2"
