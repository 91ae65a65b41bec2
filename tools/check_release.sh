#!/usr/bin/env bash
# Uses the files of a release (tools/release.sh) in bare roots that have only what each package asks for: check_release.sh deb|wheel|arm64|lists [PRESET]. It
# builds the files that it needs, prints sizes and times, and fails above their limits.
set -euo pipefail
cd "$(dirname "$0")/.."

part=$1
export PARACAL_PRESET=${2:-release}
files=$PWD/build/release-files
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "check_release: $1" >&2; exit 1; }
at_most() {  # LIMIT UNIT WHAT VALUE
  echo "$3: $4 $2 (at most $1)"
  awk -v value="$4" -v limit="$1" 'BEGIN { exit !(value <= limit) }' || fail "expected at most $1 $2, got $4: $3"
}
megabytes() { stat -c %s "$1" | awk '{ printf "%.1f", $1 / 1e6 }'; }  # FILE

# bare OPTION... <HOOK: a bare Debian 12 in which the script HOOK runs. It finds the release in /files and leaves its results in $work/results. `timed WHAT
# COMMAND...` in HOOK writes the time of a command to results/WHAT.
bare() {
  { echo 'timed() { local start=$EPOCHREALTIME; "${@:2}"; awk -v a="$start" -v b="$EPOCHREALTIME" "BEGIN { printf \"%.1f\", b - a }" >"/results/$1"; }'; cat; } >"$work/hook"
  mmdebstrap --quiet --variant=minbase "$@" --customize-hook="cp -r '$files' \"\$1/files\" && cp '$work/hook' \"\$1\" && mkdir \"\$1/results\"" \
    --customize-hook='chroot "$1" bash -eu /hook' --customize-hook="copy-out /results '$work'" bookworm /dev/null
}

check_deb() {
  tools/release.sh amd64 >/dev/null
  bare <<'HOOK'
apt-get -qq update
timed deb apt-get -qq install -y --no-install-recommends /files/paracal_*_amd64.deb >/dev/null
cd "$(mktemp -d)"
cp -r /usr/share/paracal/samples/. .
paracal calibrate --measurements measured.csv | grep -q '^calibration of huang2016: accepted'
paracal demo >/dev/null
test -s /usr/share/doc/paracal/html/index.html
HOOK
  at_most 10 s "apt install of the Debian package, with its downloads" "$(<"$work/results/deb")"
  at_most 15 MB "$(basename "$files"/paracal_*_amd64.deb)" "$(megabytes "$files"/paracal_*_amd64.deb)"
}

check_wheel() {
  tools/release.sh wheel >/dev/null
  cp samples/measured.csv "$files"
  bare --include=python3-venv,python3-numpy <<'HOOK'
python3 -m venv --system-site-packages /venv
cd /tmp
install_and_judge() {
  /venv/bin/pip --quiet install --no-index --find-links /files paracal
  /venv/bin/python -c '
import paracal
calibration = paracal.calibrate(paracal.robot("huang2016"), paracal.read_measurements("/files/measured.csv"))
assert calibration.accepted, calibration.verdict'
}
timed wheel install_and_judge
/venv/bin/paracal calibrate --measurements /files/measured.csv | grep -q '^calibration of huang2016: accepted'
/venv/bin/paracal demo >/dev/null
test -z "$(find / -xdev -name 'libtbb.so*' -o -xdev -name 'libfmt.so*')"  # the wheel's own
HOOK
  rm "$files/measured.csv"
  at_most 30 s "pip install of the wheel, to a verdict" "$(<"$work/results/wheel")"
  at_most 15 MB "$(basename "$files"/*_x86_64.whl)" "$(megabytes "$files"/*_x86_64.whl)"
}

# Without a kernel that starts programs for arm64: the packages are unpacked, and qemu starts the program and Python.
check_arm64() {
  tools/release.sh amd64 arm64 >/dev/null
  local root=$work/root depends one
  depends=$(dpkg-deb -f "$files"/python3-paracal_*_arm64.deb Depends; echo ,; dpkg-deb -f "$files"/paracal_*_arm64.deb Depends)
  mmdebstrap --quiet --architectures=arm64 --variant=extract --include="$(sed 's/ *([^)]*)//g' <<<"$depends" | tr -d ' \n')" bookworm "$root"
  for one in paracal python3-paracal; do dpkg-deb -x "$files/$one"_*_arm64.deb "$root"; done
  cp "$(command -v qemu-aarch64-static)" "$root"
  PARACAL=build/$PARACAL_PRESET/bin/paracal ROOT=$root node --test tests/package/arm64.test.mjs
  at_most 15 MB "$(basename "$files"/paracal_*_arm64.deb)" "$(megabytes "$files"/paracal_*_arm64.deb)"
}

# Checksums, and every library that the wheels carry and that the programs load is in the SBOM.
check_lists() {
  tools/release.sh amd64 wheel site lists >/dev/null
  (cd "$files" && sha256sum --check --quiet SHA256SUMS)
  local wheel
  wheel=$(basename "$files"/*_x86_64.whl)
  python3 -m zipfile -l "$files/$wheel" | sed -n 's#^paracal/lib/lib\(.*\)-paracal.*#\1#p' | node tests/package/sbom.mjs "$files" "$wheel"
}

[[ $part =~ ^(deb|wheel|arm64|lists)$ ]] || { echo "check_release: expected deb, wheel, arm64 or lists, got $part" >&2; exit 2; }
tools/setup.sh release
"check_$part"
