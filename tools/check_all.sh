#!/usr/bin/env bash
# Runs the checks that are too long for .ci/run: the parts of tools/checks.txt. check_all.sh runs the parts that have not passed with the current
# inputs, so an interrupted run continues. check_all.sh PART... runs these parts in any case (a part with all its shares, or one: mutations.3).
# check_all.sh --list prints the parts and the commit at which each passed. A failed part does not stop the others. Logs and records: build/checks.
set -euo pipefail
cd "$(dirname "$0")/.."

checks=build/checks
mkdir -p "$checks"
names=() inputs=() commands=()
declare -A paths states
part() { names+=("$1") inputs+=("$2") commands+=("${3//'{}'/${4:-}}"); }
while IFS='|' read -r name shares input command; do
  case $name in
    '' | '#'*) continue ;;
    @*) read -r name _ input <<<"$name" ;;
  esac
  words=()
  for word in $input; do words+=("${paths[$word]:-$word}"); done
  if [[ $name == @* ]]; then
    paths[$name]=${words[*]}
    continue
  fi
  name=${name// /}
  read -ra shares <<<"$shares"
  if [[ ${shares[*]} =~ ^[0-9]+$ ]]; then
    for ((k = 1; k <= shares; ++k)); do part "$name.$k" "${words[*]}" "$command" "$k/$shares"; done
  elif ((${#shares[@]})); then
    for share in "${shares[@]}"; do part "$name.$share" "${words[*]}" "$command" "$share"; done
  else
    part "$name" "${words[*]}" "$command"
  fi
done <"${PARACAL_CHECKS:-tools/checks.txt}"

state() {  # "PATH..."
  local from
  read -ra from <<<"$1"
  tools/state.sh "${from[@]}"
}
key() { sha256sum <<<"$1 $2" | cut -d ' ' -f 1; }  # STATE COMMAND
# The record of a part that passed is "KEY COMMIT WALL CPU".
passed() {  # INDEX: whether it passed with the current inputs
  local of=${inputs[$1]} hash
  read -r hash _ 2>/dev/null <"$checks/${names[$1]}.passed" || return 1
  states[$of]=${states[$of]:-$(state "$of")}
  [[ $hash == "$(key "${states[$of]}" "${commands[$1]}")" ]]
}

chosen=()
for k in "${!names[@]}"; do
  if [[ ${1:-} == --list ]]; then
    if passed "$k"; then
      read -r _ commit wall cpu <"$checks/${names[k]}.passed"
      echo "${names[k]}: passed at $commit, $wall s, $cpu CPU-s"
    else
      echo "${names[k]}: not passed yet"
    fi
  elif (($# == 0)); then
    passed "$k" || chosen+=("$k")
  else
    for one; do [[ ${names[k]} != "$one" && ${names[k]%.*} != "$one" ]] || chosen+=("$k"); done
  fi
done
[[ ${1:-} != --list ]] || exit 0
for one; do
  printf '%s\n' "${names[@]}" | grep -qxE "$one|${one//./\\.}\..*" || { echo "check_all: expected a part of tools/checks.txt, got $one" >&2; exit 2; }
done

tools/setup.sh
echo "check_all: ${#chosen[@]} of ${#names[@]} parts to run"
running=
trap '[[ -z $running ]] || kill -TERM -- "-$running"; echo "check_all: interrupted" >&2; exit 130' INT TERM
set -m  # each part is a process group, so that it ends with this script
failed=()
for k in "${chosen[@]}"; do
  name=${names[k]}
  record=$checks/$name.passed
  rm -f "$record" "$checks/parts"
  before=$(state "${inputs[k]}")
  PARACAL_PARTS=$checks/parts tools/part.sh "$name" bash -c "${commands[k]}" </dev/null >"$checks/$name.log" 2>&1 &
  running=$!
  code=0
  wait "$running" || code=$?
  running=
  read -r wall cpu _ <"$checks/parts"
  if ((code)); then
    failed+=("$name")
    echo "failed $name, $wall s, $cpu CPU-s:"
    tail -n 20 "$checks/$name.log" | sed 's/^/  /'
    continue
  fi
  echo "passed $name, $wall s, $cpu CPU-s"
  [[ $(state "${inputs[k]}") == "$before" ]] || continue  # the inputs have changed during the run
  echo "$(key "$before" "${commands[k]}") $(git describe --always --abbrev=12 --dirty --exclude '*') $wall $cpu" >"$record.new"
  mv "$record.new" "$record"
done
((${#failed[@]} == 0)) || { echo "check_all: failed: ${failed[*]}; see their logs in $checks" >&2; exit 1; }
