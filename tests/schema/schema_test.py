#!/usr/bin/python3
"""Every JSON output against its schema: schema_test.py PROGRAM runs the commands of tests/corpus/commands.txt for them."""

import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from typing import Any

from jsonschema import Draft202012Validator

from outputs import Output, outputs
from schemas import FOLDER, SUFFIX, Met, Schemas

ROOT = Path(__file__).resolve().parents[2]
SCHEMAS = Schemas()
OUTPUTS: list[Output] = []  # brief
WHOLE: list[Output] = []
EVERY = "PARACAL_EVERY_MACHINE" in os.environ
PROGRAM = ""


def setUpModule() -> None:
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([ROOT / "tools/record_commands.sh", PROGRAM, folder], check=True)
        for one in outputs(Path(folder)):
            brief = Output(one.command, one.schema, SCHEMAS.brief(one.value))
            OUTPUTS.append(brief)
            WHOLE.append(one if EVERY else brief)


def meaning(schema: dict[str, Any]) -> str:
    """What a schema, or the one that it refers to, says in words."""
    return schema.get("description") or (meaning(SCHEMAS.at(schema["$ref"])) if "$ref" in schema else "")


class TheOutputs(unittest.TestCase):
    def test_are_as_their_schemas_say(self) -> None:
        self.assertGreater(len(WHOLE), 100)
        for one in WHOLE:
            self.assertEqual(SCHEMAS.complaints(SCHEMAS.at(one.schema), one.value), [], one.command)

    def test_show_every_key(self) -> None:
        """A key that nothing prints is not true; nor is a pattern that no key is of."""
        met = [one for output in OUTPUTS for one in SCHEMAS.met(output.schema, output.value)]
        seen = {f"{one.place}/{below}" for one in met for key in one.value for below, _ in SCHEMAS.rules(one.schema, key)}
        wanted = {f"{place}/{kind}/{key}" for place, schema in SCHEMAS.objects() for kind in ("properties", "patternProperties") for key in schema.get(kind, {})}
        self.assertEqual(sorted(wanted - seen), [])

    def test_show_every_result(self) -> None:
        results = {one.schema.split("#")[0] for one in OUTPUTS}
        self.assertEqual(sorted(set(SCHEMAS.files) - results), ["common.schema.json", "parts.schema.json", "printer.schema.json"], "parts of others")

    def test_would_not_pass_with_a_key_more_or_less(self) -> None:
        tried: set[str] = set()
        for one in OUTPUTS:
            for met in SCHEMAS.met(one.schema, one.value):
                if met.place not in tried:
                    tried.add(met.place)
                    self.check_one_more_or_less(met)
        self.assertEqual(tried, {place for place, _ in SCHEMAS.objects()})

    def check_one_more_or_less(self, met: Met) -> None:
        self.assertTrue(SCHEMAS.is_valid(met.judge, met.value), met.place)
        self.assertFalse(SCHEMAS.is_valid(met.judge, {**met.value, "Not a key": 1}), met.place)
        for key in met.schema.get("required", []):
            less = {name: value for name, value in met.value.items() if name != key}
            self.assertFalse(SCHEMAS.is_valid(met.judge, less), f"{met.place} without {key}")


class TheSchemas(unittest.TestCase):
    def test_are_schemas(self) -> None:
        for name, schema in SCHEMAS.files.items():
            Draft202012Validator.check_schema(schema)
            self.assertEqual(schema["$schema"], Draft202012Validator.META_SCHEMA["$id"], name)

    def test_are_closed_and_say_what_each_key_means(self) -> None:
        for place, schema in SCHEMAS.objects():
            self.assertIs(schema.get("additionalProperties"), False, place)
            self.assertLessEqual(set(schema.get("required", [])), set(schema.get("properties", {})), place)
            for key, value in {**schema.get("properties", {}), **schema.get("patternProperties", {})}.items():
                self.assertTrue(meaning(value), f"{place}: {key}")

    def test_use_every_part(self) -> None:
        text = "\n".join(json.dumps(schema) for schema in SCHEMAS.files.values())
        parts = {f"{file}#/$defs/{name}" for file, schema in SCHEMAS.files.items() for name in schema.get("$defs", {})}
        rows = {one.schema for one in OUTPUTS}
        self.assertEqual(sorted(part for part in parts - rows if f'"{part}"' not in text), [])

    def test_call_no_two_parts_the_same(self) -> None:
        """So that all fit into one schema, and are told apart by their titles."""
        names = [name for file, schema in SCHEMAS.files.items() for name in [file.removesuffix(SUFFIX), *schema.get("$defs", {})]]
        titles = re.findall(r'"title": "([^"]*)"', "\n".join(path.read_text() for path in FOLDER.iterdir()))
        for all_of_a_kind in (names, titles):
            self.assertEqual(sorted({one for one in all_of_a_kind if all_of_a_kind.count(one) > 1}), [])


class ThePrintedSchemas(unittest.TestCase):
    """`paracal schema NAME` prints each by itself."""

    abouts: dict[str, str]
    schemas: dict[str, dict[str, Any]]

    @classmethod
    def setUpClass(cls) -> None:
        def printed(*words: str) -> Any:
            return json.loads(subprocess.run([PROGRAM, "schema", *words], check=True, capture_output=True).stdout)

        cls.abouts = {one["name"]: one["about"] for one in printed("--json")["schemas"]}
        cls.schemas = {name: printed(name) for name in cls.abouts}

    def test_are_those_of_the_files(self) -> None:
        files = {path.name.removesuffix(SUFFIX): json.loads(path.read_text()) for path in FOLDER.iterdir()}
        self.assertEqual(self.abouts, {name: schema["description"] for name, schema in files.items() if "required" in schema})
        for name, schema in self.schemas.items():
            for key in ("$schema", "title", "description", "required"):
                self.assertEqual(schema[key], files[name][key], name)
            for key in ("properties", "$defs"):
                self.assertLessEqual(files[name].get(key, {}).keys(), schema[key].keys(), name)

    def test_refer_to_nothing_outside(self) -> None:
        for name, schema in self.schemas.items():
            Draft202012Validator.check_schema(schema)
            led_to = re.findall(r'"\$ref": "([^"]*)"', json.dumps(schema))
            self.assertLessEqual(set(led_to), {f"#/$defs/{part}" for part in schema["$defs"]}, name)

    def test_judge_outputs_as_the_files_do(self) -> None:
        first = {one.schema.removesuffix(SUFFIX): one for one in reversed(OUTPUTS)}
        self.assertEqual(self.schemas.keys() - first.keys(), {"printer"})
        for name, schema in self.schemas.items():
            if name in first:
                self.check_judges(Draft202012Validator(schema), first[name])

    def check_judges(self, schema: Draft202012Validator, one: Output) -> None:
        self.assertEqual(list(schema.iter_errors(one.value)), [], one.command)
        places: dict[str, Met] = {met.place: met for met in SCHEMAS.met(one.schema, one.value)}
        for place, met in places.items():
            met.value["Not a key"] = 1
            self.assertFalse(schema.is_valid(one.value), f"{one.command}: {place}")
            del met.value["Not a key"]


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
