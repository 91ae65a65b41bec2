"""Converts keywords of the package's functions for the compiled module."""

from __future__ import annotations

from typing import Any

from .errors import InvalidArgument
from .robots import Robot
from .tolerances import native_tolerances


def keywords(given: dict[str, Any], robot: Robot) -> dict[str, Any]:
    """Keywords for the compiled module: lists instead of iterables, compiled objects instead of
    Python ones (of this robot)."""
    made = dict(given)
    for key in ("fixed", "free"):
        if isinstance(made.get(key), str):
            raise InvalidArgument(f'{key}: expected names in a list, got the text "{made[key]}"')
        if made.get(key) is not None:
            made[key] = list(made[key])
    if made.get("tracker_um") is not None:
        made["tracker_um"] = [float(one) for one in made["tracker_um"]]
    if made.get("tolerances") is not None:
        made["tolerances"] = native_tolerances(made["tolerances"], robot)
    return made
