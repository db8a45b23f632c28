"""Printed form of models and results: a few lines; in lists and errors one line."""

import dataclasses
from collections.abc import Mapping
from enum import Enum
from typing import Any

import numpy as np

MOST_LINES = 10
_MOST_NUMBERS = 8
_LONGEST = 80


class Printed:
    """Base of dataclasses with a readable ``str``, one field a line, and a short ``repr``."""

    def __init_subclass__(cls) -> None:
        # A dataclass writes a `repr` with all numbers unless the class itself has one.
        if "__repr__" not in cls.__dict__:
            cls.__repr__ = Printed.__repr__  # type: ignore[method-assign]

    def __repr__(self) -> str:
        shown = (f"{name}={value}" for name, value in self._facts() if "shape" not in value)
        return f"{type(self).__name__}({_shortened(', '.join(shown))})"

    def __str__(self) -> str:
        lines = [type(self).__name__, *(f"  {name}: {value}" for name, value in self._facts())]
        return "\n".join(lines[:MOST_LINES])

    def _facts(self) -> list[tuple[str, str]]:
        fields = dataclasses.fields(self)  # type: ignore[arg-type]
        facts = [(one.name, brief(getattr(self, one.name))) for one in fields]
        return [(name, value) for name, value in facts if value and name != "document"]


def brief(value: Any) -> str:
    """Show a value in one short line, empty for what is empty; large arrays by their shape."""
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, str):
        return _shortened(" ".join(value.split()))
    if value is None:
        return ""
    if isinstance(value, bool | int | np.integer | np.bool_):
        return str(value)
    if isinstance(value, float | np.floating):
        return f"{value:.6g}"
    if isinstance(value, np.ndarray):
        if value.ndim == 1 and 0 < value.size <= _MOST_NUMBERS and value.dtype.kind in "bif":
            return f"[{', '.join(f'{round(float(x), 12) + 0.0:.4g}' for x in value)}]"
        return f"array of shape {value.shape}" if value.size else ""
    if isinstance(value, Mapping):
        return _listed([f"{key}: {brief(one)}" for key, one in value.items()])
    if isinstance(value, tuple | list):
        return _listed([brief(one) for one in value[: _MOST_NUMBERS + 1]], len(value))
    return repr(value) if isinstance(value, Printed) else type(value).__name__


def _listed(entries: list[str], count: int | None = None) -> str:
    count = len(entries) if count is None else count
    text = ", ".join(entries)
    return text if len(text) <= _LONGEST and count <= _MOST_NUMBERS else f"{count} entries"


def _shortened(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."
