#!/usr/bin/env bash
# Installs packages, builds, and does the main job: it calibrates the published robot of Huang et al. (2016) from its published
# measurements, compares the published numbers with ours, and writes an HTML report.
set -euo pipefail
cd "$(dirname "$0")"

tools/setup.sh run
tools/build.sh release paracal-app paracal-manual

paracal=build/release/bin/paracal
results=build/huang2016
mkdir -p "$results"
"$paracal" calibrate --measurements data/huang2016/distances.csv --poses data/huang2016/poses.csv \
  --out "$results/calibration.json" >"$results/calibration.txt"
"$paracal" reproduce huang2016 --out "$results/reproduction.txt" --report "$results/report.html"

cat "$results/reproduction.txt"
echo
sed -n '/^calibration/,/residuals of distances/p' "$results/calibration.txt"
echo "program:     $paracal"
echo "calibration: $results/calibration.json"
echo "report:      $results/report.html"
