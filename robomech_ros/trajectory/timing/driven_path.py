"""Paths of robots: which of the joints have drives, and what these exert there."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import shaped_array
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.typing import Array, ArrayLike, IntArray

Dynamics = Callable[[Array, Array, Array], ArrayLike]
# A function of the rates of all joints; for a `DrivenRobot`, of all joint values and drive rates.
Friction = Callable[..., ArrayLike]


class DrivenRobot(Protocol):
    """Bodies with n joints, of which m have drives that move all others.

    Every ``robomech_ros.dynamics.DynamicSystem`` is one, such as ``ParallelDynamics``.
    """

    @property
    def drives_at(self) -> IntArray:
        """Indices of the drives among the joints, shape (m,)."""
        ...

    def checked_posture(self, q: Array, what: str) -> Array:
        """Return joint values (n,) whose loops are closed, with the same drives, or raise."""
        ...

    def inverse(self, q: Array, rates: Array, accelerations: Array) -> ArrayLike:
        """Compute the efforts of the drives (k, m) for joints (k, n) and motions of the drives."""
        ...


@dataclass(frozen=True, eq=False)
class DrivenPath:
    """A path of n joints (rad or m), and what the m drives of a robot exert on it.

    A callable robot is the inverse dynamics of one that has a drive at every joint; the friction is
    that of `torque_limited`.
    """

    path: PiecewisePolynomial
    robot: DrivenRobot | Dynamics
    friction: Friction | None

    def __post_init__(self) -> None:
        if not _is_robot(self.robot):
            require_callable("inverse_dynamics", self.robot)
        if self.friction is not None:
            require_callable("friction", self.friction)

    @property
    def drives(self) -> list[int]:
        """Indices of the drives among the joints."""
        robot: Any = self.robot
        return robot.drives_at.tolist() if _is_robot(robot) else list(range(self.path.joints))

    def on_path(self, s: Array) -> tuple[Array, Array, Array]:
        """Joint values (k, n), and two derivatives of the drives (k, m) over s."""
        at, drives = self.path.sample(s), self.drives
        return self.closed(at.position), at.velocity[:, drives], at.acceleration[:, drives]

    def posture(self, s: Array, drives: Array) -> Array:
        """Joint values (k, n) where the drives have values (k, m) at places of the path."""
        if not _is_robot(self.robot):
            return drives
        near = self.path.sample(s).position
        near[:, self.drives] = drives
        return self.closed(near)

    def closed(self, q: Array) -> Array:
        """Joint values (k, n) with closed loops: those of a path close them but nearly."""
        robot: Any = self.robot
        if not _is_robot(robot):
            return q
        return np.array([robot.checked_posture(row, "path") for row in q])

    def torques(self, q: Array, rates: Array, accelerations: Array) -> Array:
        """Torques or forces of the drives (k, m), without friction."""
        robot: Any = self.robot
        inverse = robot.inverse if _is_robot(robot) else robot
        found = inverse(q, rates, accelerations)
        return shaped_array("torques of inverse_dynamics", found, accelerations.shape)

    def lost(self, q: Array, rates: Array) -> Array:
        """Torques or forces of the drives (k, m) that friction takes."""
        assert self.friction is not None
        found = self.friction(q, rates) if _is_robot(self.robot) else self.friction(rates)
        return shaped_array("torques of friction", found, rates.shape)


def require_callable(what: str, given: object) -> None:
    """Raise BadValueError where something is no function."""
    if not callable(given) or isinstance(given, type):
        raise BadValueError(what, given, "a function")


def _is_robot(given: object) -> bool:
    return hasattr(given, "drives_at") and not isinstance(given, type)
