#!/usr/bin/env bash
# Calibrates the published robot with a program, and says in three lines what was found, where to look and what to try next: first_result.sh PROGRAM FOLDER
set -euo pipefail
cd "$(dirname "$0")/.."
export LC_ALL=C
program=$1 folder=$2
mkdir -p "$folder"
"$program" calibrate --measurements data/huang2016/distances.csv --poses data/huang2016/poses.csv \
  --out "$folder/calibration.json" >"$folder/calibration.txt"
"$program" reproduce huang2016 --out "$folder/reproduction.txt" --report "$folder/report.html" >/dev/null

# largest_error before|after: of a distance, mm.
largest_error() {
  sed -n "/^  \"$1\": {/,/^  }/s/^ *\"max_abs_distance_mm\": \([0-9.e+-]*\).*/\1/p" "$folder/calibration.json"
}
printf 'Found: the measured distances of the published robot agree within %.2f mm after calibration (before: %.2f mm).\n' \
  "$(largest_error after)" "$(largest_error before)"
echo "Look at: $folder/report.html (in a browser), $folder/calibration.txt and $folder/calibration.json"
echo "Try next: $program demo (or with your robot: $program robot --help)"
