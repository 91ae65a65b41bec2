#!/usr/bin/python3
"""Keywords of Python's calls, from the lists of settings: listed_schemas --keywords | keywords.py writes those of
calibrate() and validate() into python/paracal; keywords.py --check fails when they are not current.

Of `def CALL(` it writes the lines between `*,` and `) ->`, and in the docstring those from `Keywords:` to the next empty
line.
"""

import json
import re
import sys
import textwrap
from pathlib import Path
from typing import Any

PACKAGE = Path(__file__).resolve().parents[2] / "python" / "paracal"
FILES = {"calibrate": PACKAGE / "calibration.py", "validate": PACKAGE / "validation.py"}
WIDTH = 100


def documented(one: dict[str, Any]) -> str:
    words = one["words"] and " or ".join(filter(None, [", ".join(f'"{w}"' for w in one["words"][:-1]), f'"{one["words"][-1]}"']))
    default = f' (default: {one["default_text"]})' if one["default_text"] else ""
    text = f'{one["keyword"]}: {words + ": " if words else ""}{one["text"]}{default}.'
    return textwrap.fill(text, WIDTH, initial_indent="        ", subsequent_indent="            ", break_on_hyphens=False)


def with_keywords(source: str, call: str, keywords: list[dict[str, Any]]) -> str:
    signature = "".join(f'    {one["keyword"]}: {one["type"]} = {one["default"]},\n' for one in keywords)
    text = "".join(documented(one) + "\n" for one in keywords)
    made, signatures = re.subn(
        rf"(?s)(\ndef {call}\((?:(?!\n\)).)*?\n    \*,\n).*?(\n?\) ->)", lambda m: m[1] + signature + m[2].lstrip("\n"), source, count=1
    )
    begin = made.index(f"\ndef {call}(")
    body, docs = re.subn(r"(?s)(\n    Keywords:\n).*?(\n\n|\n    \"\"\")", lambda m: m[1] + text[:-1] + m[2], made[begin:], count=1)
    if (signatures, docs) != (1, 1):
        sys.exit(f"keywords.py: expected def {call}( with *, and Keywords: in its docstring, got none")
    return made[:begin] + body


def main() -> None:
    stale = []
    for call, keywords in json.load(sys.stdin).items():
        path = FILES[call]
        source = path.read_text(encoding="utf-8")
        made = with_keywords(source, call, keywords)
        if made == source:
            continue
        stale.append(path.name)
        if "--check" not in sys.argv:
            path.write_text(made, encoding="utf-8")
    if stale and "--check" in sys.argv:
        sys.exit(f"python/paracal: {', '.join(stale)} is not what the lists of settings say: run tools/schemas.sh")


if __name__ == "__main__":
    main()
