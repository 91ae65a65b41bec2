#!/usr/bin/env bash
# Builds what a release consists of, in build/release-files: release.sh [PART...]. Without parts all of them, in this order:
#   amd64    Debian packages of this machine
#   wheel    Python wheel with module, program and libraries
#   arm64    Debian packages and wheel for arm64, by Debian's cross compiler (20 minutes the first time)
#   page     live page, the program in one file for a browser (15 minutes the first time; installs emscripten)
#   site     guides and reference of the headers
#   lists    change log, SBOM (SPDX) and checksums of all files that are there
# tools/check_release.sh uses each file in a bare root. PARACAL_PRESET: the preset of this machine's files (release).
set -euo pipefail
cd "$(dirname "$0")/.."

files=build/release-files
preset=${PARACAL_PRESET:-release}
[[ $(dpkg --print-architecture) == amd64 ]] || { echo "release: expected an amd64 machine, got $(dpkg --print-architecture)" >&2; exit 1; }
mkdir -p "$files"
keep() { cp -p "$@" "$files"; }  # FILE...

# The libraries that arm64 is compiled and linked with; nothing of this machine changes.
arm64_root() {
  local wanted
  wanted=$(awk '/^\[package\]/ { exit } /-dev$/' tools/packages.txt | paste -sd,)
  [[ ! -f build/arm64-root/complete || $(<build/arm64-root/complete) != "$wanted" ]] || return 0
  rm -rf build/arm64-root
  mmdebstrap --quiet --architectures=arm64 --variant=extract --include="$wanted,libstdc++-12-dev" bookworm build/arm64-root
  # What a link names from the root on is in that root, too: else the linker would not find zlib's shared library.
  find build/arm64-root -type l -lname '/*' -printf '%p %l\n' | while read -r link target; do ln -sfrn "build/arm64-root$target" "$link"; done
  echo "$wanted" >build/arm64-root/complete
}

make_amd64() {
  rm -f "$files"/*_amd64.deb
  tools/package.sh "$preset"
  keep build/packages/*_amd64.deb
}
make_wheel() {
  rm -f "$files"/*_x86_64.whl
  tools/wheel.sh "$preset"
  keep build/packages/*_x86_64.whl
}
make_arm64() {
  rm -f "$files"/*_arm64.deb "$files"/*_aarch64.whl
  tools/setup.sh release
  arm64_root
  tools/package.sh arm64
  tools/wheel.sh arm64
  keep build/packages/*_arm64.deb build/packages/*_aarch64.whl
}
make_page() {
  tools/setup.sh live
  tools/live_page.sh
  keep build/live/paracal-live.html
}
make_site() {
  tools/site.sh
  tar -C build --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$(git log -1 --format=%ct)" -cf - site | gzip -9n >"$files/paracal-site.tar.gz"
}
make_lists() {
  keep CHANGELOG.md
  node tools/sbom.mjs "$files" "$files/paracal.spdx.json"
  (cd "$files" && rm -f SHA256SUMS && sums=$(sha256sum -- *) && echo "$sums" >SHA256SUMS)
}

(($#)) || set -- amd64 wheel arm64 page site lists
for part; do
  declare -F "make_$part" >/dev/null || { echo "release: expected amd64, wheel, arm64, page, site or lists, got $part" >&2; exit 2; }
done
for part; do "make_$part"; done
(cd "$files" && ls -l --time-style=+ | awk 'NR > 1 { printf "%8.2f MB  %s\n", $5 / 1e6, $6 }')
