#!/usr/bin/env bash
# Builds the page of reports, web/built, from web/: page.sh. page.sh --check builds it in build/page and compares. The page is kept in the repository, so a build of
# the program needs neither Node.js nor npm. This script needs the packages of the group `test` (tools/setup.sh).
set -euo pipefail
cd "$(dirname "$0")/.."

case ${1:-} in
  '') node web/build.mjs web/built ;;
  --check)
    rm -rf build/page
    node web/build.mjs build/page
    diff --brief --recursive build/page web/built || { echo "web/built: expected the page that web/build.mjs builds, got a different one; run tools/page.sh" >&2; exit 1; }
    echo "page: web/built is up to date"
    ;;
  *) echo "page: expected nothing or --check, got $1" >&2; exit 2 ;;
esac
