#!/usr/bin/env bash
# Installs packages, builds as run.sh does, and runs every test. A skipped test counts as a failure.
set -euo pipefail
cd "$(dirname "$0")"

rm -f build/parts.txt
preset=release
[[ ${CI:-} == true ]] && preset=ci  # the same with warnings as errors
tools/part.sh "setup" tools/setup.sh
tools/part.sh "build, $preset" tools/build.sh "$preset"
tools/part.sh "tests, $preset" tools/every_test.sh "$preset"
