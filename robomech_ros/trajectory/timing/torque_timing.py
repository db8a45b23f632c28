r"""Time-optimal motion along a path within the torques that drives can exert.

The dynamics come as callables, so that any model of them will do.  On the path q(s) a robot takes

.. math:: \tau = M q' \ddot s + (M q'' + C(q, q') q') \dot s^2 + g + f(q' \dot s)

whose first three terms are inverse dynamics at (q, 0, q'), (q, q', q'') and (q, 0, 0).  Friction f
is no function of the square of the speed; it is replaced by its tangent at the speeds of the motion
before, and the motion found anew until it takes no more than the torques there are.

If drives move other joints of a robot, q' and q'' are those of the drives, and inverse
dynamics gives their torques at the postures of all joints along the path.

References
----------
J. E. Bobrow, S. Dubowsky and J. S. Gibson, "Time-optimal control of robotic manipulators along
specified paths", International Journal of Robotics Research 4(3), 1985.
J. Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 7.4 and 7.8.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, MissingLimitsError, WrongSizeError
from robomech_ros.spatial.arrays import of_shape, real_array
from robomech_ros.trajectory.curves.bounds import hull
from robomech_ros.trajectory.curves.compiled_sampling import divided
from robomech_ros.trajectory.curves.motion_to_rest import check_positions
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.trajectory.timing.driven_path import DrivenPath, DrivenRobot, Dynamics, Friction
from robomech_ros.trajectory.timing.path_limits import PathFunction, SpeedLimit, TorqueLimits
from robomech_ros.trajectory.timing.path_sections import checked_path
from robomech_ros.trajectory.timing.path_timing import time_optimal
from robomech_ros.trajectory.timing.speed_profile import TimeOptimal
from robomech_ros.trajectory.tolerances import PATH_STANDSTILL
from robomech_ros.typing import Array, ArrayLike

# The largest part of a torque limit that a sampled motion may take.
_ACCURACY = 1e-6
# The motion is found anew at most so often, and while that gains this part of its duration.
_ROUNDS, _WORTHWHILE = 16, 1e-5
# Once the duration changes by no more than this part, an excess over the limits that falls more
# slowly than by this factor is taken off them.
_SETTLED, _SLOW = 1e-3, 0.1
# Speeds of the first tangent to friction, in parts of those that the velocity limits allow.
_FIRST_SPEED = 0.1
# That much of a torque limit may friction rise by at these speeds, which are halved until then.
_FIRST_FRICTION, _HALVINGS = 0.02, 60
# Speeds in parts of others at which friction is that of a joint about to stop.
_SLOWEST = 1e-3
# The tangent's slope is that at this part of the highest speed, at least.
_LEAST_SPEED = 0.05
# Half the way, in parts of the speed, between the speeds whose friction gives the slope.
_DIFFERENCE = 1e-4
# Places in each piece of a motion where its torques are looked at; the ends from within.
_PLACES = np.array([1e-9, 0.25, 0.5, 0.75, 1.0 - 1e-9])


def torque_limited(
    path: PiecewisePolynomial,
    limits: JointLimits | Any,
    inverse_dynamics: Dynamics | DrivenRobot,
    *,
    effort: ArrayLike | None = None,
    friction: Friction | None = None,
    path_speed: tuple[float, float] = (0.0, 0.0),
    speed_limits: SpeedLimit | Sequence[SpeedLimit] = (),
) -> TimeOptimal:
    """Pass a path in the shortest time within limits of torques, velocities and accelerations.

    Parameters
    ----------
    path : PiecewisePolynomial
        n joints over the path coordinate s, as for :func:`time_optimal`.
    limits : JointLimits
        A chain model, `Limits`, or anything with the same attributes.  Velocity limits of every
        drive are needed; acceleration limits, and those of joints without a drive, count where
        there are any.
    inverse_dynamics : callable or DrivenRobot
        Of joint values, rates and accelerations, each of shape (m, n) (rad or m; per s, per s^2),
        the torques or forces, shape (m, n) (N m or N), quadratic in the rates: that of a rigid
        robot, such as ``functools.partial(robomech_ros.dynamics.inverse_dynamics, chain)``.
        Of a robot with fewer drives than joints the system itself, such as ``ParallelDynamics``:
        the path is that of all joints then, such as ``plan_platform(...).followed.joints.pieces``.
    effort : array_like, shape (n,), optional
        Largest magnitudes of the torques or forces (N m or N) of the drives, infinite or NaN for
        none; default the effort limits of `limits`.
    friction : callable, optional
        Of joint rates, shape (m, n), the torques besides that friction takes, such as
        ``functools.partial(robomech_ros.dynamics.friction_torque, chain)``.  With a system a
        function of joint values and the rates of the drives, such as its ``friction``.
    path_speed, speed_limits
        As for :func:`time_optimal`.

    Returns
    -------
    TimeOptimal
        Of the drives.  Its samples take at most 1 + 1e-6 of the efforts.

    Raises
    ------
    MissingLimitsError
        No drive has an effort limit, or a drive, or a joint with acceleration limits, lacks a
        velocity limit.
    """
    curve = checked_path(path)
    known = Limits.of(limits)
    driven = DrivenPath(curve, inverse_dynamics, friction)
    if curve.joints != len(known.joint_names):
        raise WrongSizeError("joints of the path", curve.joints, len(known.joint_names))
    # The drives, and other joints whose rates have limits.
    limited = np.isfinite(known.velocity) | np.isfinite(known.acceleration)
    limited[driven.drives] = True
    timed = np.flatnonzero(limited).tolist()
    known.only(timed).require("velocity")
    efforts = _efforts(limits, known, driven.drives, effort)
    check_positions(curve, curve.coefficients[0, 0], known)
    if friction is not None:
        driven = replace(driven, path=_at_reversals(curve))
    model = _Model(driven, efforts, timed)
    squares = model.first_squares(known.velocity[driven.drives])
    known, allowed, excess = known.only(timed), 1.0, np.inf
    best: TimeOptimal | None = None
    lasted = np.inf
    for _ in range(_ROUNDS):
        found = time_optimal(
            model.timed,
            known,
            path_speed=path_speed,
            speed_limits=speed_limits,
            torque_limits=model.limits(squares, allowed),
        )
        before, excess = excess, model.largest_part(found) - 1.0
        settled = abs(lasted - found.duration) <= _SETTLED * found.duration
        if excess <= _ACCURACY:
            if best is not None and found.duration > best.duration * (1.0 - _WORTHWHILE):
                return model.of_drives(min(best, found, key=lambda motion: motion.duration))
            best = found
            if friction is None:
                return model.of_drives(found)
        elif friction is None or (settled and excess > _SLOW * before):
            allowed /= 1.0 + excess
        squares = PathFunction(np.maximum.accumulate(found.coordinates), found.speeds**2)
        lasted = found.duration
    if best is None:
        expected = f"torques that {_ROUNDS} rounds bring within their limits"
        raise BadValueError("largest torque in parts of its limit", 1.0 + excess, expected)
    return model.of_drives(best)


@dataclass(frozen=True, eq=False)
class _Model:
    """Effort limits of a robot on a path, for the joints that have one."""

    driven: DrivenPath
    effort: Array
    joints: list[int]

    @cached_property
    def timed(self) -> PiecewisePolynomial:
        """The path of the joints that are timed."""
        return self.driven.path.of_joints(self.joints)

    def of_drives(self, motion: TimeOptimal) -> TimeOptimal:
        """Leave out other joints that were timed, too."""
        kept = [self.joints.index(k) for k in self.driven.drives]
        return replace(motion, pieces=motion.pieces.of_joints(kept))

    def limits(self, squares: PathFunction, part: float) -> TorqueLimits:
        """Limits with friction's tangent at a speed, and the part of the efforts to use."""
        joints = np.isfinite(self.effort)

        def coefficients(s: Array) -> tuple[Array, Array, Array]:
            q, rates, rises = self.driven.on_path(s)
            rest = np.zeros_like(rates)
            c = self.driven.torques(q, rest, rest)
            a = self.driven.torques(q, rest, rates) - c
            b = self.driven.torques(q, rates, rises) - c
            if self.driven.friction is not None:
                value, slope = self.tangent(q, rates, s, squares)
                b, c = b + slope, c + value
            return a[:, joints], b[:, joints], c[:, joints]

        bound = part * self.effort[joints]
        return TorqueLimits(coefficients, -bound, bound)

    def first_squares(self, velocity: Array) -> PathFunction:
        """Return so small a part of the speed limits that only dry friction counts.

        A tangent at too high a speed would ask for torques that no slow motion takes.
        """
        drives = self.driven.path.of_joints(self.driven.drives)
        rates = np.abs(hull(drives, 1)).max(axis=0)
        slowest = (rates / velocity).max(axis=1)
        slowest = np.maximum(slowest, _SLOWEST * slowest.max()) if slowest.any() else slowest + 1.0
        middles = 0.5 * (self.timed.breaks[1:] + self.timed.breaks[:-1])
        speed = _FIRST_SPEED / slowest
        if self.driven.friction is None:
            return PathFunction(middles, speed**2)
        q = self.driven.on_path(middles)[0]
        for _ in range(_HALVINGS):
            moving = rates * speed[:, None]
            fast, slow = (self.driven.lost(q, part * moving) for part in (1.0, _SLOWEST))
            wet = np.abs(fast) - np.abs(slow)
            if (wet <= _FIRST_FRICTION * self.effort).all():
                break
            speed *= 0.5
        return PathFunction(middles, speed**2)

    def tangent(self, q: Array, rates: Array, s: Array, squares: PathFunction) -> tuple[Array, ...]:
        """Friction as ``value + slope square`` of the square of the speed along the path."""
        now = np.maximum(np.sqrt(squares(s)), PATH_STANDSTILL)[:, None]
        least = np.maximum(now, _LEAST_SPEED * np.sqrt(squares.values.max()))
        more, less = (
            self.driven.lost(q, rates * (least * (1.0 + d))) for d in (_DIFFERENCE, -_DIFFERENCE)
        )
        slope = (more - less) / (4.0 * _DIFFERENCE * least**2)
        # A tangent to friction that falls with the speed would call for a motion that runs away.
        slope = np.where(slope * rates > 0.0, slope, 0.0)
        return self.driven.lost(q, rates * now) - slope * now**2, slope

    def largest_part(self, motion: TimeOptimal) -> float:
        """Find the largest torque of a motion, in parts of its limit."""
        breaks = motion.pieces.breaks
        at = self.of_drives(motion).sample(
            (breaks[:-1, None] + np.diff(breaks)[:, None] * _PLACES).ravel()
        )
        q = self.driven.posture(_coordinates(motion).ravel(), at.position)
        taken = self.driven.torques(q, at.velocity, at.acceleration)
        if self.driven.friction is not None:
            taken = taken + self.driven.lost(q, at.velocity)
        return float((np.abs(taken) / self.effort).max())


