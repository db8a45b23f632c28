"""Collision checks of a motion before and during its execution, since the world may change."""

import math
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from robomech_ros.collision import PlanningScene
from robomech_ros.collision.departures import check_departure
from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.moveit.whole_robot import Positions
from robomech_ros.robots import SerialChain
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.waypoints import Waypoints
from robomech_ros.typing import Array

# Shortest time between two checks of a changing world, s.
_PERIOD = 0.1
# Longest time from a change to the end of its check, s; if it takes longer, the robot stops.
_LATEST = 0.4
# A repeated check covers at least this time ahead, and at most twice this time (s).
_AHEAD = 5.0
# The path is sampled at this period (s) to locate the robot on it. The search ahead allows for a
# clock of the robot that runs this much faster than the machine's, plus a margin (s).
_GRID, _FASTEST_CLOCK, _MARGIN = 0.02, 4.0, 0.5
_MOST_SAMPLES = 20_000
_LATE = (
    "the scene changed up to {:.2g} s before the check of the motion ended, over the limit of "
    "{:g} s: free processor time, or change the scene less often"
)
# Number of postures that are searched for the largest depth.
_DEPTHS = 100


class MotionWatch:
    """Checks a motion for contacts, and later the rest of it.

    - ``known``: returns the present positions of all known joints (rad or m).
    - ``joint_names``: the moving joints. A motion of unknown joints is not checked: the controller
      refuses it.
    - ``waypoints``: waypoints of the motion, in the order of the names (rad or m).
    """

    def __init__(
        self,
        model: RobotModel,
        known: Callable[[], Positions],
        joint_names: Sequence[str],
        waypoints: Waypoints,
    ) -> None:
        #: The chain of exactly these joints, or the configured one.
        self.chain = _chain_of(model, joint_names)
        self._known = known
        self._motion = _motion(self.chain, known(), list(joint_names), waypoints)
        self._world: Any = None
        # Times: before the first no check is due; at the second the checked world was the present
        # one; since the third the present world may differ from it.
        self._due, self._current_at, self._unchecked_since = 0.0, math.inf, math.inf
        self._checked_until = -math.inf
        self._index, self._located_at = 0, time.monotonic()
        if self._motion is not None:
            begin, end = float(self._motion.breaks[0]), float(self._motion.breaks[-1])
            count = min(int((end - begin) / _GRID) + 2, _MOST_SAMPLES)
            self._times: Array = np.linspace(begin, end, count)
            self._postures: Array = self._motion.sample(self._times).position

    def is_due(self, world: Any) -> bool:
        """Return whether to check the motion: the world changed, or the checked part runs out."""
        if self._motion is None:
            return False
        self._follow()
        now, is_same = time.monotonic(), world is self._world
        if is_same:
            self._current_at = now
        ahead = min(float(self._times[self._index]) + _AHEAD, float(self._times[-1]))
        if (is_same and self._checked_until >= ahead) or now < self._due:
            return False
        self._world, self._unchecked_since, self._current_at = world, self._current_at, now
        return True

    def obstruction(self, scene: PlanningScene) -> str:
        """Say why the rest of the motion must not go on in the chain's scene; "" if it may.

        Either it would touch something, or the check was so late that the robot might not stop in
        time. The first check covers the whole motion, later ones the next seconds.
        """
        assert self._motion is not None
        if self._index == len(self._times) - 1:
            return ""
        begun, begin = time.monotonic(), float(self._times[self._index])
        rest = part = self._motion.after(begin)
        if self._checked_until > -math.inf:
            last = int(rest.breaks.searchsorted(begin + 2.0 * _AHEAD))
            part = rest.between(0, min(last, len(rest.breaks) - 1))
        found = check_departure(scene, part)
        if not found.free and part is not rest:
            # A robot in contact may need more time to leave it.
            found = check_departure(scene, rest)
        self._checked_until = float(part.breaks[-1])
        now = time.monotonic()
        # Other callbacks get at least twice this time.
        self._due = now + max(_PERIOD, 2.0 * (now - begun))
        if found.free:
            late = now - self._unchecked_since
            return "" if late <= _LATEST else _LATE.format(late, _LATEST)
        times = np.linspace(found.parameter, rest.breaks[-1], _DEPTHS)
        distances = scene.clearance(rest.sample(times).position).distance
        depth = max(-float(np.min(distances)), 0.0)
        first, second = found.bodies
        where = f"at {found.parameter:.4g} s of the motion, up to {depth:.3g} m deep"
        return f"'{first}' and '{second}' would touch {where}"

    def _follow(self) -> None:
        """Locate the robot on its path."""
        known, names, now = self._known(), self.chain.joint_names, time.monotonic()
        if any(name not in known for name in names):
            return
        step = float(self._times[1] - self._times[0])
        reach = int((_FASTEST_CLOCK * (now - self._located_at) + _MARGIN) / max(step, 1e-9)) + 1
        ahead = self._postures[self._index : self._index + reach]
        apart = ahead - np.array([known[name] for name in names])
        turns = np.where(self.chain.continuous, np.round(apart / math.tau), 0.0)
        self._index += int(np.argmin(np.abs(apart - math.tau * turns).max(axis=1)))
        self._located_at = now


def _motion(
    chain: SerialChain, known: Positions, names: list[str], waypoints: Waypoints
) -> PiecewisePolynomial | None:
    """Return the curve of a chain's joints; None if some of their positions are not known."""
    missing = [name for name in chain.joint_names if name not in names]
    if any(name not in known for name in missing):
        return None
    times, rows = waypoints.times, [waypoints.positions, waypoints.velocities]
    rows.append(waypoints.accelerations)
    if times[0] > 0.0:
        # The motion begins where the robot is, at rest.
        if any(name not in known for name in names):
            return None
        here = np.array([[known[name] for name in names]])
        first = here, np.zeros_like(here), np.zeros_like(here)
        times = np.append(0.0, times)
        rows = [
            None if part is None else np.concatenate((one, part))
            for one, part in zip(first, rows, strict=True)
        ]
    if len(times) < 2:
        return None
    positions, *rates = (
        None if part is None else _columns(chain, part, names, known if k == 0 else {})
        for k, part in enumerate(rows)
    )
    assert positions is not None
    return Waypoints(times, positions, *rates).curve


def _columns(chain: SerialChain, rows: Array, names: list[str], still: Positions) -> Array:
    """Return the columns (m, n) of a chain's joints; those that are not named stand still."""
    # Rows of NaN stay NaN in all columns.
    zeros = 0.0 * rows[:, 0]
    columns = [
        rows[:, names.index(name)] if name in names else zeros + still.get(name, 0.0)
        for name in chain.joint_names
    ]
    return np.stack(columns, axis=-1)


def _chain_of(model: RobotModel, joint_names: Sequence[str]) -> SerialChain:
    """Return the chain of exactly these joints; the configured one if there is none."""
    for group in model.groups:
        with suppress(RobomechError):
            chain = model.chain_of(group)
            if set(chain.joint_names) == set(joint_names):
                return chain
    return model.chain
