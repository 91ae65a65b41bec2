#!/usr/bin/env bash
# Runs a long check, with PARACAL_ONCE only if it has not passed with the same inputs before, in any clone: once.sh 'PATH...' COMMAND...
# The inputs are files of the repository and the installed packages; a record of each pass is kept for 60 days.
set -euo pipefail
[[ -n ${PARACAL_ONCE:-} ]] || exec "${@:2}"
here=$(dirname "$0")
records=${XDG_CACHE_HOME:-$HOME/.cache}/paracal-once
mkdir -p "$records"
find "$records" -type f -mtime +60 -delete
read -ra inputs <<<"$1"
state=$("$here/state.sh" "${inputs[@]}")
root=$(cd "$here/.." && pwd)
record=$records/$({ echo "$state"; printf '%s\n' "${@:2}" | sed "s#$root/##g"; dpkg-query -W; } | sha256sum | cut -d ' ' -f 1)
if [[ -e $record ]]; then
  touch "$record"
  echo "passed before with the same inputs: ${*:2}"
  exit 0
fi
"${@:2}"
[[ $("$here/state.sh" "${inputs[@]}") == "$state" ]] && touch "$record"
