#!/usr/bin/env bash
# Runs a part of the checks and notes how long it took: part.sh NAME COMMAND... ; .ci/run prints the slowest.
set -euo pipefail
cd "$(dirname "$0")/.."

mkdir -p build
"${@:2}"
printf '%5d s  %s\n' "$SECONDS" "$1" >>build/parts.txt
