#!/usr/bin/env bash
# Builds the Debian packages of a preset (release): build/packages/*.deb, checked by lintian: package.sh [PRESET]. Their maintainer is the builder (DEBFULLNAME and
# DEBEMAIL, otherwise from git).
set -euo pipefail
cd "$(dirname "$0")/.."

tools/setup.sh package
preset=${1:-release}
packages=$PWD/build/packages tree=$PWD/build/$preset
mkdir -p "$packages"
export SOURCE_DATE_EPOCH
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
log=$(mktemp)
trap 'rm -f "$log"' EXIT
quietly() { "$@" >"$log" 2>&1 || { cat "$log" >&2; exit 1; }; }

maintainer="${DEBFULLNAME:-$(git log -1 --format=%an)} <${DEBEMAIL:-$(git log -1 --format=%ae)}>"
tools/build.sh "$preset" paracal-app paracal-manual paracal-mpi paracal-python
# Below /usr Debian's python3 has its packages elsewhere than below any other prefix.
quietly cmake -DPARACAL_PYTHON_INSTALL_DIR=lib/python3/dist-packages "$tree"
trap 'rm -f "$log"; cmake -UPARACAL_PYTHON_INSTALL_DIR "$tree" >/dev/null 2>&1' EXIT

# What Debian asks of every package beside its files.
version=$(sed -n 's/^set(CPACK_PACKAGE_VERSION "\(.*\)")$/\1/p' "$tree/CPackConfig.cmake")
names=$(sed -n 's/^set(CPACK_DEBIAN_[A-Z]*_PACKAGE_NAME "\(.*\)")$/\1/p' "$tree/CPackConfig.cmake")
for package in $names; do
  made=$tree/packaging/$package
  mkdir -p "$made"
  { cat packaging/copyright; [[ $package != paracal ]] || "$tree/bin/paracal" --licenses | sed 's/^$/./; s/^/ /'; } >"$made/copyright"
  printf '%s (%s-1) unstable; urgency=medium\n\n  * Changes: CHANGELOG.md of the sources.\n\n -- %s  %s\n' \
    paracal "$version" "$maintainer" "$(date -R -u -d "@$SOURCE_DATE_EPOCH")" | gzip -9n >"$made/changelog.Debian.gz"
  sed -n "s/^\[$package\] \|^[^[]/&/p" packaging/lintian-overrides | sed "s/^\[$package\] //; s/^[a-z]/$package: &/" >"$made/lintian-overrides"
done

rm -f "$packages"/*.deb
quietly cpack --config "$tree/CPackConfig.cmake" -D "CPACK_PACKAGE_CONTACT=$maintainer" -B "$packages/made"
mv "$packages"/made/*.deb "$packages"
rm -rf "$packages/made"
lintian --fail-on error,warning --tag-display-limit 0 --allow-root "$packages"/*.deb
ls -1 "$packages"/*.deb
