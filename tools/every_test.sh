#!/usr/bin/env bash
# Runs the tests of a built preset: every_test.sh PRESET [options of ctest]. One that is skipped checks nothing, so it fails as one that fails does.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=$1
ctest --preset "$preset" --progress --output-junit tests.xml "${@:2}"
skipped=$(sed -n 's/.*<testcase name="\([^"]*\)".* status="\(notrun\|disabled\)".*/  \1/p' "build/$preset/tests.xml")
if [[ -n $skipped ]]; then
  printf 'skipped, and a test that is skipped checks nothing:\n%s\n' "$skipped" >&2
  grep -A 1 ': Skipped$' "build/$preset/Testing/Temporary/LastTest.log" | grep -v -- '^--$' >&2 || true
  exit 1
fi
