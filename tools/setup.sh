#!/usr/bin/env bash
# Installs what is missing: setup.sh [run|python|package|test|disks|live|comparison|cortex|site|release]. These are the Debian packages of packages.txt of the group and the
# groups above it (comparison, cortex, site and release: only their own), and for test and live the npm packages of web/package-lock.json. It is quick when there is nothing to do.
set -euo pipefail
cd "$(dirname "$0")"

group=${1:-test}
grep -qx "\[$group\]" packages.txt || { echo "setup: expected run, python, package, test, disks, live, comparison, cortex, site or release, got $group" >&2; exit 2; }
mapfile -t wanted < <(awk -v last="[$group]" '/^\[/ { if (done) exit; done = $0 == last; next } /^[^#]/ && (done || last !~ /comparison|cortex|site|release/)' packages.txt)
missing=()
for package in "${wanted[@]}"; do
  [[ $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) == installed ]] && continue
  command -v "$package" >/dev/null || missing+=("$package")  # a program from elsewhere is also accepted
done
log=$(mktemp)
trap 'rm -f "$log"' EXIT

# quietly WHAT COMMAND...: shows the output of the command only if it fails.
quietly() {
  "${@:2}" >"$log" 2>&1 && return
  tail -n 20 "$log" >&2
  echo "setup: $1 failed; its output is above" >&2
  exit 1
}

if ((${#missing[@]})); then
  as_root=()
  if ((EUID != 0)); then
    command -v sudo >/dev/null || { echo "setup: run as root, or install: ${missing[*]}" >&2; exit 1; }
    as_root=(sudo)
  fi
  echo "installing ${missing[*]}"
  quietly "updating the package lists" "${as_root[@]}" apt-get update
  quietly "installing packages" "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y --no-install-recommends "${missing[@]}"
fi

[[ $group == test || $group == live ]] || exit 0
if [[ ! ../web/node_modules/.package-lock.json -nt ../web/package-lock.json || ! -x ../web/node_modules/.bin/tsc ]]; then
  echo "installing the npm packages of web/package-lock.json"
  quietly "npm ci" npm --prefix ../web ci
fi
