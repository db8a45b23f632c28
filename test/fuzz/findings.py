"""Checks of responses for faults."""

from __future__ import annotations

import array
import functools
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["code_of", "fault_of", "unexpected_number"]

INTERNAL = 900
ROOT = Path(__file__).resolve().parents[2]


def code_of(answer: Any) -> int:
    """Return the code of an answer; 0 where it has none."""
    code = getattr(answer, "error_code", 0)
    return int(getattr(code, "val", code))


def fault_of(answer: Any, kind: str) -> str:
    """Say what no answer may be; empty where there is nothing.

    Parameters
    ----------
    answer : message
        The response or result.
    kind : str
        Its interface, such as ``robomech_interfaces/srv/SolveIK``.
    """
    code = code_of(answer)
    if code == INTERNAL:
        return f"{INTERNAL}: {answer.error_msg}"
    if code == 1 and kind.startswith("moveit"):
        code = 0
    if code == 0 and (found := unexpected_number(answer, kind)):
        return f"code 0 with {found}"
    return ""


def unexpected_number(message: Any, kind: str) -> str:
    """Name an infinite number, or NaN, where a message may have none; empty for none."""
    allowed = _may_be_infinite(kind)
    for name, value in _numbers(message):
        if not math.isfinite(value) and name.split(".")[0].split("[")[0] not in allowed:
            return f"{name} = {value}"
    return ""


@functools.cache
def _may_be_infinite(kind: str) -> frozenset[str]:
    """Name the fields of an answer whose comments say that they may be infinite or NaN."""
    package, folder, name = kind.split("/")
    if package != "robomech_interfaces":
        return frozenset()
    path = ROOT / package / folder / f"{name}.{folder}"
    found, comment = set(), ""
    for line in path.read_text(encoding="utf-8").splitlines():
        text, _, remark = line.partition("#")
        words = text.split()
        if not words:
            comment = comment + " " + remark if remark else ""
        elif len(words) > 1 and "=" not in words[1]:
            if re.search(r"infinit|\binf\b|\bnan\b", comment + remark, re.IGNORECASE):
                found.add(words[1])
            comment = ""
    return frozenset(found)


def _numbers(message: Any, name: str = "") -> Iterator[tuple[str, float]]:
    """Yield all numbers with a point in a message, each with its name."""
    if isinstance(message, float):
        yield name, message
    elif isinstance(message, array.array | np.ndarray):
        values = np.asarray(message, dtype=float)
        bad = np.flatnonzero(~np.isfinite(values))
        yield from ((f"{name}[{k}]", float(values[k])) for k in bad[:1])
    elif isinstance(message, list | tuple):
        for k, entry in enumerate(message):
            yield from _numbers(entry, f"{name}[{k}]")
    elif hasattr(message, "get_fields_and_field_types"):
        for field in message.get_fields_and_field_types():
            yield from _numbers(getattr(message, field), f"{name}.{field}".lstrip("."))
