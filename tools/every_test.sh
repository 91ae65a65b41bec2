#!/usr/bin/env bash
# Runs the tests of a built preset: every_test.sh PRESET [options of ctest]. One that is skipped checks nothing, so it fails as one that fails does.
# Of the preset asan those are left to check_all.sh that take minutes there, see tests/minutes_under_sanitizers.txt.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=$1
left_out=()
if [[ $preset == asan ]]; then
  minutes="^($(grep -v '^#' tests/minutes_under_sanitizers.txt | paste -sd '|'))$"
  left_out=(--exclude-regex "$minutes")
  # ctest passes over an expression that it cannot read.
  ctest --preset "$preset" -N --tests-regex "$minutes" | grep -q '^Total Tests: [1-9]' || { echo "tests/minutes_under_sanitizers.txt: expected names of tests, got none" >&2; exit 1; }
fi
ctest --preset "$preset" --progress --output-junit tests.xml "${left_out[@]}" "${@:2}"
skipped=$(sed -n 's/.*<testcase name="\([^"]*\)".* status="\(notrun\|disabled\)".*/  \1/p' "build/$preset/tests.xml")
if [[ -n $skipped ]]; then
  printf 'skipped, and a test that is skipped checks nothing:\n%s\n' "$skipped" >&2
  grep -A 1 ': Skipped$' "build/$preset/Testing/Temporary/LastTest.log" | grep -v -- '^--$' >&2 || true
  exit 1
fi
