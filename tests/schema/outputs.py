"""The JSON that commands of a record (tools/record_commands.sh) printed or left, with the schema that it is to be of."""

import json
import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from schemas import SUFFIX

COMMANDS = Path(__file__).resolve().parents[1] / "corpus" / "commands.txt"
DATA_OF_A_PAGE = re.compile(r'<script[^>]*id="data"[^>]*>(.*?)</script>', re.DOTALL)
NAMED_OTHERWISE = {"calibrate": "calibration", "validate": "validation", "reproduce": "reproduction", "schema": "schemas"}


@dataclass(frozen=True)
class Output:
    command: str
    schema: str  # "forward.schema.json", "forward.schema.json#/$defs/forward_row"
    value: Any


def option(words: list[str], name: str) -> str | None:
    return words[words.index(name) + 1] if name in words else None


def result_of(words: list[str]) -> str:
    """Name of the schema of what a command prints."""
    command = words[0]
    if command == "robot" and "--list" in words:
        return "robots"
    if command == "poses":
        return "poses-optimal" if "--optimal" in words else "poses-stage"
    if command == "yield" and "--plan" in words:
        return "yield-plan"
    if command == "tolerance":
        return {"allocate": "allocation", "analyze": "analysis"}[words[1]]
    if command == "export":
        if "--config" in words:
            return "export-configuration"
        return {"json": "compensator", "gcode": "export-filter", "csv": "export-filter"}.get(option(words, "--target") or "", "export-text")
    return NAMED_OTHERWISE.get(command, command)


def page_data(text: str) -> Any:
    found = DATA_OF_A_PAGE.search(text)
    assert found, "a page without data"
    return json.loads(found[1])


def outputs_of(line: str, printed: str, files: Path) -> Iterator[Output]:
    """What one command of the record printed and left."""
    words = shlex.split(line)
    schema = result_of(words) + SUFFIX
    if "--json-lines" in words:
        for row in printed.splitlines():
            yield Output(line, f"{schema}#/$defs/{words[0]}_row", json.loads(row))
    elif "--json" in words or printed.startswith("{"):
        yield Output(line, schema, json.loads(printed))
    out = option(words, "--out")
    for page in (option(words, "--report"), out):
        if page and page.endswith(".html"):
            yield Output(line, "report" + SUFFIX, page_data((files / page).read_text()))
    if out and out.endswith(".json"):
        yield Output(line, schema, json.loads((files / out).read_text()))


def outputs(record: Path) -> Iterator[Output]:
    for number, line in enumerate(COMMANDS.read_text().splitlines(), 1):
        if not line or line.startswith("#"):
            continue
        code = (record / f"{number:03}.rc").read_text().strip()
        assert code in "01" or "--json" not in line, f"{line}: exit code {code}"
        if code in "01":
            yield from outputs_of(line, (record / f"{number:03}.out").read_text(), record / "files")