def _coordinates(motion: TimeOptimal) -> Array:
    """Path coordinates at the places in each piece of a motion, shape (p, places)."""
    begin, end = motion.speeds[:-1, None], motion.speeds[1:, None]
    gone = begin * _PLACES + 0.5 * (end - begin) * _PLACES**2
    places: Array = motion.coordinates[:-1, None] + np.diff(motion.pieces.breaks)[:, None] * gone
    return np.clip(places, motion.coordinates[0], motion.coordinates[-1])


def _at_reversals(curve: PiecewisePolynomial) -> PiecewisePolynomial:
    """Divide a path where a joint turns back, which is where its dry friction steps."""
    ends = hull(curve, 1)
    turning = (ends.min(axis=0) < 0.0) & (ends.max(axis=0) > 0.0)
    rates = curve.derivative(1)
    found = []
    for k, joint in np.argwhere(turning).tolist():
        roots = np.roots(rates[::-1, k, joint])
        real = roots.real[np.abs(roots.imag) <= 1e-9 * np.abs(roots)]
        found.append(curve.breaks[k] + real[(real > 0.0) & (real < curve.spans[k])])
    if not found:
        return curve
    nodes = np.unique(np.concatenate([curve.breaks, *found]))
    # Two reversals this near to each other are one: no cell of the grid could be shorter.
    apart = np.diff(nodes) > 1e-7 * (nodes[-1] - nodes[0])
    kept = np.append(nodes[:-1][apart], nodes[-1])
    kept[0] = nodes[0]
    return divided(curve, kept)


def _efforts(limits: object, known: Limits, drives: list[int], effort: ArrayLike | None) -> Array:
    """Return the effort limits of the drives, infinite for none, shape (m,)."""
    names, given = [known.joint_names[k] for k in drives], effort
    if effort is None and (own := getattr(limits, "effort", None)) is not None:
        given = _sized(own, len(known.joint_names))[drives]
    array = np.full(len(names), np.inf) if given is None else _sized(given, len(names))
    values: Array = np.where(np.isnan(array), np.inf, array)
    for name, value in zip(names, values.tolist(), strict=True):
        if not value > 0.0:
            raise BadValueError(f"effort of joint '{name}'", value, "a positive number")
    if not np.isfinite(values).any():
        raise MissingLimitsError("effort", names)
    return values


def _sized(effort: ArrayLike, count: int) -> Array:
    return of_shape("effort", real_array("effort", effort), (count,))
