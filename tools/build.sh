#!/usr/bin/env bash
# Configures (when needed) and builds a preset: build.sh PRESET [TARGET ...]. Shows what the compiler says only when it fails.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=$1
shift
log=$(mktemp)
trap 'rm -f "$log"' EXIT
# Again where a program was missing that setup.sh has installed since: its tests would go on being skipped.
if [[ ! -f build/$preset/build.ninja ]] || grep -q '^PARACAL_.*NOTFOUND$' "build/$preset/CMakeCache.txt"; then
  echo "configuring and building ($preset); this takes a few minutes the first time"
  cmake --preset "$preset" >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
fi
cmake --build --preset "$preset" ${1:+--target "$@"} >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
