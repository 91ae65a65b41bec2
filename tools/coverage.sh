#!/usr/bin/env bash
# Builds and runs the tests once more to count the lines that they run, folder by folder, against floors that may only be raised.
set -euo pipefail
cd "$(dirname "$0")/.."

declare -A floor=([src/calibration]=95 [src/io]=80 [src/printer]=95 [src/tolerance]=80)
build=build/coverage
tools/build.sh coverage
rm -f "$build"/coverage/*
tools/every_test.sh coverage
objects=()
for program in "$build"/tests/paracal-tests "$build"/tests/paracal-*-tests "$build"/tests/*/paracal-*-tests; do
  [[ -x $program ]] && objects+=(-object "$program")
done
llvm-profdata merge -sparse "$build"/coverage/*.profraw -o "$build/coverage/all.profdata"
below=0
for folder in src/calibration src/io src/printer src/tolerance; do
  share=$(llvm-cov report -instr-profile="$build/coverage/all.profdata" "$build/bin/paracal" "${objects[@]}" "$folder" | awk '/^TOTAL/ { print $10 + 0 }')
  echo "coverage: $folder $share % of its lines (floor ${floor[$folder]})"
  awk -v share="$share" -v floor="${floor[$folder]}" 'BEGIN { exit !(share >= floor) }' || below=1
done
exit $below
