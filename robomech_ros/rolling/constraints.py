"""Constraints of wheels on the twist of their base, and its remaining mobility.

The planar twist is ``[omega, v_x, v_y]`` of the base at its origin, in its own axes.  The point p
of the base has the velocity ``v + omega E p`` with E the quarter turn.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from robomech_ros.errors import (
    BadValueError,
    InconsistentDataError,
    UnderdeterminedError,
    WrongSizeError,
)
from robomech_ros.rolling.argument_checks import check_entries
from robomech_ros.rolling.wheels import Wheel
from robomech_ros.typing import Array

# Singular values below this part of the robot's size are rounding of its geometry.
_RANK = 1e-9
# Steering angles of a posture in which no two wheels agree by chance.
_FIRST, _STEP = 0.3, 0.71


@dataclass(frozen=True)
class Mobility:
    """Mobility of a base, by the names of Campion, Bastin and d'Andrea-Novel.

    Attributes
    ----------
    mobility : int
        Degree of mobility: rates of the base that are free at once.
    steerability : int
        Degree of steerability: steered wheels whose angles are free.
    """

    mobility: int
    steerability: int

    @property
    def maneuverability(self) -> int:
        """Their sum: 3 for a base that can have any centre of rotation, else 2."""
        return self.mobility + self.steerability

    @property
    def type(self) -> str:
        """One of five: (3,0), (2,0), (2,1), (1,1) and (1,2)."""
        return f"({self.mobility},{self.steerability})"


def direction_rows(positions: Array, angles: Array) -> Array:
    """Return rows (..., k, 3): a twist times a row is a velocity at a point in a direction (m/s).

    Positions (k, 2) are in the base (m), angles (..., k) from x (rad).
    """
    c, s = np.cos(angles), np.sin(angles)
    about = positions[:, 0] * s - positions[:, 1] * c
    return np.stack([about, c, s], axis=-1)


def drive_rows(wheels: Sequence[Wheel], angles: Array) -> Array:
    """Return rows (..., k, 3): a twist times a row is how fast the rim of a wheel rolls (m/s).

    ``angles`` (..., k) are the wheels' rolling directions, from x (rad).
    """
    roller = np.array([wheel.roller for wheel in wheels])
    positions = _positions(wheels)
    rows = direction_rows(positions, angles + roller)
    return np.asarray(rows / np.cos(roller)[:, None])


def side_rows(wheels: Sequence[Wheel], angles: Array) -> Array:
    """Return rows (..., k, 3): a twist times a row is how fast a wheel slips sideways (m/s)."""
    positions, c, s = _positions(wheels), np.cos(angles), np.sin(angles)
    return np.stack([positions[:, 0] * c + positions[:, 1] * s, -s, c], axis=-1)


def checked_wheels(wheels: Sequence[Wheel]) -> tuple[Wheel, ...]:
    """Check that these are wheels with different names in different places, and name them."""
    check_entries("wheels", wheels, Wheel, "a list of wheels")
    if not wheels:
        raise WrongSizeError("wheels", 0, "one wheel or more")
    names = wheel_names(wheels)
    found = tuple(replace(one, name=name) for one, name in zip(wheels, names, strict=True))
    for i, name in enumerate(names):
        if name in names[:i]:
            raise BadValueError("wheels", name, "names that differ")
        for j in range(i):
            if np.abs(found[i].position - found[j].position).max() <= _RANK:
                both = f"{names[j]} and {name} at {found[i].position.tolist()}"
                raise BadValueError("wheels", both, "wheels in different places")
    if not any(wheel.driven for wheel in found):
        raise BadValueError("wheels", ", ".join(names), "a driven wheel among them")
    return found


def wheel_names(wheels: Sequence[Wheel]) -> tuple[str, ...]:
    """Return the names of wheels; one without a name is called by its number."""
    return tuple(wheel.name or f"wheel_{i}" for i, wheel in enumerate(wheels))


def checked_mobility(wheels: Sequence[Wheel]) -> Mobility:
    """Find the mobility that wheels leave, and check that they determine the base's twist.

    Raises InconsistentDataError for fixed wheels on different axles, whose base could go round one
    point at most, and UnderdeterminedError for driven wheels that leave a twist free, or steering
    that does not suffice.
    """
    size = max(float(np.abs(_positions(wheels)).max()), _RANK)
    scale = np.array([1.0 / size, 1.0, 1.0])
    names = wheel_names(wheels)
    kinds = np.array([wheel.kind for wheel in wheels])
    generic = np.where(kinds == "steered", _FIRST + _STEP * np.arange(len(wheels)), 0.0)
    angles = np.array([wheel.heading for wheel in wheels]) + generic
    sides = side_rows(wheels, angles) * scale
    rigid = sides[kinds == "fixed"]
    held = _rank(rigid)
    if held > 1:
        which = ", ".join(np.array(names)[kinds == "fixed"].tolist())
        expected = "fixed wheels on one common axle: these cannot all roll"
        raise InconsistentDataError("wheels", which, expected)
    turned = sides[kinds == "steered"]
    both = min(_rank(np.concatenate([rigid, turned])), 2)
    driven = np.array([wheel.driven for wheel in wheels])
    told = np.concatenate([(drive_rows(wheels, angles) * scale)[driven], rigid, turned])
    _, values, axes = np.linalg.svd(np.concatenate([told, np.zeros((3, 3))]))
    free = axes[np.count_nonzero(values > _RANK) :] * scale
    if len(free):
        free = free / np.linalg.norm(free, axis=1)[:, None]
        shown = np.round(free, 4).tolist()
        expected = "driven wheels that determine every twist; free now are twists [w, vx, vy]"
        raise UnderdeterminedError("wheels", ", ".join(names), f"{expected} {shown}", free.tolist())
    return Mobility(3 - both, both - held)


def _positions(wheels: Sequence[Wheel]) -> Array:
    return np.array([wheel.position for wheel in wheels]).reshape(-1, 2)


def _rank(rows: Array) -> int:
    if not len(rows):
        return 0
    return int(np.count_nonzero(np.linalg.svd(rows, compute_uv=False) > _RANK))
