"""Reading and writing of tables. The library reads files, DataFrames and dicts of columns with the
same code."""

from __future__ import annotations

import csv
import io
import os
from typing import TYPE_CHECKING, Any, Mapping, Sequence, Union

import numpy as np

from . import _paracal
from ._arrays import column_names
from .errors import InvalidArgument

if TYPE_CHECKING:
    import pandas

#: A file (CSV), a DataFrame, or a dict of columns; columns are named as in files, units included.
Table = Union[str, "os.PathLike[str]", "pandas.DataFrame", Mapping[str, Sequence[Any]]]


def path_of(path: str | os.PathLike[str]) -> bytes:
    """Name of a file for the library."""
    return os.fsencode(path)


def write(path: str | os.PathLike[str], text: str) -> None:
    """Writes a file completely or not at all; after a failure an existing file is unchanged. Raises
    Error."""
    _paracal.write_file(path_of(path), text.encode("utf-8", "surrogateescape"))


def _has_apostrophe(cell: str) -> bool:
    """Whether the library's reader takes an apostrophe away: it keeps a spreadsheet from computing
    the name behind it."""
    return cell.startswith("'") and cell.lstrip("'")[:1] in tuple("=+-@")


def _cell(value: Any) -> str:
    """Text of a cell: blank if there is no reading; numbers with all digits."""
    if value is None or (isinstance(value, float) and value != value):
        return ""
    if isinstance(value, str) and _has_apostrophe(value):
        return "'" + value
    return repr(value) if isinstance(value, float) else str(value)


def _columns(table: Any) -> dict[str, list[Any]]:
    names = column_names(table)
    if names is None:
        raise InvalidArgument(
            f"table: expected a file, a DataFrame or a dict of columns, got {type(table).__name__}"
        )
    columns = {str(name): np.asarray(table[name], dtype=object).tolist() for name in names}
    if any(not isinstance(column, list) for column in columns.values()):
        raise InvalidArgument("table: expected columns with one value per row")
    lengths = {name: len(column) for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        raise InvalidArgument(f"table: expected columns of one length, got {lengths}")
    return {
        name: [v.item() if isinstance(v, np.generic) else v for v in column]
        for name, column in columns.items()
    }


def native(table: Table, name: str = "table") -> tuple[bytes, str | None]:
    """A file by its name; any other table as the text of a file."""
    if isinstance(table, (str, os.PathLike)):
        return path_of(table), None
    return name.encode(), text_of(table)


def text_of(table: Any) -> str:
    """A DataFrame or a dict of columns as the text of a file."""
    columns = _columns(table)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_cell(value) for value in row] for row in zip(*columns.values()))
    return text.getvalue()


def rows_of(text: str) -> dict[str, list[Any]]:
    """Columns of a table written by the library; as numbers if all values are numbers."""
    reader = list(csv.reader(text.splitlines()))
    names = ("pose", "from", "to")

    def read(name: str, cell: str) -> Any:
        if name in names:
            return cell[1:] if _has_apostrophe(cell) else cell
        return float(cell) if cell else float("nan")

    return {
        name: [read(name, cell) for cell in column]
        for name, column in zip(reader[0], zip(*reader[1:]))
    }


def frame(columns: Mapping[str, Any], index: Sequence[str] | None = None) -> pandas.DataFrame:
    """A DataFrame. Raises an error if pandas is not installed."""
    try:
        import pandas as pd
    except ImportError as missing:
        raise ImportError(
            "to_frame: expected pandas to be installed (Debian: python3-pandas)"
        ) from missing
    return pd.DataFrame(columns, index=index)
