#!/usr/bin/env bash
# Checks that the tests detect faults: mutations.sh [K/N [FILES]]. It builds a copy of the sources with every mutation of tools/mutations.txt, inactive. It then
# activates one after the other (every N-th, from the K-th on; 0/N only builds) and expects one of the listed tests to fail. With FILES, a pattern such as
# 'src/calibration/*', it tries only the mutations of these files. With PARACAL_EVERY_MACHINE the tests use their full number of machines.
set -euo pipefail
cd "$(dirname "$0")/.."

share=${1:-1/1} pattern=${2:-*}
build=$PWD/build/mutations
tree=$build/tree
mkdir -p "$tree"
# All but the files with mutations; those that had some before, too.
grep -oE '^[^# ]+' tools/mutations.txt | sort -u >"$build/mutated"
{ grep -rl '^static bool awake' "$tree/src" 2>/dev/null || true; } | sed "s#^$tree/##" | { grep -vxFf "$build/mutated" || true; } | sed "s#^#$tree/#" | xargs -r touch -d @0
git ls-files --cached --others --exclude-standard | grep -vxFf "$build/mutated" | xargs -d '\n' cp --parents --no-dereference -u -t "$tree"

# Each expression is replaced where the environment selects it, so that one build serves all mutations.
readonly kAwake='#include <cstdlib>
static bool awake(int mutation) {
  static const char* const chosen = std::getenv("PARACAL_MUTATION");
  return chosen != nullptr && std::atoi(chosen) == mutation;
}
'
mutations=() tests=() programs=() of_files=()  # "FILE: EXPRESSION => OTHER"; what is to notice it; where those are; of them, those of FILES
declare -A texts befores  # by file, which may stand more than once
file='' program='' filter='' original='' text='' before=()
while IFS= read -r line; do
  case $line in
    '' | '#'*) ;;
    ' '*)
      old=${line#"${line%%[! ]*}"} new=${line#*' => '} old=${old%%' =>'*}
      without=${original/"$old"/}
      if [[ $line != *' => '* || $without == "$original" || $without == *"$old"* || $text != *"$old"* ]]; then
        echo "mutations.txt: expected an expression that occurs once in $file without an earlier one inside, ' => ' and a replacement, got: $line" >&2
        exit 2
      fi
      for one in "${before[@]}"; do
        if [[ -n $one && ${one#*' => '} == *"$old"* && ${one%%' => '*} != *"$old"* ]]; then
          echo "mutations.txt: expected $old of $file before $one, which inserts it" >&2
          exit 2
        fi
      done
      before+=("$old => $new")
      mutations+=("$file: $old => $new") tests+=("$filter") programs+=("$program")
      # shellcheck disable=SC2053  # a pattern it is
      [[ $file != $pattern ]] || of_files+=($((${#mutations[@]} - 1)))
      asleep="!awake(${#mutations[@]}) ? ($old) : ($new)"
      [[ $new == nothing ]] && asleep="!awake(${#mutations[@]}) ? void($old) : void()"
      text=${text/"$old"/"($asleep)"}
      texts[$file]=$text befores[$file]+=$'\n'"$old => $new"
      ;;
    *)
      read -r file program filter <<<"$line"
      original=$(<"$file") text=${texts[$file]:-$original}
      mapfile -t before <<<"${befores[$file]:-}"
      ;;
  esac
done <tools/mutations.txt
for file in "${!texts[@]}"; do
  mkdir -p "$tree/$(dirname "$file")"
  [[ $kAwake${texts[$file]} == "$(cat "$tree/$file" 2>/dev/null)" ]] || printf '%s\n' "$kAwake${texts[$file]}" >"$tree/$file"
done

((${#of_files[@]})) || { echo "mutations.txt: expected mutations of $pattern, got none" >&2; exit 2; }
chosen=()
for ((k = ${share%/*} - 1; k < ${#of_files[@]}; k += ${share#*/})); do ((k < 0)) && break || chosen+=("${of_files[k]}"); done
wanted=("${chosen[@]}")
((${#chosen[@]})) || wanted=("${of_files[@]}")

quietly() { "$@" >"$build/log" 2>&1 || { cat "$build/log" >&2; exit 1; }; }
# Each file is compiled alone, because their first lines would conflict.
quietly cmake -S "$tree" --preset release -B "$build/ci" -DPARACAL_UNITY=OFF -DCMAKE_UNITY_BUILD=OFF
mapfile -t targets < <(for k in "${wanted[@]}"; do echo "${programs[k]}"; done | sort -u)
quietly cmake --build "$build/ci" --target "${targets[@]}"

awaken() {  # MUTATION PROGRAM TESTS: 0 where a test fails
  ! PARACAL_MUTATION=$1 timeout 600 "$build/ci/tests/$2" --gtest_filter="$3" --gtest_fail_fast --gtest_brief=1 >"$build/$1.log" 2>&1
}
try() {
  awaken "$@" || echo "$1" >>"$build/survivors"
}
export build
export -f awaken try
: >"$build/survivors"
mapfile -t all < <(for k in "${chosen[@]}"; do printf '%s\n' "${programs[k]} ${tests[k]}"; done | sort -u)
mkdir -p "$build/passed"
for one in "${all[@]}"; do
  read -r program filter <<<"$one"
  passed=$build/passed/$(cksum <<<"${PARACAL_EVERY_MACHINE:-} $one" | cut -d ' ' -f 1)
  [[ ! $passed -nt $build/ci/tests/$program ]] || continue  # another share has seen it
  if awaken 0 "$program" "$filter"; then
    cat "$build/0.log" >&2
    echo "mutations: expected $one to pass without a mutation" >&2
    exit 1
  fi
  touch "$passed"
done
for k in "${chosen[@]}"; do
  printf '%s\0' $((k + 1)) "${programs[k]}" "${tests[k]}"
done | xargs -r -0 -P "$(nproc)" -n 3 bash -c 'try "$@"' try
while read -r survivor; do
  echo "no test of ${tests[survivor - 1]} detects ${mutations[survivor - 1]}" >&2
done < <(sort -n "$build/survivors")
echo "mutations: ${#chosen[@]} of ${#mutations[@]} tried, $(wc -l <"$build/survivors") not detected"
[[ ! -s $build/survivors ]]
