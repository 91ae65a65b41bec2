"""The JSON Schemas of schema/, and what of them a value meets."""

import json
import re
from collections.abc import Hashable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jsonschema import Draft202012Validator, RefResolver
from jsonschema.exceptions import best_match

FOLDER = Path(__file__).resolve().parents[2] / "schema"
SUFFIX = ".schema.json"
LONGEST = 6  # the most items that a schema asks for


@dataclass(frozen=True)
class Met:
    """An object of a value beside the schema that it was found to be of."""

    place: str  # of the schema: "calibration.schema.json#/properties/use"
    schema: dict[str, Any]
    judge: dict[str, Any]  # what the object must pass there: the schema, or the choice that it is one of
    value: dict[str, Any]


def _from_anywhere(schema: Any, file: str) -> Any:
    """With references that say their file, so that a part may be asked by itself."""
    if isinstance(schema, list):
        return [_from_anywhere(one, file) for one in schema]
    if not isinstance(schema, dict):
        return schema
    whole = {key: _from_anywhere(one, file) for key, one in schema.items()}
    if isinstance(whole.get("$ref"), str) and whole["$ref"].startswith("#"):
        whole["$ref"] = file + whole["$ref"]
    return whole


def _in_file(place: str) -> str:
    return place if "#" in place else place + "#"


def _words(schema: Any) -> set[str]:
    """Every text that a schema holds, and with these each that may decide which choice a value is of."""
    if isinstance(schema, dict):
        return set().union(*map(_words, schema.values()))
    if isinstance(schema, list):
        return set().union(*map(_words, schema))
    return {schema} if isinstance(schema, str) else set()


class Schemas:
    def __init__(self, folder: Path = FOLDER) -> None:
        self.files = {path.name: _from_anywhere(json.loads(path.read_text()), path.name) for path in sorted(folder.glob("*" + SUFFIX))}
        self._resolver = RefResolver("", {}, store=self.files)
        self._said = _words(list(self.files.values()))

    def at(self, place: str) -> Any:
        """What stands at "calibration.schema.json#/$defs/stage", or a whole file."""
        return self._resolver.resolve(place)[1]

    def complaints(self, schema: dict[str, Any], value: Any) -> list[str]:
        errors = Draft202012Validator(schema, resolver=self._resolver).iter_errors(value)
        innermost = [best_match([error]) for error in errors]  # of what fits no schema of several, why
        return [f"{error.json_path}: {error.message[:300]}" for error in innermost]

    def brief(self, value: Any) -> Any:
        """A value whose lists hold one item, beyond the first few, of each kind: keys, types, and texts that schemas know."""
        return self._brief(value)[0]

    def _brief(self, value: Any) -> tuple[Any, Hashable]:
        if isinstance(value, dict):
            parts = {key: self._brief(one) for key, one in value.items()}
            return {key: one for key, (one, _) in parts.items()}, tuple((key, kind) for key, (_, kind) in parts.items())
        if not isinstance(value, list):
            return value, value if isinstance(value, bool) or value in self._said else type(value)
        kept: list[Any] = []
        kinds: set[Hashable] = set()
        for one, kind in map(self._brief, value):
            if len(kept) < LONGEST or kind not in kinds:
                kept.append(one)
            kinds.add(kind)
        return kept, (min(len(value), LONGEST + 1), frozenset(kinds))

    def is_valid(self, schema: dict[str, Any], value: Any) -> bool:
        return bool(Draft202012Validator(schema, resolver=self._resolver).is_valid(value))

    def met(self, place: str, value: Any) -> Iterator[Met]:
        """Every object within a valid value."""
        return self._met(_in_file(place), self.at(place), None, value)

    def _met(self, place: str, schema: dict[str, Any], judge: dict[str, Any] | None, value: Any) -> Iterator[Met]:
        if "$ref" in schema:
            yield from self._met(_in_file(schema["$ref"]), self.at(schema["$ref"]), judge, value)
        for k, one in enumerate(schema.get("anyOf", [])):
            if self.is_valid(one, value):
                yield from self._met(f"{place}/anyOf/{k}", one, judge or schema, value)
        if isinstance(value, list) and "items" in schema:
            for one in value:
                yield from self._met(place + "/items", schema["items"], None, one)
        if not isinstance(value, dict) or schema.get("type") != "object":
            return
        yield Met(place, schema, judge or schema, value)
        for key, one in value.items():
            for below, rule in self.rules(schema, key):
                yield from self._met(f"{place}/{below}", rule, None, one)

    @staticmethod
    def rules(schema: dict[str, Any], key: str) -> list[tuple[str, dict[str, Any]]]:
        """What an object's schema says of a key."""
        named = schema.get("properties", {})
        found = [(f"properties/{key}", named[key])] if key in named else []
        return found + [(f"patternProperties/{pattern}", rule) for pattern, rule in schema.get("patternProperties", {}).items() if re.search(pattern, key)]

    def objects(self) -> Iterator[tuple[str, dict[str, Any]]]:
        """Every schema of an object, with its place."""

        def below(place: str, schema: Any) -> Iterator[tuple[str, dict[str, Any]]]:
            if isinstance(schema, list):
                for k, one in enumerate(schema):
                    yield from below(f"{place}/{k}", one)
            if isinstance(schema, dict):
                if schema.get("type") == "object":
                    yield place, schema
                for key, one in schema.items():
                    yield from below(f"{place}/{key}", one)

        for file, schema in self.files.items():
            yield from below(file + "#", schema)
