#!/usr/bin/env bash
# Runs the commands of the documents as they are printed: run.sh PROGRAM [DOCUMENT...]. Each document in a new folder that holds the samples; exit
# code 0 is expected, or what a comment behind the command says ("# exit code 1"). Commands that cannot run here stand in not_run.txt.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
program=$(realpath "$1")
shift
documents=("$@")
all=$(($# == 0))
((all)) && documents=("$root"/README.md "$root"/CONTRIBUTING.md "$root"/samples/README.md "$root"/docs/*.md "$root"/data/*/README.md)

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/bin" "$scratch/kept"
ln -s "$program" "$scratch/bin/paracal"
PATH=$scratch/bin:$PATH

# The examples of the manual pages, as one more document; those of calibrate first, whose result others read.
if ((all)); then
  mkdir "$scratch/pages"
  paracal manual "$scratch/pages"
  examples=$scratch/examples-of-manual-pages.md
  awk '/^\.nf$/ { getline; gsub(/\\-/, "-"); print "\n    " $0 "\n" }' "$scratch/pages/paracal-calibrate.1" "$scratch"/pages/*.1 >"$examples"
  documents+=("$examples")
fi

patterns=() met=()
while IFS= read -r line; do
  [[ -z $line || $line == \#* ]] && continue
  patterns+=("${line%%  *}") met+=(0)
done <"$root/tests/documents/not_run.txt"

# listed COMMAND: whether it is not to run.
listed() {
  local k
  for k in "${!patterns[@]}"; do
    # shellcheck disable=SC2053  # a pattern it is
    [[ $1 == ${patterns[k]} ]] && { met[k]=1; return 0; }
  done
  return 1
}

fresh_folder() {
  rm -rf "$scratch/folder"
  mkdir "$scratch/folder"
  "$root/tools/samples.sh" "$scratch/folder"
}

# state COMMAND: it, what it is to end with, and the files that it names as they are.
state() {
  local word
  echo "$expected $1"
  for word in ${1//,/ }; do [[ ! -f $scratch/folder/$word ]] || cat "$scratch/folder/$word"; done
}

# done_before COMMAND: whether it ran in the same state, maybe for another document; what it left then is put here.
done_before() {
  kept=$scratch/kept/$(state "$1" | sha256sum | cut -d ' ' -f 1)
  [[ -d $kept ]] && cp -a "$kept/." "$scratch/folder"
}

ran=0 failures=0
run() {  # DOCUMENT LINE COMMAND
  local code=0
  touch "$scratch/before"
  sleep 0.01  # so that what it writes is newer
  (cd "$scratch/folder" && bash -c "set -o pipefail; $3") >"$scratch/said" 2>&1 </dev/null || code=$?
  ran=$((ran + 1))
  [[ -z ${VERBOSE:-} ]] || echo "$SECONDS s: $3"
  if ((code == expected)); then
    mkdir "$kept"
    (cd "$scratch/folder" && find . -type f -newer "$scratch/before" -exec cp -a --parents -t "$kept" {} +)
    return
  fi
  failures=$((failures + 1))
  printf '%s:%s: %s\n  expected exit code %s, got %s\n' "${1#"$root"/}" "$2" "$3" "$expected" "$code"
  tail -n 5 "$scratch/said"
}

for document in "${documents[@]}"; do
  commands=$(awk -f "$root/tests/documents/commands.awk" "$document")
  [[ -n $commands ]] || continue
  fresh_folder
  while IFS=$'\t' read -r line command; do
    plain=${command%%  #*}
    plain=${plain%"${plain##*[! ]}"}
    expected=0
    [[ $command =~ \#.*exit\ code\ ([0-4]) ]] && expected=${BASH_REMATCH[1]}
    listed "$plain" || done_before "$plain" || run "$document" "$line" "$command"
  done <<<"$commands"
  # Samples that a document makes again come out as they are.
  for sample in "$root"/samples/*; do
    [[ $document == "$root/samples/README.md" ]] || break
    awk -f "$root/tests/documents/same_table.awk" "$sample" "$scratch/folder/${sample##*/}" || failures=$((failures + 1))
  done
done

# The first commands of README.md, in an empty folder one after the other; they print what README.md shows behind them, "..." aside.
first_commands() {
  local commands shown line said
  commands=$(awk '/^    paracal / { begun = 1 } begun && !/^    / { exit } begun' "$root/README.md")
  shown=$(awk '/^    paracal / { begun = 1 } begun && /^```/ { if (inside) exit; inside = 1; next } inside' "$root/README.md")
  mkdir "$scratch/empty"
  said=$(cd "$scratch/empty" && bash -ec "$commands") || { echo "README.md: the first commands failed in an empty folder"; return 1; }
  while IFS= read -r line; do
    [[ $said == *"${line%...}"* ]] || { echo "README.md: the first commands do not print: $line"; return 1; }
  done <<<"$shown"
}

if ((all)); then
  first_commands || failures=$((failures + 1))
  for k in "${!patterns[@]}"; do
    ((met[k])) || { echo "not_run.txt: no document has a command like ${patterns[k]}"; failures=$((failures + 1)); }
  done
fi
echo "$ran commands of ${#documents[@]} documents ran; $failures failures"
((failures == 0))
