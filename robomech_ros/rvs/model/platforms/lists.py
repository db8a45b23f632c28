"""Assembly modes and branches of a parallel robot, and distance from singularities."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors.formatting import counted
from robomech_ros.parallel import (
    LoopSingularity,
    Mechanism,
    ParallelRobot,
    dexterity,
    loop_singularity,
)
from robomech_ros.parallel.kinetostatics.conditioning import scaled_matrices
from robomech_ros.rvs.model.draggable import ROUNDING
from robomech_ros.rvs.model.postures import MOST_POSTURES, Posture
from robomech_ros.typing import Array

# Other poses for the same drives, or other joints for the same pose.
LISTS = ("assembly modes", "limb branches")
ANGULAR = 3


@dataclass(frozen=True, eq=False)
class PlatformList:
    """Postures that the page lists and draws as ghosts."""

    #: Postures of all joints; the present one is among them.
    postures: tuple[Posture, ...]
    #: Whether the list is provably complete.
    complete: bool
    #: Sentence on the number of postures.
    text: str


def platform_list(
    robot: ParallelRobot | Mechanism, q: Array, kind: str, before: Sequence[Posture] = ()
) -> PlatformList:
    """Find the assembly modes of a robot, or all branches of its limbs.

    - ``q``: present posture with closed loops (rad or m), shape (n,).
    - ``kind``: one of :data:`LISTS`.
    - ``before``: the previous list, whose postures keep their numbers.
    """
    mechanism = robot.mechanism
    if kind == LISTS[0]:
        found = mechanism.direct(q[mechanism.drive_index], seed=q)
        rows, names, complete = found.q, ["" for _ in found.q], found.complete
        count = counted(len(rows), "assembly mode")
        whether = "these are all" if complete else "there may be more"
        text = f"{count} for these drives ({found.family}); {whether}."
    else:
        branches = mechanism.postures(mechanism.pose(q), seed=q)
        rows, names, complete = branches.q, list(branches.branches), True
        noun = "branch" if len(rows) == 1 else "branches"
        text = f"{len(rows)} {noun} of the limbs hold the platform here; these are all."
    order = _as_before(rows, before)
    postures = tuple(_postures(robot, q, rows[order], [names[k] for k in order]))
    outside = sum(one.margin < 0.0 for one in postures)
    if outside:
        text += f" {outside} of them beyond limits of joints."
    if len(postures) > MOST_POSTURES:
        text += f" The first {MOST_POSTURES} are shown."
    return PlatformList(postures[:MOST_POSTURES], complete, text)


def _as_before(rows: Array, before: Sequence[Posture]) -> list[int]:
    """Order postures like the nearest ones of the previous list."""
    left = list(range(len(rows)))
    order: list[int] = []
    for one in before:
        if left and len(one.q) == rows.shape[1]:
            away = [float(np.abs(np.sin(0.5 * (rows[k] - one.q))).max()) for k in left]
            order.append(left.pop(int(np.argmin(away))))
    return order + left


def _postures(
    robot: ParallelRobot | Mechanism, q: Array, rows: Array, names: Sequence[str]
) -> list[Posture]:
    if not len(rows):
        return []
    mechanism = robot.mechanism
    conditions = _conditions(robot, rows)
    margins = mechanism.limit_margin(rows).min(axis=1)
    # Joints at the ends of their ranges count as inside.
    margins = np.where(margins < -ROUNDING, margins, np.maximum(margins, 0.0))
    distances = np.abs(rows - q).max(axis=1)
    found = []
    for k, name in enumerate(names):
        numbers = (float(distances[k]), float(margins[k]), float(conditions[k]))
        found.append(Posture(rows[k], name or f"mode {k + 1}", *numbers))
    return found


def _conditions(robot: ParallelRobot | Mechanism, rows: Array) -> Array:
    """Return the condition number of the map from drives to twists in postures (k, n)."""
    mechanism = robot.mechanism
    if isinstance(robot, Mechanism):
        scale = np.repeat((mechanism.size, 1.0), 3)
        maps = [scale[:, None] * mechanism.twist_matrix(q) for q in rows]
        return np.array([np.linalg.cond(one) for one in maps])
    drives = rows[:, mechanism.drive_index]
    with np.errstate(divide="ignore"):
        return 1.0 / np.atleast_1d(dexterity(robot, mechanism.pose(rows), drives))


@dataclass(frozen=True, eq=False)
class PlatformFacts:
    """Facts about a posture."""

    report: LoopSingularity
    #: The twist of the platform that the drives resist least: angular first, at its origin, in the
    #: base (rad/s, m/s), shape (6,).
    weakest: Array
    #: Whether the platform can both rotate and translate.
    mixed: bool

    @property
    def lines(self) -> list[tuple[str, str]]:
        """Facts as pairs of label and text."""
        report = self.report
        first, second = (f"{value:.3f}" for value in report.distances)
        lines = [
            ("here", report.summary),
            ("type 1", f"{first} away: a limb ends its reach, motions are lost; 0 is singular"),
            ("type 2", f"{second} away: motions are free, drives hold nothing; 0 is singular"),
            ("dexterity", f"{report.dexterity:.3f}; 1 is isotropic, 0 singular"),
        ]
        if self.mixed:
            lines.append(("length", f"{report.length:.4f} m, to compare turns with motions"))
        return lines


def platform_facts(robot: ParallelRobot | Mechanism, q: Array) -> PlatformFacts:
    """Analyse a posture.

    - ``q``: all joints (rad or m), loops closed, shape (n,).
    """
    mechanism = robot.mechanism
    T = mechanism.pose(q)
    own = q if isinstance(robot, Mechanism) else q[mechanism.drive_index]
    report = loop_singularity(robot, T, own)
    scaled = scaled_matrices(robot, T, own, report.length)
    weakest = scaled.motions @ np.linalg.svd(scaled.K)[2][-1]
    weakest[:ANGULAR] /= scaled.scale
    parts = scaled.motions[:ANGULAR], scaled.motions[ANGULAR:]
    return PlatformFacts(report, weakest, all(np.abs(part).max() > 1e-9 for part in parts))
