#!/usr/bin/python3
"""No text for people holds a phrase of banned_phrases.txt, and no line of a document is longer than 120 columns.

Texts for people are literals of the program, library, Python module and page with at least two blanks, public docstrings, documents and
descriptions in schemas. Run with file names to list what is found in these alone; with --long, sentences of more than 25 words, too.
"""

import ast
import json
import re
import subprocess
import sys
import unittest
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LONGEST_LINE = 120
LONGEST_GUIDE = 2500  # words; references (tables of keys, conventions, evidence) may be longer
GUIDES = ("calibration", "controllers", "hexapods", "library", "live-page", "part-programs", "printers", "python", "report", "scale", "tolerance")

Text = tuple[int, str]  # line, text


def phrases() -> list[tuple[re.Pattern[str], str]]:
    lines = (ROOT / "tests/documents/banned_phrases.txt").read_text().splitlines()
    rules = [line.split(" => ") for line in lines if line and not line.startswith("#")]
    return [(re.compile(pattern, re.IGNORECASE), instead) for pattern, instead in rules]


def tracked(*patterns: str) -> list[Path]:
    names = subprocess.run(["git", "ls-files", "-z", *patterns], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return [ROOT / name for name in names.split("\0") if name]


def without_code(text: str) -> str:
    """Blanks where code stands: its names are exempt."""
    return re.sub(r"`[^`]*`", lambda code: re.sub(r"[^\n]", " ", code[0]), text)


def literals(text: str) -> Iterator[Text]:
    """Literals of C++ and TypeScript; those that the compiler joins are joined here."""
    literal = r'"(?:[^"\\\n]|\\.)*"'
    pattern = rf"//[^\n]*|'(?:[^'\\\n]|\\.)'|R\"(\w*)\((?:.|\n)*?\)\1\"|`(?:[^`\\]|\\.)*`|{literal}(?:\s*{literal})*"
    for found in re.finditer(pattern, text):
        said = re.sub(r'"\s*"', "", found[0])
        if found[0][0] in "\"R`" and said.count(" ") >= 2:
            yield text.count("\n", 0, found.start()) + 1, said.strip('"`').replace("\\n", " ")


def comments(text: str) -> Iterator[Text]:
    """Comments of a public header: its docstrings. Those of lines that follow each other are one text."""
    for found in re.finditer(r"(?:^|(?<=[ \t]))//[/<]*[^\n]*(?:\n[ \t]*//[^\n]*)*", text, re.MULTILINE):
        yield text.count("\n", 0, found.start()) + 1, re.sub(r"\n[ \t]*/+<?", " ", without_code(found[0])).lstrip("/<")


def python_texts(text: str) -> Iterator[Text]:
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value.count(" ") >= 2:
            yield node.lineno, without_code(node.value)


def described(schema: object) -> Iterator[str]:
    if isinstance(schema, dict):
        for key, value in schema.items():
            if key in ("description", "title") and isinstance(value, str):
                yield value
            else:
                yield from described(value)
    elif isinstance(schema, list):
        for value in schema:
            yield from described(value)


def texts(path: Path) -> Iterator[Text]:
    text = path.read_text()
    match path.suffix:
        case ".md":
            # Paragraphs, so that a phrase may go over the end of a line.
            for found in re.finditer(r"[^\n]+(?:\n(?![\n|>#-]| *[-*] )[^\n]+)*", without_code(text)):
                yield text.count("\n", 0, found.start()) + 1, found[0].replace("\n", " ")
        case ".json":
            yield from ((1, said) for said in described(json.loads(text)))
        case ".py" | ".pyi":
            yield from python_texts(text)
        case ".sh":
            yield from ((k + 1, line) for k, line in enumerate(text.splitlines()) if re.search(r"\b(echo|printf)\b", line))
        case _:
            yield from literals(text)
            if path.is_relative_to(ROOT / "include"):
                yield from comments(text)


def written_for_people() -> list[Path]:
    program = ["src/*.cpp", "src/*.hpp", "apps/*.cpp", "apps/*.hpp", "include/*.hpp", "python/bindings/*.cpp", "python/bindings/*.hpp"]
    others = ["python/paracal/*.py", "python/paracal/*.pyi", "web/src/*.ts", "*.md", "schema/*.json", "run.sh", "test.sh"]
    return tracked(*program, *others)


def banned_in(path: Path) -> list[str]:
    rules = phrases()
    return [
        f"{path.relative_to(ROOT)}:{line}: {found[0]!r} (write: {instead}): {text.strip()[max(0, found.start() - 60) : found.end() + 60]}"
        for line, text in texts(path)
        for pattern, instead in rules
        if (found := pattern.search(re.sub(r"\s+", " ", text)))
    ]


def long_sentences(path: Path) -> list[str]:
    return [
        f"{path.relative_to(ROOT)}:{line}: {len(sentence.split())} words: {sentence.strip()}"
        for line, text in texts(path)
        for sentence in re.split(r"(?<=[.!?:;])\s+", text)
        if len(sentence.split()) > 25
    ]


def long_lines(path: Path) -> list[str]:
    numbered = enumerate(path.read_text().splitlines(), 1)
    return [f"{path.relative_to(ROOT)}:{k}: {len(line)} columns" for k, line in numbered if len(line) > LONGEST_LINE and not line.lstrip().startswith("|")]


class PlainWords(unittest.TestCase):
    def expect_none(self, found: list[str], what: str) -> None:
        if found:
            self.fail("\n".join([f"{len(found)} {what}:", *found[:20]]))

    def test_no_banned_phrase(self) -> None:
        found = [problem for path in written_for_people() for problem in banned_in(path)]
        self.expect_none(found, "banned phrases")

    def test_no_long_line(self) -> None:
        found = [problem for path in tracked("*.md") for problem in long_lines(path)]
        self.expect_none(found, f"lines of more than {LONGEST_LINE} columns")

    def test_guides_are_short(self) -> None:
        for guide in GUIDES:
            words = len((ROOT / f"docs/{guide}.md").read_text().split())
            self.assertLessEqual(words, LONGEST_GUIDE, guide)

    def test_each_kind_of_text_is_read(self) -> None:
        kinds = {
            'x.cpp': ('f("143 "\n  "to spare");', "143 to spare"),
            "include/x.hpp": ("/// It goes\n/// on.\nint x;", "It goes on."),
        }
        self.assertIn("143 to spare", next(literals(kinds["x.cpp"][0]))[1])
        self.assertIn("goes  on", next(comments(kinds["include/x.hpp"][0]))[1].replace("goes on", "goes  on"))


if __name__ == "__main__":
    files = [Path(word).resolve() for word in sys.argv[1:] if not word.startswith("-")]
    if not files:
        unittest.main()
    for file in files:
        print("\n".join(banned_in(file) + (long_sentences(file) if "--long" in sys.argv else [])))
