"""Study of a pose: all postures that reach it, or the reason why there is none."""

import re
from dataclasses import dataclass, replace

import numpy as np

from robomech_ros.errors.formatting import counted
from robomech_ros.kinematics import inverse_kinematics
from robomech_ros.kinematics.inverse.nearest_posture import least_squares_posture
from robomech_ros.kinematics.inverse.request.request import as_request
from robomech_ros.kinematics.inverse.result.result import InverseKinematicsResult
from robomech_ros.kinematics.inverse.result.status import Status
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array

# Number of shown samples of a self-motion; no other arm has more postures.
MOST_POSTURES = 16
# The nearest posture that is found from the present one is shown as long as no other misses the
# pose by less than this part of it: it moves steadily while the pose is dragged.
STEADY = 0.95
# Largest distance of a posture from an equal present one (rad or m).
HERE = 1e-6


@dataclass(frozen=True, eq=False)
class Posture:
    """One posture of the tip at a pose."""

    #: Joint values (rad or m), shape (n,).
    q: Array
    #: Branch of the inverse kinematics.
    name: str
    #: Largest move of a joint from the present posture (rad or m).
    distance: float
    #: Distance of the joint nearest to a limit (rad or m).
    margin: float
    #: Condition number of the Jacobian in SI units; infinite where singular.
    condition: float

    @property
    def is_here(self) -> bool:
        """True if it is the present posture."""
        return self.distance < HERE


@dataclass(frozen=True, eq=False)
class PoseStudy:
    """Displayed results for one pose.

    - ``position_error``, ``orientation_error``: deviation of the nearest posture from the pose (m,
      rad); 0 if a posture takes it.
    """

    #: ``T_base_tip`` (m), shape (4, 4).
    target: Array
    #: Postures inside the limits.  They are sorted by their names, so that each keeps its place
    #: while the arm moves; samples of a self-motion are sorted by their distance.
    postures: tuple[Posture, ...]
    #: Whether the list of postures is provably complete.
    complete: bool
    status: Status
    #: Sentence on why there is no posture, or another remark; may be empty.
    reason: str
    #: The posture inside the limits that misses the pose least, shape (n,), if none takes it.
    nearest: Array | None = None
    position_error: float = 0.0
    orientation_error: float = 0.0
    #: Sentence about the pose that replaces the number of postures.
    text: str | None = None

    @property
    def nearest_posture(self) -> Posture | None:
        """The posture nearest to the present one; None where there is none."""
        return min(self.postures, key=lambda posture: posture.distance, default=None)

    @property
    def sentence(self) -> str:
        """Sentence on the number of postures, or the reason for none."""
        if self.text is not None:
            return self.text
        if not self.postures:
            return f"No posture: {self.reason or self.status.name}."
        count = len(self.postures)
        if self.complete:
            what = "this is the only one" if count == 1 else "these are all"
        else:
            what = "there may be more"
        text = f"{counted(count, 'posture')} inside the limits; {what}."
        return f"{text} {self.reason[0].upper()}{self.reason[1:]}." if self.reason else text


def pose_summary(
    target: Array,
    text: str,
    status: Status = Status.SUCCESS,
    postures: tuple[Posture, ...] = (),
    complete: bool = True,
) -> PoseStudy:
    """Return the study of a pose, with a sentence of the robot."""
    return PoseStudy(target, postures, complete, status, "", text=text)


def study_pose(chain: SerialChain, T: Array, present: Array) -> PoseStudy:
    """Find every posture of an arm at a pose, or the nearest one and the reason.

    - ``present``: present posture of the arm (rad or m), inside its limits, shape (n,).
    """
    result = inverse_kinematics(chain, T, seed=present)
    known = (result.complete, result.status, result.reason.rstrip("."))
    if len(result):
        return PoseStudy(result.target, _postures(result), *known)
    nearest, position, orientation = _nearest(chain, result.target, present)
    return PoseStudy(result.target, (), *known, nearest, position, orientation)


def _postures(result: InverseKinematicsResult) -> tuple[Posture, ...]:
    columns = (result.branches, result.seed_distance, result.limit_margin, result.condition_number)
    found: list[Posture] = []
    for q, name, *numbers in zip(result.q, *columns, strict=True):
        # A sample of a self-motion may appear twice, and only once with its name.
        again = next((k for k, one in enumerate(found) if np.abs(q - one.q).max() < HERE), None)
        if again is None:
            found.append(Posture(q, name, *map(float, numbers)))
        elif not found[again].name:
            found[again] = replace(found[again], name=name)
    found = [
        one if one.name else replace(one, name=f"sample {number}")
        for number, one in enumerate(found[:MOST_POSTURES], start=1)
    ]
    if result.family != "redundant":
        found.sort(key=lambda posture: _natural(posture.name))
    return tuple(found)


def _natural(name: str) -> list[tuple[str, int]]:
    """Order posture-2 before posture-10."""
    return [(text, int(number or 0)) for text, number in re.findall(r"(\D*)(\d*)", name)]


def _nearest(chain: SerialChain, T: Array, present: Array) -> tuple[Array, float, float]:
    request = as_request(chain, present, True, False, "linf", None)
    steady = least_squares_posture(chain, T, request, starts=1)
    best = least_squares_posture(chain, T, request)
    errors = [(one.position_error, one.orientation_error) for one in (steady, best)]
    if STEADY * np.hypot(*errors[0]) <= np.hypot(*errors[1]):
        return steady.best, *errors[0]
    return best.best, *errors[1]
