"""Pantograph legs: two slides drive the foot, forward and up, each by itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.parallel.mechanism.limb import Axis, chain_of_axes
from robomech_ros.robots import SerialChain
from robomech_ros.spatial.arrays import as_choice, as_single, real_number
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array, ArrayLike

_KNEES = {"forward": 1.0, "back": -1.0}
# Part of the length below which one is zero.
_ZERO = 1e-9


@dataclass(frozen=True, eq=False)
class PantographLeg:
    r"""A leg that turns about an axis along x of the trunk, with a pantograph in its plane.

    Its drives are the turn (rad), positive towards y, then two slides (m): h carries the lower
    pivot B along x, v carries the upper pivot A upwards.  A, B and the foot F are on one line:

    .. math::

       F = A + m (B - A) = (m h, \; -(m - 1) v)

    in the plane of the leg, so that each slide moves the foot in one direction, enlarged.  The
    thigh goes from A to the knee D, the shank from D to F; two short links close a parallelogram,
    E on the thigh, G on the shank.

    Parameters
    ----------
    thigh, shank : float
        Lengths of AD and DF (m).
    ratio : float
        m, above 1.
    hip : array_like, shape (3,), optional
        Where B is in the trunk when h is 0 (m), on the axis.  Default the origin.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.4; S. M. Song and
    K. J. Waldron, Machines That Walk (MIT Press, 1989), chapter 4.

    Examples
    --------
    >>> from robomech_ros.walking import PantographLeg
    >>> leg = PantographLeg(thigh=0.4, shank=0.4, ratio=5.0)
    >>> leg.foot([0.0, 0.02, 0.1]).round(6).tolist()
    [0.1, 0.0, -0.4]
    """

    thigh: float
    shank: float
    ratio: float
    hip: ArrayLike = (0.0, 0.0, 0.0)
    _hip: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        for name, least in (("thigh", 0.0), ("shank", 0.0), ("ratio", 1.0)):
            expected = f"a number above {least:g}"
            value = real_number(name, getattr(self, name), expected)
            if not least < value < np.inf:
                raise BadValueError(name, value, expected)
            object.__setattr__(self, name, float(value))
        object.__setattr__(self, "_hip", as_single("hip", self.hip, (3,)).copy())

    def foot(self, drives: ArrayLike) -> Array:
        """Compute where the foot is in the trunk (m), shape (3,).

        Parameters
        ----------
        drives : array_like, shape (3,)
            Turn (rad), h and v (m).

        Raises
        ------
        BadValueError
            Not such numbers, or slides so far apart that the links do not reach.
        """
        return self.points(drives)["F"]

    def points(self, drives: ArrayLike, knee: str = "forward") -> dict[str, Array]:
        """Compute where pivots A, B, D, E, G and the foot F are in the trunk (m).

        Parameters
        ----------
        drives : array_like, shape (3,)
            Turn (rad), h and v (m).
        knee : {"forward", "back"}, optional
            On which side of the line AF, seen with v above 0, the knee is.
        """
        turn, h, v = as_single("drives", drives, (3,)).tolist()
        side = _KNEES[as_choice("knee", knee, tuple(_KNEES))]
        A, B = np.array([0.0, v]), np.array([h, 0.0])
        F = A + self.ratio * (B - A)
        far = float(np.hypot(*(F - A)))
        least, most = abs(self.thigh - self.shank), self.thigh + self.shank
        if not max(least, _ZERO * most) <= far <= most:
            expected = f"slides that are {least / self.ratio:g} to {most / self.ratio:g} m apart"
            raise BadValueError("drives", [turn, h, v], expected)
        along = (F - A) / far
        # The cosine theorem gives the foot of the knee on AF.
        part = (far**2 + self.thigh**2 - self.shank**2) / (2.0 * far)
        away = side * np.sqrt(max(self.thigh**2 - part**2, 0.0))
        D = A + part * along + away * np.array([-along[1], along[0]])
        E = A + (D - A) / self.ratio
        plane = {"A": A, "B": B, "D": D, "E": E, "G": D + B - E, "F": F}
        x, up = self._axes(turn)
        return {name: self._hip + p[0] * x + p[1] * up for name, p in plane.items()}

    def jacobian(self, drives: ArrayLike) -> Array:
        """Compute what takes the rates of the drives to the velocity of the foot, (3, 3).

        Forces of the drives for a force at the foot are its transpose times that force.

        Parameters
        ----------
        drives : array_like, shape (3,)
            Turn (rad), h and v (m).
        """
        values = as_single("drives", drives, (3,))
        x, up = self._axes(values[0])
        away = self.foot(values) - self._hip
        columns = [np.cross(x, away), self.ratio * x, -(self.ratio - 1.0) * up]
        return np.column_stack(columns)

    def drives(self, foot: ArrayLike) -> Array:
        """Find the drives for a place of the foot, with A above B, shape (3,).

        Parameters
        ----------
        foot : array_like, shape (3,)
            In the trunk (m).

        Returns
        -------
        ndarray, shape (3,)
            Turn (rad), h and v (m).

        Raises
        ------
        BadValueError
            Not such numbers, a foot on the axis, whose turn is undetermined, or out of reach.
        """
        x, y, z = as_single("foot", foot, (3,)) - self._hip
        depth = float(np.hypot(y, z))
        if depth <= _ZERO * (self.thigh + self.shank):
            raise BadValueError("foot", foot, "a place that is not on the axis of the leg")
        found = np.array([np.arctan2(y, -z), x / self.ratio, depth / (self.ratio - 1.0)])
        self.foot(found)
        return found

    @property
    def gains(self) -> Array:
        """Ratios of the joint values of :meth:`chain` to the drives, shape (3,).

        The forces of the drives are those of the joints times the gains.
        """
        return np.array([1.0, self.ratio, self.ratio - 1.0])

    def chain(
        self,
        name: str,
        lower: ArrayLike,
        upper: ArrayLike,
        *,
        trunk: str = "base_link",
        velocity: ArrayLike | None = None,
        effort: ArrayLike | None = None,
    ) -> SerialChain:
        """Return the chain that moves the foot as the pantograph does, for a ``LeggedRobot``.

        Its joints turn the leg, slide the foot forward by m h, and slide it down by (m - 1) v.  The
        links have no bodies.

        Parameters
        ----------
        name : str
            Name of the leg; its joints are ``name_turn``, ``name_forward`` and ``name_down``.
        lower, upper : array_like, shape (3,)
            Limits of the drives: turn (rad), h and v (m).
        trunk : str, optional
            The link that carries the leg.
        velocity, effort : array_like, shape (3,), optional
            Limits of the drives (rad/s and m/s; N m and N).  Default none.

        Raises
        ------
        BadValueError, WrongSizeError
            A number is wrong, a lower limit is not below its upper one, or the links do not reach
            all positions of the slides.
        """
        bounds = np.array([as_single("lower", lower, (3,)), as_single("upper", upper, (3,))])
        if not (bounds[0] < bounds[1]).all():
            raise BadValueError("lower", bounds[0].tolist(), f"less than {bounds[1].tolist()}")
        nearest = np.clip(0.0, *bounds[:, 1:]).tolist()
        for h, v in (*product(*bounds[:, 1:].T.tolist()), nearest):
            self.foot([0.0, h, v])
        low, high = bounds * self.gains
        directions = ("turn", [1.0, 0.0, 0.0]), ("forward", [1.0, 0.0, 0.0]), ("down", [0, 0, -1.0])
        axes = [
            Axis(
                f"{name}_{what}",
                f"{name}_{what}_link",
                np.array(along),
                self._hip,
                slides=k > 0,
                limits=(float(low[k]), float(high[k])),
            )
            for k, (what, along) in enumerate(directions)
        ]
        bare = leg_of_axes(name, axes, self._hip, trunk)
        fast = bare.velocity if velocity is None else as_single("velocity", velocity, (3,))
        strong = bare.effort if effort is None else as_single("effort", effort, (3,))
        return replace(bare, velocity=fast * self.gains, effort=strong / self.gains)

    @staticmethod
    def _axes(turn: float) -> tuple[Array, Array]:
        """Return x and the way up in the plane of the leg, in the trunk."""
        return np.array([1.0, 0.0, 0.0]), np.array([0.0, -np.sin(turn), np.cos(turn)])


def leg_of_axes(name: str, axes: Sequence[Axis], foot: Array, trunk: str) -> SerialChain:
    """Make the chain of a leg from its axes and its foot in the trunk, all joints at zero."""
    chain = chain_of_axes(name, axes, assembled(np.eye(3), foot), f"{name}_foot")
    first, second, *others = chain.frames
    frames = (replace(first, name=trunk), replace(second, parent=trunk), *others)
    return replace(chain, base=trunk, frames=frames)
