#!/usr/bin/env bash
# Makes build/site unless it is up to date: the documents, and the reference of the headers, to be read in a browser, from a disk, too. A link that leads
# nowhere, an equation that cannot be set and whatever doxygen warns of fail it.
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
