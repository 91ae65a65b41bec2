#!/usr/bin/env bash
# Whether tools/check_all.sh remembers what passed, in a repository of its own with parts that cost nothing.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/tools"
cp "$root"/tools/{check_all,once,part,state}.sh "$scratch/tools"
printf '#!/bin/sh\n' >"$scratch/tools/setup.sh"
chmod +x "$scratch/tools/setup.sh"
cd "$scratch"
cat >tools/checks.txt <<'PARTS'
# A comment.
@sources = source more
one | | @sources | echo one >>ran
two | 2 | other | echo two {} >>ran
wait | | other | echo $$ >pid; echo wait >>ran; until [[ -e go ]]; do sleep 0.05; done
PARTS
echo 1 >source
echo 1 >other
printf '%s\n' /build/ /ran /go /pid /out /broken >.gitignore
git init -q
git add -A
git -c user.name=t -c user.email=t@t commit -qm first
touch go

# expect WHAT EXIT-CODE RAN ARGUMENT...: what ran, in its order.
expect() {
  local code=0
  : >ran
  tools/check_all.sh "${@:4}" >out 2>&1 || code=$?
  [[ $code == "$2" && $(paste -sd , ran) == "$3" ]] || { echo "$1: expected exit code $2 and $3, got $code and $(paste -sd , ran):" >&2; cat out >&2; exit 1; }
}
says() { grep -qE "$1" out || { echo "expected $1, got:" >&2; cat out >&2; exit 1; }; }

expect "first" 0 "one,two 1/2,two 2/2,wait"
expect "nothing has changed" 0 ""
expect "list" 0 "" --list
says '^two.2: passed at [0-9a-f]+, [0-9]+ s, [0-9]+ CPU-s$'
expect "a part" 0 "two 1/2,two 2/2" two
expect "a share" 0 "two 2/2" two.2
expect "no part" 2 "" three

echo 2 >source
expect "changed, not committed" 0 "one"
git add -A
git -c user.name=t -c user.email=t@t commit -qm second
expect "committed" 0 ""
rm source
expect "removed" 0 "one"
git checkout -q source
expect "back again" 0 "one"
echo 1 >more
expect "a file more, that git does not know" 0 "one"

# A part that fails stops no other, and is run again.
sed -i 's/^one .*/one | | source | echo one >>ran; false/' tools/checks.txt
echo 3 >other
expect "fails" 1 "one,two 1/2,two 2/2,wait"
says '^check_all: failed: one;'
expect "fails again" 1 "one"
sed -i 's/; false$//' tools/checks.txt
expect "mended, its command is another" 0 "one"
expect "mended, nothing has changed" 0 ""
sed -i 's/^one .*/one | | source | echo one >>ran; echo 4 >source/' tools/checks.txt
echo 3 >source
expect "changes its own inputs" 0 "one"
echo 3 >source
expect "it is not known with which it passed" 0 "one"
sed -i 's/^one .*/one | | source | echo one >>ran; [[ ! -e broken ]]/' tools/checks.txt
expect "passes" 0 "one"
touch broken
expect "fails, run by name" 1 "one" one
rm broken
expect "has not passed since" 0 "one"

# Interrupted, it ends with all that it started, and goes on later.
echo 4 >other
rm go
: >ran
tools/check_all.sh >out 2>&1 &
until grep -q wait ran; do sleep 0.05; done
kill -TERM $!
code=0
wait $! || code=$?
[[ $code == 130 ]] || { echo "expected exit code 130, got $code" >&2; exit 1; }
expect "list" 0 "" --list
says '^two.2: passed'
says '^wait: not passed yet$'
for ((k = 0; k < 100; ++k)); do
  [[ $(sed 's/.*) //' "/proc/$(<pid)/stat" 2>/dev/null) == [!Z]* ]] || break  # it may wait to be buried
  sleep 0.05
done
((k < 100)) || { echo "expected the part to end, too" >&2; exit 1; }
touch go
expect "goes on" 0 "wait"
echo "check_all: remembers, skips, resumes"

# tools/once.sh, with records of its own.
export XDG_CACHE_HOME=$scratch/cache
unset PARACAL_ONCE  # .ci/run sets it
once() { # WHAT RAN COMMAND...
  : >ran
  tools/once.sh "source more" "${@:3}" >out 2>&1 || true
  [[ $(paste -sd , ran) == "$2" ]] || { echo "$1: expected $2, got $(paste -sd , ran):" >&2; cat out >&2; exit 1; }
}
add=(bash -c 'echo once >>ran')
once "without PARACAL_ONCE" once "${add[@]}"
once "always" once "${add[@]}"
export PARACAL_ONCE=1
once "first" once "${add[@]}"
once "nothing has changed" "" "${add[@]}"
says '^passed before with the same inputs'
echo 2 >>source
once "another input" once "${add[@]}"
once "another command" "once,two" bash -c 'echo once >>ran; echo two >>ran'
once "fails" failed bash -c 'echo failed >>ran; false'
once "has failed" failed bash -c 'echo failed >>ran; false'
