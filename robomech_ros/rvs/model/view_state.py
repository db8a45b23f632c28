"""View state as text for the page's address: posture, camera, visible items."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.typing import Array

LONGEST = 2000
# Largest distance of the camera (m), and least angle of its direction to the vertical (sine).
FARTHEST_EYE, STEEPEST = 1e4, 1e-4
_FORM = "q:...;eye:x,y,z;at:x,y,z;show:..."


class ViewState(NamedTuple):
    """State of the view of a page.

    - ``eye``, ``at``: position of the eye, and the point that it looks at (m), shape (3,).
    """

    #: Posture (rad or m), shape (n,).
    q: Array
    eye: Array
    at: Array
    #: Switches by name, and whether they are on.
    shown: Mapping[str, bool]


def text_from_state(state: ViewState) -> str:
    """Write a state as a text of letters, digits and ``.,:;_-+``."""
    parts = {"q": _written(state.q, 9), "eye": _written(state.eye, 4), "at": _written(state.at, 4)}
    parts["show"] = ",".join(_plain(name) for name, on in state.shown.items() if on)
    return ";".join(f"{key}:{value}" for key, value in parts.items())


def state_from_text(text: str, joints: int, names: Sequence[str]) -> ViewState:
    """Read a state.

    - ``text``: as :func:`text_from_state` writes it.
    - ``joints``: number of joints of the arm; their limits are not checked here.
    - ``names``: names of all switches.
    """
    if len(text) > LONGEST:
        raise BadValueError("view", f"{len(text)} characters", f"at most {LONGEST}")
    pairs = [part.partition(":") for part in text.strip().split(";")]
    given = {key: value for key, _, value in pairs}
    if len(given) != len(pairs) or set(given) != {"q", "eye", "at", "show"}:
        raise BadValueError("view", text[:80], _FORM)
    eye, at = (_read(key, given[key], 3) for key in ("eye", "at"))
    line = at - eye
    if np.abs([eye, at]).max() > FARTHEST_EYE or not (
        math.hypot(line[0], line[1]) > STEEPEST * float(np.linalg.norm(line))
    ):
        expected = f"two points that are not above each other, within {FARTHEST_EYE:g} m"
        raise BadValueError("eye and at of the view", f"{given['eye']} and {given['at']}", expected)
    known = {_plain(name): name for name in names}
    chosen = [name for name in given["show"].split(",") if name]
    for name in chosen:
        if name not in known:
            raise BadValueError("show of the view", name[:80], ", ".join(known))
    shown = {name: plain in chosen for plain, name in known.items()}
    return ViewState(_read("q", given["q"], joints), eye, at, shown)


def _written(values: Array, digits: int) -> str:
    # Write -0 as 0.
    return ",".join(f"{round(float(value), digits) + 0.0:.{digits + 2}g}" for value in values)


def _plain(name: str) -> str:
    return name.replace(" ", "_")


def _read(key: str, text: str, count: int) -> Array:
    expected = f"{count} finite numbers"
    try:
        values = np.array([float(part) for part in text.split(",")])
    except ValueError:
        raise BadValueError(f"{key} of the view", text[:80], expected) from None
    if len(values) != count or not np.isfinite(values).all():
        raise BadValueError(f"{key} of the view", text[:80], expected)
    return values
