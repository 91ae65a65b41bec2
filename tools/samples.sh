#!/usr/bin/env bash
# Puts the samples of input files, as they are installed, into a folder: samples.sh FOLDER
set -euo pipefail
cd "$(dirname "$0")/.."
cp samples/* data/huang2016/{poses,distances}.csv data/huang2016/offsets.toml "$1"
