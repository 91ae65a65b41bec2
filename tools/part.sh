#!/usr/bin/env bash
# Runs a part of the checks and records its time: part.sh NAME COMMAND... It appends a line "WALL CPU NAME" to build/parts.txt (or $PARACAL_PARTS), in seconds. CPU is
# the sum over all processes that it started and waited for.
set -euo pipefail
cd "$(dirname "$0")/.."

mkdir -p build
code=0
"${@:2}" || code=$?
read -ra stat </proc/$$/stat  # the 16th and 17th: user and system time of children, in hundredths of a second
printf '%5d %6d %s\n' "$SECONDS" $(((stat[15] + stat[16]) / 100)) "$1" >>"${PARACAL_PARTS:-build/parts.txt}"
exit "$code"
