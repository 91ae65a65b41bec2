#!/usr/bin/env bash
# What ./run.sh ends with, with a program that is built already: first_result_test.sh PROGRAM
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
program=$(realpath "$1")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
folder="$scratch/results"
fail() { echo "$1, got:" >&2; cat "$scratch/out" >&2; exit 1; }
for run in first second; do
  "$root/tools/first_result.sh" "$program" "$folder" >"$scratch/out" 2>&1 || fail "$run run: expected exit code 0"
  mapfile -t lines <"$scratch/out"
  ((${#lines[@]} == 3)) || fail "$run run: expected three lines"
  [[ ${lines[0]} == "Found: the measured distances of the published robot agree within 0.03 mm after calibration (before: 2.33 mm)." ]] || fail "expected what was found"
  [[ ${lines[1]} == "Look at: $folder/report.html "* ]] || fail "expected where to look"
  [[ ${lines[2]} == "Try next: $program demo "* ]] || fail "expected what to try next"
done
for file in report.html calibration.txt calibration.json reproduction.txt; do
  [[ -s $folder/$file ]] || fail "expected $file"
done
tail -n 2 "$root/run.sh" | grep -qx 'tools/first_result.sh build/release/bin/paracal build/huang2016' || { echo "expected run.sh to end with tools/first_result.sh" >&2; exit 1; }
