#!/usr/bin/env bash
# Appends the parts of the last .ci/run to tools/ci_parts.csv, so that their growth is seen: record_parts.sh. Run it at each release, after .ci/run on a quiet
# machine, and commit the file.
set -euo pipefail
cd "$(dirname "$0")/.."
[[ -s build/parts.txt ]] || { echo "record_parts: expected build/parts.txt of a run of .ci/run, got none" >&2; exit 1; }
[[ -s tools/ci_parts.csv ]] || echo "date,commit,part,wall_s,cpu_s" >tools/ci_parts.csv
awk -v date="$(date -u +%F)" -v commit="$(git rev-parse --short=12 HEAD)" '{ wall = $1; cpu = $2; $1 = $2 = ""; sub(/^ +/, ""); printf "%s,%s,\"%s\",%d,%d\n", date, commit, $0, wall, cpu }' build/parts.txt >>tools/ci_parts.csv
