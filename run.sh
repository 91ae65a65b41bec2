#!/usr/bin/env bash
# Sets up, builds, and does the main job: calibrates the published robot of Huang et al. (2016) from its published
# measurements, sets the published numbers beside ours, and writes a report.
set -euo pipefail
cd "$(dirname "$0")"

tools/setup.sh
tools/build.sh release paracal-app

paracal=build/release/bin/paracal
results=build/huang2016
mkdir -p "$results"
"$paracal" calibrate --measurements data/huang2016/distances.csv --poses data/huang2016/poses.csv \
  --out "$results/calibration.json" >"$results/calibration.txt"
"$paracal" reproduce huang2016 --out "$results/reproduction.txt"
{
  echo "paracal report: the robot of Huang, Bai, Mei and Chetwynd (2016), doi 10.1115/1.4034788"
  echo
  echo "1. Encoder offsets from the six distances that a laser tracker measured"
  echo
  cat "$results/calibration.txt"
  echo
  echo "2. Published numbers beside ours"
  echo
  cat "$results/reproduction.txt"
} >"$results/report.txt"

cat "$results/reproduction.txt"
echo
sed -n '/^calibration/,/distances, rms/p' "$results/calibration.txt"
echo "program:     $paracal"
echo "calibration: $results/calibration.json"
echo "report:      $results/report.txt"
