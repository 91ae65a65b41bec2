#!/usr/bin/env bash
# Builds the live page, build/live/paracal-live.html, the program as WebAssembly in one file (docs/live-page.md): live_page.sh [test]; with `test` its tests
# run, too, against the program of build/ci or build/release. Wants the packages of the group `live` (tools/setup.sh live). The first time it fetches the
# sources of four small libraries as Debian has them, as its packages hold them for this machine only; later it builds what has changed.
set -euo pipefail
cd "$(dirname "$0")/.."
build=$PWD/build/live
command -v emcc >/dev/null || { echo "live_page: expected emscripten, got none; tools/setup.sh live installs it" >&2; exit 1; }

tools/debian_sources.sh "$build" fmtlib libcsv libmd nlopt

export NODE_PATH=/usr/share/nodejs  # where Debian has what emscripten's linker reads JavaScript with
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if [[ ! -f $build/build.ninja ]]; then
  echo "configuring and building (live); this takes a quarter of an hour the first time"
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
