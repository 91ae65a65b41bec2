#!/usr/bin/env bash
# Builds the Debian packages of a preset (release) and uses them, unpacked into an empty folder: check_package.sh [PRESET]. It runs the program, checks that
# the Depends cover every library that it loads, and builds programs with the library by CMake and by pkg-config.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/package.sh "${1:-release}"
root=$PWD/build/packages/root
rm -rf "$root"
here=_$(dpkg --print-architecture).deb
for package in build/packages/*"$here"; do dpkg-deb -x "$package" "$root"; done
fail() { echo "check_package: $1" >&2; exit 1; }

first=$(grep -m 1 '^paracal ' README.md)
for package in build/packages/*"$here"; do
  said=$(dpkg-deb -f "$package" Description)
  [[ ${said,,} == "${first:8:-1}"$'\n'" ${first,,}"* ]] || fail "expected the first sentence of README.md as the description of $package, got: $said"
done

# Each library belongs to a package that the program's package depends on, or that one of those depends on.
depends=$(dpkg-deb -f build/packages/paracal_*"$here" Depends | tr ',' '\n' | sed 's/ *(.*//; s/^ *//')
all=$(printf '%s\n' "$depends"; for one in $depends; do dpkg-query -W -f='${Depends}\n' "$one"; done | tr ',|' '\n\n' | sed 's/ *(.*//; s/:any//; s/^ *//')
while read -r library; do
  folder=$(basename "$(dirname "$library")")  # /lib or /usr/lib: packages name either
  owner=$(dpkg-query -S "*/$folder/$(basename "$(realpath "$library")")" 2>/dev/null | head -n 1 | cut -d: -f1 || true)
  grep -qx "$owner" <<<"$all" || fail "expected Depends to name the package of $library, ${owner:-none}, got: $depends"
done < <(ldd "$root/usr/bin/paracal" | sed -n 's/.*=> \(\/[^ ]*\) .*/\1/p')

# The program, its pages, completions, samples and schemas.
PATH=$root/usr/bin:$PATH
work=$root/work
mkdir "$work"
cp -r "$root/usr/share/paracal/samples/." "$work"
(cd "$work" && paracal demo && paracal calibrate --measurements distances.csv --poses poses.csv) >/dev/null
for page in paracal paracal-demo paracal-tolerance-allocate; do zcat "$root/usr/share/man/man1/$page.1.gz" | grep -q '^.SH NAME' || fail "expected a page of $page"; done
[[ -s $root/usr/share/doc/paracal/html/docs-calibration.html ]] || fail "expected the guides"
[[ -s $root/usr/share/paracal/schema/calibration.schema.json ]] || fail "expected the schema of a calibration"
bash -c 'source "$1"; complete -p paracal' _ "$root/usr/share/bash-completion/completions/paracal" >/dev/null
for file in zsh/vendor-completions/_paracal fish/vendor_completions.d/paracal.fish; do [[ -s $root/usr/share/$file ]] || fail "expected $file"; done

# The Python module.
(cd "$work" && PYTHONPATH=$root/usr/lib/python3/dist-packages /usr/bin/python3 -c '
import paracal
calibration = paracal.calibrate(paracal.robot("huang2016"), paracal.read_measurements("measured.csv"))
assert calibration.accepted, calibration.verdict') || fail "expected a calibration in Python"
[[ $(dpkg-deb -f build/packages/python3-paracal_*"$here" Depends) == *python3-numpy* ]] || fail "expected python3-paracal to depend on python3-numpy"

# The library.
headers=$(dpkg-deb -f build/packages/libparacal-dev_*"$here" Depends)
for needed in libeigen3-dev libfmt-dev libtbb-dev libnlopt-dev libmd-dev libcsv-dev libtomlplusplus-dev nlohmann-json3-dev; do
  [[ $headers == *"$needed"* ]] || fail "expected libparacal-dev to depend on $needed, got: $headers"
done
example=$PWD/examples/01_calibrate.cpp
cmake -S tests/package/consumer -B "$root/by-cmake" -G Ninja -DCMAKE_BUILD_TYPE=Release "-DCMAKE_PREFIX_PATH=$root/usr" "-DEXAMPLE=$example" >/dev/null
cmake --build "$root/by-cmake" >/dev/null
read -ra flags <<<"$(PKG_CONFIG_PATH=$(dirname "$(find "$root" -name paracal.pc)") pkg-config --cflags --libs paracal)"
c++ -std=c++20 "$example" "${flags[@]}" -o "$root/by-pkg-config"
for program in by-cmake/consumer by-pkg-config; do
  "$root/$program" "$work/distances.csv" "$work/poses.csv" | grep -q '^calibration of huang2016: accepted$' || fail "expected an accepted calibration of $program"
done
echo "packages: the program and the Python module run, the Depends are complete, CMake and pkg-config find the library"
