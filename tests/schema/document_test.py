#!/usr/bin/python3
"""The tables of docs/files.md against the schemas: both name the same keys."""

import re
import shlex
import unittest
from typing import Any

from outputs import result_of
from schemas import FOLDER, SUFFIX, Schemas

SCHEMAS = Schemas()
TEXT = (FOLDER.parent / "docs/files.md").read_text().replace("O1 ... O5", "O1, O2, O3, O4, O5").replace("`O1` ... `O5`", "`O1, O2, O3, O4, O5`")
SECTIONS = {"Calibration (JSON)": ["calibration", "printer"], "Yield of a batch (JSON)": ["yield"], "Compensator (JSON)": ["compensator"]}
# What code says in these sections besides keys and their values: commands, examples, files, beginnings of keys.
OTHERS = {
    *("paracal", "calibrate", "export", "schema", "validate", "analyze", "true"),
    *("alpha01", "x", "y", "z", "q1", "SOURCE_DATE_EPOCH", "hpp", "defs", "limit_", "worst_", "three_sigma_"),
}


def words(text: str) -> set[str]:
    """Names in code, without what stands in quotation marks."""
    return {word for code in re.findall(r"`([^`]*)`", text) for word in re.findall(r"(?<![\w-])[A-Za-z][A-Za-z0-9_]*(?![\w-])", re.sub(r'"[^"]*"', " ", code))}


def section(heading: str) -> str:
    found = re.search(rf"^## {re.escape(heading)}\n(.*?)(?=^###? |\Z)", TEXT, re.DOTALL | re.MULTILINE)
    assert found, heading
    return found[1]


def rows() -> dict[str, set[str]]:
    """What the table of commands names, by schema. A row that says "the same" has what the one above it has."""
    found: dict[str, set[str]] = {}
    above: set[str] = set()
    for line in section("What other commands print with --json").splitlines():
        row = re.match(r"\| `([a-z][^`]*)`[^|]*\| (.*) \|$", line)
        if row and row[2] != "below":
            above = words(row[2]) | (above if "the same" in row[2] else set())
            name = result_of(shlex.split(row[1]))
            found[name] = found.get(name, set()) | above
    return found


def told() -> dict[str, set[str]]:
    by_section = {name: words(section(heading)) for heading, names in SECTIONS.items() for name in names}
    by_row = rows()
    return {name: by_section.get(name, set()) | by_row.get(name, set()) for name in by_section.keys() | by_row.keys()}


def values(schema: Any) -> set[str]:
    """Texts that a schema allows for a key."""
    if isinstance(schema, list):
        return set().union(*map(values, schema))
    if not isinstance(schema, dict):
        return set()
    own = [*schema.get("enum", []), schema.get("const")]
    return {word for text in own if isinstance(text, str) for word in re.findall(r"\w+", text)}.union(*map(values, schema.values()))


class TheDocument(unittest.TestCase):
    def test_tells_of_each_result_what_it_holds(self) -> None:
        self.assertEqual({name + SUFFIX for name in told()}, set(SCHEMAS.files) - {"common" + SUFFIX})
        for name, named in told().items():
            if name != "report":  # the data of a page
                self.assertEqual(sorted(SCHEMAS.files[name + SUFFIX]["properties"].keys() - named), [], name)

    def test_tells_of_every_key(self) -> None:
        """But for what only pages and the comparison of batches hold."""
        apart = ("report" + SUFFIX, f"yield{SUFFIX}#/$defs/batch", f"yield{SUFFIX}#/$defs/exact_tolerances")
        keys = {key for place, schema in SCHEMAS.objects() if not place.startswith(apart) for key in schema.get("properties", {})}
        self.assertEqual(sorted(keys - words(TEXT)), [])

    def test_names_no_key_that_no_schema_has(self) -> None:
        named = set().union(*told().values(), words(section("Results (JSON)")))
        keys = {key for _, schema in SCHEMAS.objects() for key in schema.get("properties", {})}
        parts = {name for file, schema in SCHEMAS.files.items() for name in [file.removesuffix(SUFFIX), *schema.get("$defs", {})]}
        self.assertEqual(sorted(named - keys - parts - values(list(SCHEMAS.files.values())) - OTHERS), [])
        self.assertEqual(sorted(OTHERS - named), [])


if __name__ == "__main__":
    unittest.main()
