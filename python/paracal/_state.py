"""What pickles refer to: functions of the compiled module cannot be named in a pickle."""

from __future__ import annotations

from typing import Any

from . import _paracal


def made_by(function: str, *arguments: Any) -> Any:
    """The object that a function of the compiled module makes."""
    return getattr(_paracal, function)(*arguments)
