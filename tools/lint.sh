#!/usr/bin/env bash
# clang-format over every source file and clang-tidy over every translation unit of the library, the program and the examples.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/setup.sh
mapfile -t sources < <(git ls-files '*.cpp' '*.hpp')
clang-format --dry-run --Werror "${sources[@]}"
echo "clang-format: ${#sources[@]} files clean"

cmake --preset tidy >/dev/null
mapfile -t units < <(git ls-files 'src/*.cpp' 'apps/*.cpp' 'examples/*.cpp')
printf '%s\n' "${units[@]}" | xargs -P "$(nproc)" -n 1 clang-tidy -p build/tidy --quiet --warnings-as-errors='*' 2>/dev/null
echo "clang-tidy: ${#units[@]} files clean"
