#!/usr/bin/env bash
# Puts the samples of input files, as they are installed, into a folder: samples.sh FOLDER
set -euo pipefail
root=$(dirname "$0")/..
[[ ! $1 -ef $root ]] || { echo "samples: expected a folder other than that of the sources, whose README would be lost" >&2; exit 2; }
cp "$root"/samples/* "$root"/data/huang2016/{poses,distances}.csv "$root"/data/huang2016/offsets.toml "$1"
