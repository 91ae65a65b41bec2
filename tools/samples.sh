#!/usr/bin/env bash
# Copies the sample input files, as installed, into a folder: samples.sh FOLDER
set -euo pipefail
root=$(dirname "$0")/..
[[ ! $1 -ef $root ]] || { echo "samples: expected a folder other than the source folder, whose README would be overwritten" >&2; exit 2; }
cp "$root"/samples/* "$root"/data/huang2016/{poses,distances}.csv "$root"/data/huang2016/offsets.toml "$1"
