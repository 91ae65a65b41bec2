#!/usr/bin/env bash
# clang-format over every source file, the type checker of TypeScript over web/, and clang-tidy over the translation units of the library, the program, the Python module and the
# examples that the last 10 commits or the working tree changed, and one that includes each header they changed; with PARACAL_TIDY_ALL over all of
# them, and with clang's analyzer, which takes as long again.
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
  (($# > 1)) || return 0
  printf '%s\n' "${@:2}" | xargs -P "$(nproc)" -n 1 clang-tidy -p build/tidy --quiet --warnings-as-errors='*' --checks="$1" 2>/dev/null
}
units() {  # of these patterns, those to look at
  if [[ -n ${PARACAL_TIDY_ALL:-} ]] || ! git rev-parse -q --verify HEAD~10 >/dev/null; then
    git ls-files "$@"
    return
  fi
  local changed headers
  mapfile -t changed < <(git diff --name-only --diff-filter=d HEAD~10 -- "$@")
  mapfile -t headers < <(git diff --name-only --diff-filter=d HEAD~10 -- '*.hpp')
  for header in "${headers[@]}"; do
    # Its own unit, or the first that includes it.
    own=$(git ls-files "$@" | grep "/$(basename "$header" .hpp).cpp$" | head -n 1 || true)
    changed+=("${own:-$(git grep -l "$(basename "$header")\"" -- "$@" | head -n 1 || true)}")
  done
  printf '%s\n' "${changed[@]}" | sed '/^$/d' | sort -u
}
mapfile -t library < <(units 'src/*.cpp' 'examples/*.cpp')
mapfile -t program < <(units 'apps/*.cpp' 'python/*.cpp')
analyzer='-clang-analyzer-*'
[[ -n ${PARACAL_TIDY_ALL:-} ]] && analyzer=
tidy "$analyzer" "${library[@]}"
tidy '-clang-analyzer-*' "${program[@]}"  # parsing and printing, where it takes longest and has least to say
echo "clang-tidy: $((${#library[@]} + ${#program[@]})) files clean"
