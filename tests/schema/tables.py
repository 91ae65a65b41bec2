#!/usr/bin/python3
"""docs/json-keys.md, the tables of JSON keys, from schema/: tables.py writes it, tables.py --check fails when it is not current."""

import re
import sys
import textwrap
from collections import Counter
from collections.abc import Iterator
from typing import Any

from schemas import FOLDER, Schemas

DOCUMENT = FOLDER.parent / "docs" / "json-keys.md"
SCHEMAS = Schemas()
HEAD = """# JSON keys

Made by `tools/schemas.sh` from the JSON Schemas in `schema/`, some of them from lists of fields. Do not edit.

Each section describes one result: what a command prints with `--json` or writes with `--out`.
Formats of input files: [files.md](files.md).

- `a.b` is key `b` of the object `a`; `a[].b` is key `b` of each object in the list `a`.
- The unit is part of the key: `noise_mm` is in mm. A number that is not finite is null.
- A key between slashes is a pattern: the object has any number of keys that match it.
- "Optional" keys may be missing. All other keys are always there, and no others.
- `paracal schema` lists the schemas; `paracal schema calibration` prints one, for programs that check or generate code.
"""
KINDS = {"number": "number", "integer": "whole number", "string": "text", "boolean": "true or false", "null": "null", "object": "object"}
UNITS = {"mm": "mm", "deg": "deg", "rad": "rad", "um": "µm", "ms": "ms", "us": "µs", "mb": "MB", "ppm": "ppm", "seconds": "s", "mm2": "mm²"}
RATES = {"s": "s", "s2": "s²", "m": "m", "mm": "mm", "deg": "deg"}


def unit_of(key: str) -> str:
    found = re.search(rf"(?:^|(?<!_per)_)({'|'.join(UNITS)})(?:_per_({'|'.join(RATES)}))?$", key)
    return "" if not found else " (" + UNITS[found[1]] + (f"/{RATES[found[2]]}" if found[2] else "") + ")"


def resolved(schema: dict[str, Any]) -> dict[str, Any]:
    """A schema with what it refers to; its own description first."""
    return {**resolved(SCHEMAS.at(schema["$ref"])), **schema} if "$ref" in schema else schema


def choices(schema: dict[str, Any]) -> list[dict[str, Any]]:
    """What a value may be, but for null."""
    return [one for one in resolved(schema).get("anyOf", [schema]) if one.get("type") != "null"]


def places(schema: Any) -> Iterator[str]:
    """Parts that a schema refers to; those of a choice count twice, so that each has a table of its own."""
    if isinstance(schema, list):
        for one in schema:
            yield from places(one)
    if isinstance(schema, dict):
        several = [one["$ref"] for one in schema.get("anyOf", []) if "$ref" in one]
        yield from several if len(several) > 1 else []
        yield from [schema["$ref"]] if isinstance(schema.get("$ref"), str) else []
        for one in schema.values():
            yield from places(one)


USES = Counter(places(list(SCHEMAS.files.values())))


def link(place: str) -> str:
    title = SCHEMAS.at(place)["title"]
    return f"[{title}](#{re.sub(r'[^a-z0-9-]', '', title.lower().replace(' ', '-'))})"


def is_apart(place: str | None) -> bool:
    """Whether a part has a table of its own: an object that stands in several places."""
    return place is not None and SCHEMAS.at(place).get("type") == "object" and ("#/" not in place or USES[place] > 1)


def kind(schema: dict[str, Any]) -> str:
    if is_apart(schema.get("$ref")):
        return link(schema["$ref"])
    whole = resolved(schema)
    if "anyOf" in whole:
        return " or ".join(dict.fromkeys(kind(one) for one in whole["anyOf"]))
    if "enum" in whole or "const" in whole:
        return ", ".join("null" if one is None else f'`"{one}"`' if isinstance(one, str) else f"{one}" for one in whole.get("enum", [whole.get("const")]))
    kinds = whole["type"] if isinstance(whole["type"], list) else [whole["type"]]
    return " or ".join(list_of(whole) if one == "array" else KINDS[one] for one in kinds)


def list_of(schema: dict[str, Any]) -> str:
    count = f"{schema['minItems']} " if schema.get("minItems") and schema["minItems"] == schema.get("maxItems") else ""
    item = kind(schema["items"])
    return f"list of {count}{item}s" if item in KINDS.values() else f"list: {item}"


def rows(schema: dict[str, Any], before: str = "") -> Iterator[str]:
    """The keys of an object, and of objects in it that have no table of their own."""
    whole = resolved(schema)
    named = [(key, one, key not in whole.get("required", [])) for key, one in whole.get("properties", {}).items()]
    for key, one, optional in named + [(f"/{pattern}/", one, False) for pattern, one in whole.get("patternProperties", {}).items()]:
        about = resolved(one).get("description", "").replace("|", "\\|")
        shown = f"{before}{key}".replace("|", "\\|")
        yield f"| `{shown}` | {kind(one)}{unit_of(key)}{', optional' if optional else ''} | {about} |"
        yield from below(one, before + key)


def below(schema: dict[str, Any], path: str) -> Iterator[str]:
    for one in choices(schema):
        whole = resolved(one)
        if is_apart(one.get("$ref")):
            continue
        if whole.get("type") == "object":
            yield from rows(one, path + ".")
        elif "items" in whole:
            yield from below(whole["items"], path + "[]")


def table(mark: str, schema: dict[str, Any]) -> list[str]:
    keys = ["| key | type and unit | meaning |", "|---|---|---|", *rows(schema)] if "type" in schema else []
    return ["", f"{mark} {schema['title']}", "", textwrap.fill(schema.get("description", ""), 120), "", *keys]


def document() -> str:
    lines = HEAD.splitlines()
    for file, schema in SCHEMAS.files.items():
        lines += table("##", schema)
        for name, part in schema.get("$defs", {}).items():
            lines += table("###", part) if is_apart(f"{file}#/$defs/{name}") else []
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)) + "\n"


if __name__ == "__main__":
    if sys.argv[1:] != ["--check"]:
        DOCUMENT.write_text(document())
    elif DOCUMENT.read_text() != document():
        sys.exit("docs/json-keys.md is not what schema/ says: run tools/schemas.sh")
