#!/usr/bin/env bash
# Runs clang-format on every source file, the type checker of TypeScript on web/, and clang-tidy: lint.sh [K/N], every N-th unit, from the K-th on.
# clang-tidy checks the units of the library, the program, the Python module and the examples that differ from the last commit that passed here (if unknown: the
# last 10 commits), and one unit for each changed header. With PARACAL_TIDY_ALL it checks all units, also with clang's analyzer, which doubles the time.
# A unit that has passed with the same includes is not checked again, in any folder.
set -euo pipefail
cd "$(dirname "$0")/.."

share=${1:-1/1}
tools/setup.sh
mapfile -t sources < <(git ls-files '*.cpp' '*.hpp')
clang-format --dry-run --Werror "${sources[@]}"
echo "clang-format: ${#sources[@]} files, no findings"
mkdir -p build/lint
(cd web && node_modules/.bin/tsc --noEmit --incremental --tsBuildInfoFile ../build/lint/tsc)
echo "tsc: web/, no findings"

cmake --preset tidy >/dev/null
passed=build/lint/passed
since=$(cat "$passed" 2>/dev/null || true)
git merge-base --is-ancestor "${since:-none}" HEAD 2>/dev/null || since=HEAD~10
units() {  # of these patterns, those to check
  if [[ -n ${PARACAL_TIDY_ALL:-} ]] || ! git rev-parse -q --verify "$since" >/dev/null; then
    git ls-files "$@"
    return
  fi
  local changed headers
  mapfile -t changed < <(git diff --name-only --diff-filter=d "$since" -- "$@")
  mapfile -t headers < <(git diff --name-only --diff-filter=d "$since" -- '*.hpp')
  for header in "${headers[@]}"; do
    # Its own unit, or the first that includes it.
    own=$(git ls-files "$@" | grep "/$(basename "$header" .hpp).cpp$" | head -n 1 || true)
    changed+=("${own:-$(git grep -l "$(basename "$header")\"" -- "$@" | head -n 1 || true)}")
  done
  printf '%s\n' "${changed[@]}" | sed '/^$/d' | sort -u
}

export cache=${XDG_CACHE_HOME:-$HOME/.cache}/paracal-lint
mkdir -p "$cache"
find "$cache" -type f -mtime +60 -delete
states() {  # UNIT...: "HASH UNIT" of each, of all that clang-tidy reads for it; the headers of the system stand for themselves by their packages
  local folder=build/lint/states files
  rm -rf "$folder"
  mkdir "$folder"
  mapfile -t files < <(git ls-files --cached --others --exclude-standard --deduplicate apps examples include python src | xargs -d '\n' ls -d 2>/dev/null)
  {
    { cat .clang-tidy && clang-tidy --version && dpkg-query -W '*-dev'; } | sha256sum | sed 's/^/E /'
    printf '%s\n' "${files[@]}" | git hash-object --stdin-paths | paste -d ' ' - <(printf '%s\n' "${files[@]}") | sed 's/^/B /'
    grep -HoE '^ *# *include *["<][^">]+' "${files[@]}" | sed 's/^/I /'
    sed "s#$PWD/##g; s/^/C /" build/tidy/compile_commands.json && echo
    printf 'U %s\n' "$@"
  } | awk -v FOLDER="$folder" -f tools/units.awk
  (cd "$folder" && sha256sum -- * | sed 's/  / /; s#+#/#g')
}
check() {  # HASH UNIT [analyzed]: a unit is clean with the analyzer only where it is without
  if [[ -e $cache/$1${3:-} ]]; then
    touch "$cache/$1${3:-}"
    return
  fi
  local checks='-clang-analyzer-*'
  [[ -z ${3:-} ]] || checks=
  echo "$2" >>build/lint/looked_at
  clang-tidy -p build/tidy --quiet --warnings-as-errors='*' --checks="$checks" "$2" 2>/dev/null || return 1
  touch "$cache/$1" "$cache/$1${3:-}"
}
export -f check
: >build/lint/looked_at
mapfile -t chosen < <({ units 'src/*.cpp' 'examples/*.cpp'; units 'apps/*.cpp' 'python/*.cpp'; } | awk -v k="${share%/*}" -v n="${share#*/}" 'NR % n == k % n')
if ((${#chosen[@]})); then
  states "${chosen[@]}" >build/lint/states.txt
  # Not for parsing and printing, where the analyzer takes longest and finds least.
  [[ -z ${PARACAL_TIDY_ALL:-} ]] || sed -i -E '/ (src|examples)\//s/$/ analyzed/' build/lint/states.txt
  xargs -P "$(nproc)" -L 1 bash -c 'check "$@"' check <build/lint/states.txt
fi
echo "clang-tidy: ${#chosen[@]} files, no findings; $(wc -l <build/lint/looked_at) of them checked now"
[[ $share != 1/1 ]] || git rev-parse HEAD >"$passed"
