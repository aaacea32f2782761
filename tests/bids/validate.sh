#!/usr/bin/env bash
# A study of virtual participants as Motion-BIDS, against npm's bids-validator: no error, and no warning but
# those that are told here.
# usage: validate.sh HEADPIN FOLDER
set -euo pipefail
headpin=$(realpath "$1")
mkdir -p "$2"
cd "$2"
[ -d package ] || {
  npm pack bids-validator@1.15.0 --silent >/dev/null
  tar xzf bids-validator-1.15.0.tgz
}
rm -rf study dataset
"$headpin" experiment plan -o study --people 2 >/dev/null
"$headpin" experiment run study --all --virtual --jobs 2 >/dev/null
"$headpin" experiment ask study --all --virtual >/dev/null
"$headpin" experiment export study --motion-bids dataset >/dev/null
here=$PWD
(cd package && node -e "require('./dist/commonjs/cli.js').default(['$here/dataset'])") 2>&1 |
  sed 's/\x1b\[[0-9;]*m//g' >found.txt || true
grep -q 'bids-validator' found.txt  # it has run
# Explained: the first row of a motion table is data, as the standard has it, and is taken for names; who the authors are
# is for the laboratory to say.
if grep -E '\[(ERR|WARN)\]' found.txt | grep -vE 'CUSTOM_COLUMN_WITHOUT_DESCRIPTION|Authors field'; then
  echo "not valid: see $here/found.txt" >&2
  exit 1
fi
echo "valid: no error, no warning but those explained"
