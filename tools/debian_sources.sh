#!/usr/bin/env bash
# Unpacks the sources of Debian packages into FOLDER/sources, once: debian_sources.sh FOLDER PACKAGE... The package lists are in FOLDER/apt, so those of the
# machine do not change.
set -euo pipefail
folder=$(realpath -m "$1")
shift
[[ ! -f $folder/sources/complete ]] || exit 0

apt_here() {
  apt-get -qq -o Dir::Etc::SourceList="$folder/apt/sources.list" -o Dir::Etc::SourceParts="$folder/apt/parts" -o Dir::State::Lists="$folder/apt/lists" "$@"
}

echo "downloading the sources of $*"
rm -rf "$folder/apt" "$folder/sources"
mkdir -p "$folder/apt/parts" "$folder/apt/lists/partial" "$folder/sources"
sed -n 's/^deb /deb-src /p' /etc/apt/sources.list >"$folder/apt/sources.list" 2>/dev/null || true
[[ ! -f /etc/apt/sources.list.d/debian.sources ]] ||
  sed 's/^Types:.*/Types: deb-src/' /etc/apt/sources.list.d/debian.sources >"$folder/apt/parts/debian.sources"
apt_here update
(cd "$folder/sources" && apt_here source "$@" >"$folder/apt/log" 2>&1) || { cat "$folder/apt/log" >&2; exit 1; }
touch "$folder/sources/complete"
