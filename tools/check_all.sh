#!/usr/bin/env bash
# Everything that .ci/run checks, statistical tests with all their machines (.ci/run: a quarter), and clang-tidy over every file (.ci/run: those
# of the last commits, without its analyzer); then all that is too long for .ci/run, and the site: every check of clang's sanitizers, those of GCC, the live page, the coverage, a minute of each fuzz target,
# and whether the tests notice every mutation of mutations.txt.
set -euo pipefail
cd "$(dirname "$0")/.."

PARACAL_EVERY_MACHINE=1 PARACAL_TIDY_ALL=1 .ci/run
for preset in asan-all asan-gcc; do
  tools/part.sh "build, $preset" tools/build.sh "$preset"
  tools/part.sh "tests, $preset" tools/every_test.sh "$preset"
done
tools/part.sh "site" tools/site.sh
tools/part.sh "packages" tools/check_package.sh ci
tools/setup.sh live
tools/part.sh "live page" tools/live_page.sh test
tools/part.sh "coverage" tools/coverage.sh
tools/part.sh "fuzzing" tools/fuzz.sh 60
tools/part.sh "mutations" tools/mutations.sh
echo "slowest parts:"
sort -rn build/parts.txt | head -n 5
