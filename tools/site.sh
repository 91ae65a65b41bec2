#!/usr/bin/env bash
# Builds build/site unless it is up to date: the documents and the reference of the headers, for a browser, also from a disk. A dead link, an equation that cannot be
# typeset and any warning of doxygen make it fail.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/setup.sh site
made=build/site/index.html
from=(*.md CITATION.cff CMakeLists.txt LICENSE data docs examples include python/examples samples tests/documents tools/site.sh)
if [[ -f $made && -z $(find "${from[@]}" -newer "$made" -print -quit) ]]; then
  echo "site: $made is up to date"
  exit
fi
node docs/site/prepare.mjs
(cd build/site.in && doxygen Doxyfile) 2> >(sed -E "s#^$PWD/build/site.in/(pages/)?##" >&2)
node docs/site/finish.mjs
