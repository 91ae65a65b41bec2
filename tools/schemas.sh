#!/usr/bin/env bash
# Writes what follows from the lists of fields: their schemas, docs/json-keys.md and the types of the page: schemas.sh PRESET
set -euo pipefail
cd "$(dirname "$0")/.."
tools/build.sh "$1" listed_schemas
"build/$1/tests/listed_schemas" schema
tests/schema/tables.py
node web/types.mjs
