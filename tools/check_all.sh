#!/usr/bin/env bash
# Everything that .ci/run checks, statistical tests with all their machines (.ci/run: a quarter), and clang-tidy over every file (.ci/run: those
# of recent commits).
set -euo pipefail
cd "$(dirname "$0")/.."

export PARACAL_EVERY_MACHINE=1 PARACAL_TIDY_ALL=1
exec .ci/run
