#!/usr/bin/env bash
# Builds the Debian packages of a preset (release): build/packages/*.deb, checked by lintian: package.sh [PRESET]. Their maintainer is the builder (DEBFULLNAME and
# DEBEMAIL, otherwise from git). The preset arm64 (tools/release.sh prepares it) needs the packages of this machine first.
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

architecture=$(dpkg --print-architecture) mpi=paracal-mpi run=() of_architecture=()
if [[ $preset == arm64 ]]; then
  # The same libraries of the same Debian: their packages have the same names and versions.
  for component in program:paracal python:python3-paracal; do
    of=$(dpkg-deb -f "$packages/${component#*:}"_*_"$architecture".deb Depends)
    of_architecture+=(-D "CPACK_DEBIAN_$(tr a-z A-Z <<<"${component%:*}")_PACKAGE_DEPENDS=$of")
  done
  architecture=arm64 mpi= run=(qemu-aarch64-static -L build/arm64-root)
fi

maintainer="${DEBFULLNAME:-$(git log -1 --format=%an)} <${DEBEMAIL:-$(git log -1 --format=%ae)}>"
tools/site.sh >/dev/null
tools/build.sh "$preset" paracal-app paracal-manual ${mpi:+"$mpi"} paracal-python
# Below /usr Debian's python3 has its packages elsewhere than below any other prefix.
quietly cmake -DPARACAL_PYTHON_INSTALL_DIR=lib/python3/dist-packages "$tree"
trap 'rm -f "$log"; cmake -UPARACAL_PYTHON_INSTALL_DIR "$tree" >/dev/null 2>&1' EXIT

# What Debian asks of every package beside its files.
licences() {  # PACKAGE: of the software of others in it
  "${run[@]}" "$tree/bin/paracal" --licenses
  case $1 in
    paracal) cat /usr/share/doc/libjs-katex/copyright ;;  # the equations in the guides
    python3-paracal) cat /usr/share/doc/pybind11-dev/copyright ;;
  esac
}
version=$(sed -n 's/^set(CPACK_PACKAGE_VERSION "\(.*\)")$/\1/p' "$tree/CPackConfig.cmake")
names=$(sed -n 's/^set(CPACK_DEBIAN_[A-Z]*_PACKAGE_NAME "\(.*\)")$/\1/p' "$tree/CPackConfig.cmake")
for package in $names; do
  made=$tree/packaging/$package
  mkdir -p "$made"
  { cat packaging/copyright; licences "$package" | sed 's/^$/./; s/^/ /'; } >"$made/copyright"
  printf '%s (%s-1) unstable; urgency=medium\n\n  * Changes: CHANGELOG.md of the sources.\n\n -- %s  %s\n' \
    paracal "$version" "$maintainer" "$(date -R -u -d "@$SOURCE_DATE_EPOCH")" | gzip -9n >"$made/changelog.Debian.gz"
  sed -n "s/^\[$package\] \|^[^[]/&/p" packaging/lintian-overrides | sed "s/^\[$package\] //; s/^[a-z]/$package: &/" >"$made/lintian-overrides"
done

rm -f "$packages"/*_"$architecture".deb
quietly cpack --config "$tree/CPackConfig.cmake" -D "CPACK_PACKAGE_CONTACT=$maintainer" "${of_architecture[@]}" -B "$packages/made"
mv "$packages"/made/*.deb "$packages"
rm -rf "$packages/made"
lintian --fail-on error,warning --tag-display-limit 0 --allow-root "$packages"/*_"$architecture".deb
ls -1 "$packages"/*_"$architecture".deb
