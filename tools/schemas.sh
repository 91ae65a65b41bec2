#!/usr/bin/env bash
# Writes what follows from the lists of fields and settings: their schemas, docs/json-keys.md, the types of the page and the
# keywords of Python's calls: schemas.sh PRESET
set -euo pipefail
cd "$(dirname "$0")/.."
tools/build.sh "$1" listed_schemas
"build/$1/tests/listed_schemas" schema
"build/$1/tests/listed_schemas" --keywords | tests/schema/keywords.py
tests/schema/tables.py
node web/types.mjs
