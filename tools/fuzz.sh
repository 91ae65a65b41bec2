#!/usr/bin/env bash
# Runs the fuzz targets of fuzz/, one per core: fuzz.sh SECONDS [TARGET ...]. New inputs go to build/fuzz/corpus, inputs that cause a failure to
# build/fuzz/found. Any failure makes this script fail.
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=$1
shift
targets=("$@")
((${#targets[@]})) || targets=(calibration chunks compensator filter path printer tables toml)
tools/build.sh fuzz
build=build/fuzz
mkdir -p "$build/found"
fuzz() {  # SECONDS TARGET
  local log=$build/$2.log
  mkdir -p "$build/corpus/$2"
  if ! "$build/fuzz/paracal-fuzz-$2" -max_total_time="$1" -timeout=20 -rss_limit_mb=4096 -max_len=65536 -print_final_stats=1 -artifact_prefix="$build/found/$2-" \
    "$build/corpus/$2" "fuzz/corpus/$2" >"$log" 2>&1; then
    tail -n 40 "$log" >&2
    echo "fuzz: $2 failed; the input is in $build/found" >&2
    return 1
  fi
  awk -v target="$2" '/number_of_executed_units/ { runs = $2 } / cov: / { for (k = 1; k < NF; ++k) if ($k == "cov:") edges = $(k + 1) }
    END { printf "fuzz: %-12s %10d runs, %d edges of the code covered\n", target, runs, edges }' "$log"
}
export build
export -f fuzz
printf '%s\n' "${targets[@]}" | xargs -P "$(nproc)" -I TARGET bash -c "fuzz $seconds TARGET"
