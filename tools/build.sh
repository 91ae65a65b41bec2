#!/usr/bin/env bash
# Configures (when needed) and builds a preset: build.sh PRESET [TARGET ...]. It shows the output of the compiler only if it fails.
# The program alone and the Python module need fewer packages than the rest. A build that needs more than the one before is configured again.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=$1
shift
log=$(mktemp)
trap 'rm -f "$log"' EXIT
cache=build/$preset/CMakeCache.txt
# The program alone, and the Python module, ask for nothing that the rest needs; where more is wanted than was, all is configured afresh.
parts=() too_little='PARACAL_BUILD_TESTS:BOOL=OFF'
if [[ $* == "paracal-app paracal-manual"* ]]; then
  parts=(-DPARACAL_BUILD_TESTS=OFF -DPARACAL_BUILD_BENCHMARKS=OFF -DPARACAL_BUILD_EXAMPLES=OFF)
  too_little='PARACAL_BUILD_PYTHON:BOOL=OFF'
  [[ $* == *paracal-python ]] || { parts+=(-DPARACAL_BUILD_PYTHON=OFF) too_little=; }
fi
if [[ -n $too_little ]] && grep -qs "$too_little" "$cache"; then rm "$cache"; fi
# Again where a program was missing that setup.sh has installed since: its tests would go on being skipped.
if [[ ! -f build/$preset/build.ninja || ! -f $cache ]] || grep -q '^PARACAL_.*NOTFOUND$' "$cache"; then
  echo "configuring and building ($preset); this takes a few minutes the first time"
  cmake --preset "$preset" "${parts[@]}" >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
fi
cmake --build --preset "$preset" ${1:+--target "$@"} >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
