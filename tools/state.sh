#!/usr/bin/env bash
# Prints a hash of the current files below paths of the repository, committed or not, without removed files: state.sh PATH...
set -euo pipefail
cd "$(dirname "$0")/.."
git ls-files --cached --others --exclude-standard --deduplicate -- "$@" | { xargs -d '\n' -r sha256sum 2>/dev/null || true; } | LC_ALL=C sort | sha256sum | cut -d ' ' -f 1
