#!/usr/bin/env bash
# clang-format over every source file, the type checker of TypeScript over web/ and clang-tidy over every translation unit of the library, the program and the examples.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/setup.sh
mapfile -t sources < <(git ls-files '*.cpp' '*.hpp')
clang-format --dry-run --Werror "${sources[@]}"
echo "clang-format: ${#sources[@]} files clean"
(cd web && node_modules/.bin/tsc --noEmit)
echo "tsc: web/ clean"

cmake --preset tidy >/dev/null
tidy() {  # CHECKS FILE ...
  printf '%s\n' "${@:2}" | xargs -P "$(nproc)" -n 1 clang-tidy -p build/tidy --quiet --warnings-as-errors='*' --checks="$1" 2>/dev/null
}
mapfile -t library < <(git ls-files 'src/*.cpp' 'examples/*.cpp')
mapfile -t program < <(git ls-files 'apps/*.cpp')
tidy '' "${library[@]}"
tidy '-clang-analyzer-*' "${program[@]}"  # parsing and printing, where it takes longest and has least to say
echo "clang-tidy: $((${#library[@]} + ${#program[@]})) files clean"
