#!/usr/bin/env bash
# Runs the tests of a built preset: every_test.sh PRESET [K/N] [options of ctest]; with K/N every N-th process of them, from the K-th on. A skipped test counts as
# a failure.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=$1
shift
share=()
if [[ ${1:-} =~ ^([0-9]+)/([0-9]+)$ ]]; then
  share=(--tests-information "${BASH_REMATCH[1]},,${BASH_REMATCH[2]}")
  shift
fi
reports=build/$preset/reports
rm -rf "$reports"
ctest --preset "$preset" --progress "${share[@]}" "$@"
skipped=$(grep -ho '<testcase name="[^"]*" [^>]*result="skipped"[^>]*' "$reports"/*.xml 2>/dev/null | sed 's/<testcase name="\([^"]*\)".*classname="\([^"]*\)".*/  \2.\1/' || true)
if [[ -n $skipped ]]; then
  printf 'expected every test to run, got skipped tests:\n%s\n' "$skipped" >&2
  exit 1
fi
