"""Arms for path tracking: required interface, arms from three functions, and joined arms."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import as_finite, held_rows, shaped_array
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.typing import Array, ArrayLike, IntArray

_METHODS = ("forward", "inverse", "jacobian", "jacobian_rate")


class Arm(Protocol):
    """Arm of n joints, as path tracking needs it.

    All is in the base frame, twists are [omega; v] at the tool's origin, rad and m.
    """

    def forward(self, q: Array) -> ArrayLike:
        """Pose ``T_base_tool`` (4, 4) at joint values (n,)."""

    def inverse(self, T: Array, near: Array) -> ArrayLike | None:
        """Joint values (n,) for a pose, the nearest ones to `near`; None if there are none."""

    def jacobian(self, q: Array) -> ArrayLike:
        """Matrix (6, n) from joint rates to the twist."""

    def jacobian_rate(self, q: Array, qd: Array) -> ArrayLike:
        """Rate (6, n) of the Jacobian at joint rates qd."""


@dataclass(frozen=True, eq=False)
class SerialArm:
    """An `Arm` of n revolute and prismatic joints in series.

    The rate of its Jacobian follows from the Jacobian itself.

    Attributes
    ----------
    forward : callable
        Pose ``T_base_tool`` (4, 4) at joint values (n,).
    inverse : callable
        Joint values (n,) for a pose (4, 4), nearest to given ones (n,), the second argument; None
        if there are none.
    jacobian : callable
        Matrix (6, n) at joint values (n,): the columns [e; e x (p - o)] or [0; e], in the axes of
        the base, at the tool's origin p.
    task_mask : sequence of six bool, optional
        Which of x, y, z, rx, ry, rz a path holds, along and about the axes of its pose, as for
        `inverse_kinematics`; None and all False are the full pose.  What is free is chosen for the
        smallest motion of the joints.
    limits : JointLimits, optional
        With a mask: whose position limits joints keep away from, where others can move instead.
    """

    forward: Callable[[Array], ArrayLike]
    inverse: Callable[[Array, Array], ArrayLike | None]
    jacobian: Callable[[Array], ArrayLike]
    task_mask: Sequence[bool] | None = None
    limits: JointLimits | Any = None

    @property
    def held(self) -> IntArray | None:
        """Rows of twists, angular first, that a path holds; None for the full pose."""
        rows = None if self.task_mask is None else held_rows("task_mask", self.task_mask)
        return None if rows is None or len(rows) in (0, 6) else rows

    @property
    def bounds(self) -> Array | None:
        """Position limits (2, n), if joints keep away from any (rad or m)."""
        known = None if self.limits is None else Limits.of(self.limits)
        return None if known is None else np.stack([known.lower, known.upper])

    def __post_init__(self) -> None:
        _ = self.held, self.bounds
        for name in ("forward", "inverse", "jacobian"):
            if not callable(getattr(self, name)):
                raise BadValueError(name, getattr(self, name), "a callable")

    def jacobian_rate(self, q: ArrayLike, qd: ArrayLike) -> Array:
        """Rate of the Jacobian at joint rates qd.

        Column [e_i; v_i] changes by ``[omega_(i-1) x e_i; omega_i x v_i + e_i x u_i]``, with the
        angular velocity omega_i of link i and the velocity u_i that the joints after i give the
        tool's origin.

        Parameters
        ----------
        q, qd : array_like, shape (n,)
            Joint values (rad or m) and rates.

        Returns
        -------
        ndarray, shape (6, n)
        """
        values = as_finite("joint values", q, ())
        if values.ndim != 1:
            raise WrongSizeError("joint values", values.shape, "(n,)")
        rates = shaped_array("joint rates", qd, values.shape)[:, None]
        columns = shaped_array("jacobian", self.jacobian(values), (6, len(values))).T
        axes, arms = columns[:, :3], columns[:, 3:]
        after = np.cumsum(axes * rates, axis=0)
        moved = np.cumsum(arms * rates, axis=0)
        angular = np.cross(after - axes * rates, axes)
        linear = np.cross(after, arms) + np.cross(axes, moved[-1] - moved)
        return np.concatenate([angular, linear], axis=1).T


@dataclass(frozen=True, eq=False)
class JoinedArms:
    """Arms that hold one tool together, as the limbs of a parallel robot hold its platform.

    Their joint values (n,) are those of one arm after the other.

    Attributes
    ----------
    arms : tuple of Arm
        All give the pose of the same tool in the same base.
    joints : tuple of int
        How many joints each has.
    inverse : callable
        All joint values (n,) for a pose (4, 4), nearest to given ones (n,), the second argument;
        None if there are none.
    """

    arms: tuple[Arm, ...]
    joints: tuple[int, ...]
    inverse: Callable[[Array, Array], ArrayLike | None]

    def __post_init__(self) -> None:
        object.__setattr__(self, "arms", tuple(as_arm(arm) for arm in self.arms))
        if not self.arms:
            raise BadValueError("arms", (), "at least one arm")
        if len(self.joints) != len(self.arms):
            raise WrongSizeError("joints", len(self.joints), len(self.arms))

    def shares(self, q: Array) -> list[tuple[Arm, Array]]:
        """Return each arm with its own joint values of all (n,)."""
        ends = np.cumsum(self.joints)[:-1]
        return list(zip(self.arms, np.split(q, ends), strict=True))


Tracked = Arm | JoinedArms


def as_arm(value: object) -> Arm:
    """Check that a value has the methods of an arm, or raise BadValueError."""
    missing = [name for name in _METHODS if not callable(getattr(value, name, None))]
    if missing:
        raise BadValueError("arm", value, "an arm with " + ", ".join(_METHODS))
    return value  # type: ignore[return-value]


def as_tracked(value: object) -> Tracked:
    """Check that a value is an arm or joined arms, or raise BadValueError."""
    return value if isinstance(value, JoinedArms) else as_arm(value)


def as_near(arm: Tracked, value: ArrayLike) -> Array:
    """Check joint values (n,) of the arm."""
    q = as_finite("near", value, ())
    if q.ndim != 1 or not len(q):
        raise WrongSizeError("near", q.shape, "(n,) with at least one joint")
    if isinstance(arm, JoinedArms) and len(q) != sum(arm.joints):
        raise WrongSizeError("near", q.shape, (sum(arm.joints),))
    for one, own in arm.shares(q) if isinstance(arm, JoinedArms) else [(arm, q)]:
        shaped_array("jacobian", one.jacobian(own), (6, len(own)))
    return q.copy()
