#!/usr/bin/env bash
# Runs the fuzz targets of fuzz/ one after the other, or two at a time on two cores: fuzz.sh SECONDS [TARGET ...]. What they find new goes to
# build/fuzz/corpus, what breaks something to build/fuzz/found; any of that makes this fail.
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
    echo "fuzz: $2 found something: $build/found" >&2
    return 1
  fi
  awk -v target="$2" '/number_of_executed_units/ { runs = $2 } / cov: / { for (k = 1; k < NF; ++k) if ($k == "cov:") edges = $(k + 1) }
    END { printf "fuzz: %-12s %10d runs, %d edges of the code\n", target, runs, edges }' "$log"
}
export build
export -f fuzz
printf '%s\n' "${targets[@]}" | xargs -P "$(nproc)" -I TARGET bash -c "fuzz $seconds TARGET"
