#!/usr/bin/env bash
# Compares paracal with other programs and with the limits of the processor: comparison.sh [--write|--check]. --check only fails if docs/comparison.json is not of
# the current sources. Otherwise it builds the benchmarks (preset comparison), runs them for
# about ten minutes and prints the section "Speed" of docs/evidence.md. With --write it writes this section and docs/comparison.json. The table names the programs
# that are not installed (tools/setup.sh comparison installs them). LinuxCNC's sources are downloaded and compiled with -O3.
set -euo pipefail
cd "$(dirname "$0")/.."
(($# == 0)) || [[ $* == --write || $* == --check ]] || { echo "comparison: expected nothing, --write or --check, got $*" >&2; exit 2; }
state=$(tools/state.sh CMakeLists.txt cmake include src benchmarks)
if [[ $* == --check ]]; then
  grep -qF "\"sha256\": \"$state\"" docs/comparison.json && exit
  echo "comparison: expected docs/comparison.json of the current sources ($state), got another: run tools/comparison.sh --write on a quiet machine" >&2
  exit 1
fi
build=$PWD/build/comparison

tools/setup.sh run
tools/build.sh comparison >&2

# Compiles a module as one program. LinuxCNC's makefile compiles its files one by one with -Os.
module() {  # NAME SOURCE...
  gcc -O3 -flto -fno-semantic-interposition -fPIC -shared -DRTAPI -DUSPACE -D_GNU_SOURCE -D__MODULE__ -I/usr/include/linuxcnc -I"$sources" -Iemc/kinematics \
    -Ilibnml/posemath -o "$PARACAL_LINUXCNC_O3/$1.so" "${@:2}"
}
export PARACAL_LINUXCNC_O3=$build/linuxcnc
mkdir -p "$PARACAL_LINUXCNC_O3"
if [[ -d /usr/include/linuxcnc ]] && tools/debian_sources.sh "$build" linuxcnc >&2; then
  sources=$(echo "$build"/sources/linuxcnc-*/src)
  cd "$sources"
  module rotarydeltakins emc/kinematics/rotarydeltakins.c
  module genhexkins emc/kinematics/{genhexkins,switchkins,kins_util,userkfuncs}.c libnml/posemath/{_posemath,sincos}.c
  cd - >/dev/null
fi

# OpenBLAS at its fastest, independent of the environment: with AVX-512 where the processor has it. The benchmark sets its threads.
unset "${!OPENBLAS_@}" "${!MKL_@}"
if grep -qm 1 ' avx512f ' /proc/cpuinfo; then export OPENBLAS_CORETYPE=SkylakeX; fi
PARACAL_SOURCES="$(git describe --always --dirty --abbrev=12 --exclude='*') $state"
export PARACAL_SOURCES
export PARACAL_COMPARISON=$build/records.jsonl
rm -f "$PARACAL_COMPARISON"
load=$(cut -d ' ' -f 1 /proc/loadavg)
for program in benchmark tolerance-benchmark hexapod-benchmark 'compensation-benchmark 1000' calibration-benchmark printer-benchmark; do
  echo "paracal-$program" >&2
  # shellcheck disable=SC2086  # with its argument
  "$build"/benchmarks/paracal-$program >"$build/paracal-${program%% *}.log"
done
node tools/comparison.mjs "$PARACAL_COMPARISON" "$load" "$@"
