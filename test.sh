#!/usr/bin/env bash
# Sets up, builds, and runs every test, none skipped: as released, and once more under the address and undefined-behaviour sanitizers.
set -euo pipefail
cd "$(dirname "$0")"

rm -f build/parts.txt
tools/part.sh "set-up" tools/setup.sh
release=release
[[ ${CI:-} == true ]] && release=ci  # the same with warnings as errors
for preset in "$release" asan; do
  tools/part.sh "build, $preset" tools/build.sh "$preset"
  tools/part.sh "tests, $preset" tools/every_test.sh "$preset"
done
