#!/usr/bin/env bash
# Builds the live page, build/live/paracal-live.html, the program as WebAssembly in one file (docs/live-page.md): live_page.sh [test]. With `test` it also compares
# the page with the program of build/ci or build/release. It needs the packages of the group `live` (tools/setup.sh live). The first run downloads Debian's sources of
# four small libraries, because Debian's packages contain only builds for this machine. Later runs build what has changed.
set -euo pipefail
cd "$(dirname "$0")/.."
build=$PWD/build/live
command -v emcc >/dev/null || { echo "live_page: expected emscripten, got none; tools/setup.sh live installs it" >&2; exit 1; }

tools/debian_sources.sh "$build" fmtlib libcsv libmd nlopt

export NODE_PATH=/usr/share/nodejs  # Debian's JavaScript parser for emscripten's linker
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if [[ ! -f $build/build.ninja ]]; then
  echo "configuring and building (live); this takes 15 minutes the first time"
  cmake --preset live >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
fi
cmake --build --preset live --target paracal-app >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
node web/build_live.mjs "$build" "$build/paracal-live.html"

# As a command, for comparisons with the program itself.
printf '#!/bin/sh\nexec node "%s" "%s" "$@"\n' "$PWD/web/live_program.mjs" "$build" >"$build/paracal"
chmod +x "$build/paracal"

if [[ ${1:-} == test ]]; then
  program=build/ci/bin/paracal
  [[ -x $program ]] || program=build/release/bin/paracal
  PARACAL=$program LIVE=$build node --test web/tests/live.test.mjs
fi
