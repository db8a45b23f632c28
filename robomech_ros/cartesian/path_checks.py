"""Checks that end a joint path early: singularities, jumps, conditions of the caller."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros.cartesian.path_models import PathModel
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.robots import SerialChain
from robomech_ros.spatial.arrays import listed, positive_number
from robomech_ros.trajectory import JointPath, PathCut, PathTrackingStatus
from robomech_ros.trajectory.paths.path_cuts import PLACES, last_valid_coordinate
from robomech_ros.typing import Array, BoolArray

# Finds where a joint path must end, and why; None where nowhere.
PathCheck = Callable[[JointPath], PathCut | None]
# Points between which a relative jump is looked for, at least: of fewer the mean says nothing.
_FEWEST = 10
_ABOVE = "a number above 0"


@dataclass(frozen=True)
class PathStopLimits:
    """Bounds that end a path early.

    Attributes
    ----------
    condition : float
        Largest condition number of the Jacobian, lengths over the size of the arm; infinite to pass
        singular postures as slowly as the joints need.
    step : float
        Distance of neighbouring poses (m) between which a joint may move by no more than
    revolute_jump, prismatic_jump : float
        rad, m; infinite for any move.
    checks : sequence of PathCheck
        Each finds where else a joint path must end, such as `stop_on_condition`.
    """

    condition: float = 200.0
    step: float = 0.01
    revolute_jump: float = 0.5
    prismatic_jump: float = 0.1
    checks: Sequence[PathCheck] = ()

    def __post_init__(self) -> None:
        for name in ("condition", "step", "revolute_jump", "prismatic_jump"):
            object.__setattr__(self, name, positive_number(name, getattr(self, name), _ABOVE))
        expected = "a list of callables"
        checks = tuple(listed("checks", self.checks, expected))
        if not all(callable(one) for one in checks):
            raise BadValueError("checks", self.checks, expected)
        object.__setattr__(self, "checks", checks)
        if math.isinf(self.step):
            raise BadValueError("step", self.step, "a finite distance (m)")


def singular_cut(robot: PathModel, joints: JointPath, bounds: PathStopLimits) -> PathCut | None:
    """Find where the condition number rises over its bound."""
    if not math.isfinite(bounds.condition):
        return None

    def over(q: Array) -> BoolArray:
        singular = robot.singular_values(q)
        return singular[:, 0] > bounds.condition * singular[:, -1]

    s = last_valid_coordinate(joints, over)
    if s is None:
        return None
    text = f"the condition number rises over {bounds.condition:.6g}: too near to a singularity"
    part = robot.singular_part(joints.until(s)) if s > 0.0 else ""
    text += f", {part.replace(' is ', ' is nearly ')}" if part else ""
    return PathCut(s, PathTrackingStatus.SINGULAR, text)


def jump_cut(robot: PathModel, joints: JointPath, bounds: PathStopLimits) -> PathCut | None:
    """Find where a joint moves too far between neighbouring poses."""
    names, units = robot.limits.joint_names, robot.limits.units
    slides = np.array(units) == "m"
    largest = np.where(slides, bounds.prismatic_jump, bounds.revolute_jump)
    places, moves = _moves(joints, max(math.ceil(joints.length / bounds.step), 1))
    far = np.flatnonzero((moves > largest).any(axis=1))
    if not len(far):
        return None
    k = int(far[0])
    joint = int(np.argmax(moves[k] / largest))
    unit = units[joint]
    text = (
        f"joint '{names[joint]}' would move by {moves[k, joint]:.3g} {unit} in "
        f"{places[k + 1] - places[k]:.3g} m, over the threshold of a jump, "
        f"{largest[joint]:.3g} {unit}"
    )
    return PathCut(float(places[k]), PathTrackingStatus.JUMP, text, joint)


def _moves(joints: JointPath, count: int) -> tuple[Array, Array]:
    """Return count + 1 places of a joint path (m) and how far each joint moves between them."""
    places = np.linspace(0.0, joints.length, count + 1)
    return places, np.abs(np.diff(joints.derivatives(places)[0], axis=0))


def relative_jump(chain: SerialChain, step: float, factor: float) -> PathCheck:
    """End a path where the joints together move by much more than on average.

    This is what MoveIt calls the jump threshold.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    step : float
        Distance of neighbouring poses (m); at least ten steps are examined.
    factor : float
        How many times the mean move a step may be; infinite for any.

    Returns
    -------
    PathCheck
        For `follow_path` and `plan_along`.
    """
    check_chain(chain)
    length = positive_number("step", step, _ABOVE)
    most_factor = positive_number("factor", factor, _ABOVE)

    def check(joints: JointPath) -> PathCut | None:
        if math.isinf(most_factor):
            return None
        places, moves = _moves(joints, max(math.ceil(joints.length / length), _FEWEST))
        total = moves.sum(axis=1)
        far = np.flatnonzero(total > most_factor * float(total.mean()))
        if not len(far):
            return None
        k = int(far[0])
        joint = int(np.argmax(moves[k]))
        text = (
            f"all joints together would move by {total[k]:.3g}, most of it joint "
            f"'{chain.joint_names[joint]}', over jump_threshold {most_factor:g} times the mean "
            f"{total.mean():.3g}"
        )
        return PathCut(float(places[k]), PathTrackingStatus.JUMP, text, joint)

    return check


def stop_on_condition(broken: Callable[[Array], str], step: float) -> PathCheck:
    """End a path where a condition on the joint values breaks.

    Parameters
    ----------
    broken : callable
        Says for joint values (n,), rad or m, what is broken; an empty text where nothing is.
    step : float
        Largest distance (m) between examined places; there are at least 500.

    Returns
    -------
    PathCheck
        For `follow_path` and `plan_along`; the path is REJECTED from there on.
    """
    if not callable(broken):
        raise BadValueError("broken", broken, "a callable")
    length = positive_number("step", step, _ABOVE)

    def check(joints: JointPath) -> PathCut | None:
        count = max(math.ceil(joints.length / length), PLACES)
        s = last_valid_coordinate(
            joints, lambda rows: np.array([bool(broken(q)) for q in rows]), count=count
        )
        if s is None:
            return None
        beyond = min(s + joints.length / count, joints.length)
        text = broken(joints.derivatives(s)[0]) or broken(joints.derivatives(beyond)[0])
        return PathCut(s, PathTrackingStatus.REJECTED, text)

    return check
