#!/usr/bin/env bash
# Builds a Python wheel of a preset (release): build/packages/*.whl, with the module, the program and the libraries that they load: wheel.sh [PRESET]. It runs on
# Linux with the C library of this machine or a newer one, and with the Python that the module was built for; pip needs no compiler.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/setup.sh package
preset=${1:-release}
tools/build.sh "$preset" paracal-app paracal-manual paracal-python
tree=$PWD/build/$preset
stage=$tree/wheel
strip=$(sed -n 's/^CMAKE_STRIP:[A-Z]*=//p' "$tree/CMakeCache.txt")
root=/ machine=$(uname -m) run=()
[[ $preset != arm64 ]] || { root=$PWD/build/arm64-root/ machine=aarch64 run=(qemu-aarch64-static -L "$root"); }

rm -rf "$stage"
mkdir -p "$stage/paracal/bin" "$stage/paracal/lib"
cp packaging/wheel/pyproject.toml packaging/wheel/setup.py LICENSE "$stage"
cp python/paracal/*.py python/paracal/*.pyi python/paracal/py.typed packaging/wheel/_program.py "$stage/paracal"
{ "${run[@]}" "$tree/bin/paracal" --licenses; cat /usr/share/doc/pybind11-dev/copyright; } >"$stage/licences.txt"
"$strip" -o "$stage/paracal/bin/paracal" "$tree/bin/paracal"
module=$(basename "$tree"/python/paracal/_paracal.*.so)
"$strip" -o "$stage/paracal/$module" "$tree/python/paracal/$module"

# Of the libraries, all but those that every Linux has: the C library's, the compiler's and zlib. They get names of their own, so that they do not stand in
# for those of other wheels.
needed() { patchelf --print-needed "$1" | grep -vE '^(ld-linux|lib(c|m|gcc_s|stdc\+\+|z)\.so)' || true; }
loads=("$stage/paracal/bin/paracal" "$stage/paracal/$module")
for ((k = 0; k < ${#loads[@]}; ++k)); do
  for library in $(needed "${loads[k]}"); do
    own=$stage/paracal/lib/${library/.so/-paracal.so}
    patchelf --replace-needed "$library" "$(basename "$own")" "${loads[k]}"
    [[ ! -f $own ]] || continue
    cp "$root"usr/lib/"$machine"-linux-gnu/"$library" "$own"
    patchelf --set-soname "$(basename "$own")" "$own"
    loads+=("$own")
  done
done
patchelf --set-rpath '$ORIGIN/../lib' "$stage/paracal/bin/paracal"
patchelf --set-rpath '$ORIGIN/lib' "$stage/paracal/$module"
for library in "$stage"/paracal/lib/*; do patchelf --set-rpath '$ORIGIN' "$library"; done

export SOURCE_DATE_EPOCH PARACAL_VERSION
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
PARACAL_VERSION=$(sed -n 's/^set(CPACK_PACKAGE_VERSION "\(.*\)")$/\1/p' "$tree/CPackConfig.cmake")
glibc=$(getconf GNU_LIBC_VERSION | sed 's/.* //; s/\./_/')  # Debian has the same on all of its machines
mkdir -p build/packages
rm -f build/packages/*_"$machine".whl
log=$(mktemp)
trap 'rm -f "$log"' EXIT
/usr/bin/python3 -m build --wheel --no-isolation --outdir build/packages "-C--global-option=--plat-name=manylinux_${glibc}_$machine" "$stage" >"$log" 2>&1 ||
  { cat "$log" >&2; exit 1; }
ls -1 build/packages/*_"$machine".whl
