#!/usr/bin/env bash
# Builds and runs the tests to count the executed lines of each folder and compares them with minimum percentages, which may only be raised:
# coverage.sh [K/N], a share of the tests. The last share of a build prints the sum.
set -euo pipefail
cd "$(dirname "$0")/.."

declare -A floor=([src/calibration]=95 [src/io]=80 [src/printer]=95 [src/tolerance]=80)
share=${1:-1/1}
build=$PWD/build/coverage
tools/build.sh coverage
shopt -s nullglob
programs=("$build"/tests/paracal-tests "$build"/tests/paracal-*-tests "$build"/tests/*/paracal-*-tests)
newest=$(ls -td "$build/bin/paracal" "${programs[@]}" | head -n 1)
mkdir -p "$build/coverage"
# Counts of another build or of other shares are not valid.
find "$build/coverage" -mindepth 1 -maxdepth 1 ! \( -name "*-of-${share#*/}" -newer "$newest" \) -exec rm -r {} +
counts=$build/coverage/${share%/*}-of-${share#*/}
rm -rf "$counts"
LLVM_PROFILE_FILE=$counts.new/%4m.profraw tools/every_test.sh coverage "$share"
mv "$counts.new" "$counts"
all=$(find "$build/coverage" -mindepth 1 -maxdepth 1 -name "*-of-${share#*/}" | wc -l)
((all == ${share#*/})) || { echo "coverage: $all of ${share#*/} shares counted"; exit 0; }

objects=()
for program in "${programs[@]}"; do objects+=(-object "$program"); done
llvm-profdata merge -sparse "$build"/coverage/*/*.profraw -o "$build/coverage.profdata"
below=0
for folder in src/calibration src/io src/printer src/tolerance; do
  lines=$(llvm-cov report -instr-profile="$build/coverage.profdata" "$build/bin/paracal" "${objects[@]}" "$folder" | awk '/^TOTAL/ { print $10 + 0 }')
  echo "coverage: $folder $lines % of the lines (minimum ${floor[$folder]} %)"
  awk -v share="$lines" -v floor="${floor[$folder]}" 'BEGIN { exit !(share >= floor) }' || below=1
done
exit $below
