#!/usr/bin/env bash
# Installs packages, builds, and does the main job: it calibrates the published robot of Huang et al. (2016) from its published
# measurements, compares the published numbers with ours, and writes an HTML report.
set -euo pipefail
cd "$(dirname "$0")"

tools/setup.sh run
tools/build.sh release paracal-app paracal-manual
tools/first_result.sh build/release/bin/paracal build/huang2016
