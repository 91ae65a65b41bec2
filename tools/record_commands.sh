#!/usr/bin/env bash
# Records the output of the commands of tests/corpus/commands.txt and their files: tools/record_commands.sh PROGRAM FOLDER
# FOLDER/NNN.out, NNN.err, NNN.rc: line NNN of the list; FOLDER/files: the files that they write. To compare two programs, run
# node tools/compare_records.mjs ONE OTHER.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
[[ $# -eq 2 ]] || { echo "expected: $0 PROGRAM FOLDER" >&2; exit 2; }
program=$(realpath "$1")
mkdir -p "$2"
out=$(realpath "$2")
[[ -z $(ls -A "$out") ]] || { echo "$out: expected an empty folder" >&2; exit 2; }
mkdir "$out/files"
"$root/tools/samples.sh" "$out/files"
cp "$root"/tests/corpus/files/* "$out/files"
cd "$out/files"
number=0
while IFS= read -r line; do
  number=$((number + 1))
  [[ -z $line || $line == \#* ]] && continue
  read -ra words <<< "$line"
  name=$(printf '%03d' "$number")
  code=0
  "$program" "${words[@]}" > "$out/$name.out" 2> "$out/$name.err" < /dev/null || code=$?
  echo "$code" > "$out/$name.rc"
done < "$root/tests/corpus/commands.txt"
