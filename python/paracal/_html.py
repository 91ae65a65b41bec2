"""HTML of results for notebooks: plain tables without style."""

from __future__ import annotations

from html import escape
from typing import Any, Iterable, Mapping, Sequence


def number(value: Any) -> str:
    """Four digits for reading; the result itself has all digits."""
    if isinstance(value, bool) or value is None:
        return {None: "", True: "yes", False: "no"}[value]
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def heading(text: str) -> str:
    return f"<p><b>{escape(text)}</b></p>"


def table(headers: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    head = "".join(f"<th>{escape(one)}</th>" for one in headers)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(number(cell))}</td>" for cell in row) + "</tr>"
        for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def pairs(values: Mapping[str, Any]) -> str:
    return table(["", ""], values.items())


def items(mark: str, texts: Iterable[str]) -> str:
    """One sentence per line: notes, reasons, assumptions."""
    listed = "".join(f"<li>{escape(mark)}: {escape(text)}</li>" for text in texts)
    return f"<ul>{listed}</ul>" if listed else ""
