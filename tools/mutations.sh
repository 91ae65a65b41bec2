#!/usr/bin/env bash
# Whether the tests notice what they are there for: mutations.sh [K/N]. Builds a copy of the sources that holds every mutation of
# tools/mutations.txt, asleep; wakes one after the other (every N-th, from the K-th on) and expects one of the tests named with it to fail.
set -euo pipefail
cd "$(dirname "$0")/.."

share=${1:-1/1}
build=$PWD/build/mutations
tree=$build/tree
mkdir -p "$tree"
# What an earlier run changed is copied again.
{ grep -rlZ '^static bool awake' "$tree/src" 2>/dev/null || true; } | xargs -0 -r touch -d @0
git ls-files -z --cached --others --exclude-standard | xargs -0 cp --parents -u -t "$tree"

# Asleep: an expression that is itself, or another where the environment says so. Nothing is to be compiled again for each.
readonly kAwake='#include <cstdlib>
static bool awake(int mutation) {
  static const char* const chosen = std::getenv("PARACAL_MUTATION");
  return chosen != nullptr && std::atoi(chosen) == mutation;
}
'
mutations=() tests=() programs=()  # "FILE: EXPRESSION => OTHER"; what is to notice it; where those are
file='' program='' filter='' original='' text='' before=()
put_back() { [[ -z $file || $kAwake$text == "$(<"$tree/$file")" ]] || printf '%s\n' "$kAwake$text" >"$tree/$file"; }
while IFS= read -r line; do
  case $line in
    '' | '#'*) ;;
    ' '*)
      old=${line#"${line%%[! ]*}"} new=${line#*' => '} old=${old%%' =>'*}
      without=${original/"$old"/}
      if [[ $line != *' => '* || $without == "$original" || $without == *"$old"* || $text != *"$old"* ]]; then
        echo "mutations.txt: expected an expression that stands once in $file and holds none before it, ' => ' and another, got: $line" >&2
        exit 2
      fi
      for one in "${before[@]}"; do
        if [[ ${one#*' => '} == *"$old"* && ${one%%' => '*} != *"$old"* ]]; then
          echo "mutations.txt: expected $old of $file before $one, which brings it in" >&2
          exit 2
        fi
      done
      before+=("$old => $new")
      mutations+=("$file: $old => $new") tests+=("$filter") programs+=("$program")
      asleep="!awake(${#mutations[@]}) ? ($old) : ($new)"
      [[ $new == nothing ]] && asleep="!awake(${#mutations[@]}) ? void($old) : void()"
      text=${text/"$old"/"($asleep)"}
      ;;
    *)
      put_back
      read -r file program filter <<<"$line"
      original=$(<"$file") text=$original before=()
      ;;
  esac
done <tools/mutations.txt
put_back

[[ -f $build/ci/build.ninja ]] || cmake -S "$tree" --preset release -B "$build/ci" >"$build/log" 2>&1 || { cat "$build/log" >&2; exit 1; }
mapfile -t targets < <(printf '%s\n' "${programs[@]}" | sort -u)
cmake --build "$build/ci" --target "${targets[@]}" >"$build/log" 2>&1 || { cat "$build/log" >&2; exit 1; }

awaken() {  # MUTATION PROGRAM TESTS: 0 where a test fails
  ! PARACAL_MUTATION=$1 timeout 600 "$build/ci/tests/$2" --gtest_filter="$3" --gtest_fail_fast --gtest_brief=1 >"$build/$1.log" 2>&1
}
try() {
  awaken "$@" || echo "$1" >>"$build/survivors"
}
export build
export -f awaken try
: >"$build/survivors"
mapfile -t all < <(for k in "${!mutations[@]}"; do printf '%s\n' "${programs[k]} ${tests[k]}"; done | sort -u)
for one in "${all[@]}"; do
  read -r program filter <<<"$one"
  if awaken 0 "$program" "$filter"; then
    cat "$build/0.log" >&2
    echo "mutations: without any, expected $one to pass" >&2
    exit 1
  fi
done
tried=0
for ((k = ${share%/*} - 1; k < ${#mutations[@]}; k += ${share#*/})); do
  printf '%s\0' $((k + 1)) "${programs[k]}" "${tests[k]}"
  ((++tried))
done | xargs -0 -P "$(nproc)" -n 3 bash -c 'try "$@"' try
while read -r survivor; do
  echo "no test of ${tests[survivor - 1]} notices ${mutations[survivor - 1]}" >&2
done < <(sort -n "$build/survivors")
echo "mutations: $share of ${#mutations[@]} tried, $(wc -l <"$build/survivors") survived"
[[ ! -s $build/survivors ]]
