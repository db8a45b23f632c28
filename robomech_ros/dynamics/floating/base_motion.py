"""The motion of a free base under joints whose motion is known, by conservation of momentum."""

from __future__ import annotations

import math

import numpy as np

from robomech_ros.dynamics.checked_states import as_vector
from robomech_ros.dynamics.floating.chain import FloatingChain
from robomech_ros.dynamics.floating.motion import Conserved, quaternion_rate, rotation
from robomech_ros.dynamics.payload import with_payload
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots.bodies import Body
from robomech_ros.spatial import as_pose, quaternion_from_matrix
from robomech_ros.spatial.arrays import as_single, check_kind
from robomech_ros.typing import Array, ArrayLike

# Step of the integration (s), and most steps of a move, such as that of a process that was paused.
_STEP, _MOST_STEPS = 0.05, 1000
# Longest move (s).
_LONGEST = 1e6


class FloatingBase:
    """A free base that reacts to joints whose motion is known.

    Parameters
    ----------
    robot : FloatingChain
        Chain of n joints.
    q : array_like, shape (n,)
        Joint values (rad or m) at the start, at rest.
    momentum : array_like, shape (6,), optional
        Angular momentum about the mass centre (kg m^2/s), then linear momentum (kg m/s), in the
        inertial axes.  Default zero.
    pose : array_like, shape (4, 4), optional
        Base in the inertial frame (m) at the start.  Default there.

    Attributes
    ----------
    robot : FloatingChain
        With the body that the tip has captured.
    pose : ndarray, shape (4, 4)
        Base in the inertial frame (m).
    rates : ndarray, shape (6 + n,)
        Twist of the base at its origin and in its axes, then joint rates.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.dynamics import FloatingBase, FloatingChain
    >>> from robomech_ros.robots import Body, load_robot
    >>> craft = Body(200.0, [0.0, 0.0, 0.0], 30.0 * np.eye(3))
    >>> base = FloatingBase(FloatingChain(load_robot("ur5e"), craft), np.zeros(6))
    >>> base.move(np.full(6, 0.1), np.zeros(6), 1.0)
    >>> bool(np.abs(base.momentum).max() < 1e-12), bool(np.abs(base.pose[:3, 3]).max() > 1e-3)
    (True, True)
    """

    def __init__(
        self,
        robot: FloatingChain,
        q: ArrayLike,
        momentum: ArrayLike | None = None,
        pose: ArrayLike | None = None,
    ) -> None:
        check_kind("robot", robot, FloatingChain, "a FloatingChain")
        self.robot = self._alone = robot
        self._q, self._qd = as_vector("q", q, robot.n).copy(), np.zeros(robot.n)
        self.pose = np.eye(4) if pose is None else as_pose(as_single("pose", pose, (4, 4)))
        about = np.zeros(6) if momentum is None else as_vector("momentum", momentum, 6)
        R = self.pose[:3, :3]
        inside = np.concatenate((R.T @ about[:3], R.T @ about[3:]))
        self._restart(robot.rates(self._q, self._qd, inside))

    @property
    def momentum(self) -> Array:
        """Momentum about the mass centre in the inertial axes, shape (6,)."""
        return self._conserved.momentum

    def move(self, q: ArrayLike, qd: ArrayLike, seconds: float) -> None:
        """Advance the joints to a state, along cubics from the state before.

        Parameters
        ----------
        q, qd : array_like, shape (n,)
            Joint values (rad or m) and rates at the end.
        seconds : float
            Duration (s); 0 sets the joints at once, without a turn of the base.
        """
        n = self.robot.n
        values, rates = as_vector("q", q, n), as_vector("qd", qd, n)
        span = float(as_single("seconds", seconds, ()))
        if not 0.0 <= span <= _LONGEST:
            raise BadValueError("seconds", span, f"a time from 0 to {_LONGEST:g} s")
        before, self._q, self._qd = (self._q, self._qd), values.copy(), rates.copy()
        if span > 0.0:
            steps = min(math.ceil(span / _STEP), _MOST_STEPS)
            for k in range(steps):
                self._step(before, span, k / steps, (k + 1) / steps)
        self._time += span
        R = rotation(self._Q)
        self.pose = self._conserved.pose(self._time, R, self._q)
        self.rates = self._conserved.rates(R, self._q, self._qd)

    def capture(self, body: Body | None, velocity: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """Fix a body to the tip, or release the one that is fixed to it.

        Joint rates stay the same.  The base takes up the momentum.

        Parameters
        ----------
        body : Body or None
            In the frame of the tip; None releases.
        velocity : array_like, shape (3,), optional
            Velocity of its mass centre before that (m/s), in the inertial axes; it does not turn.
        """
        v = as_vector("velocity", velocity, 3)
        if self.robot is not self._alone:
            self.robot = self._alone
            self._restart(self.rates)
        if body is None:
            return
        loaded = FloatingChain(with_payload(self.robot.chain, body), self.robot.base)
        tip = self.pose @ forward_kinematics(self.robot.chain, self._q)
        own = tip[:3, :3] @ body.com + tip[:3, 3]
        R = self.pose[:3, :3]
        centre = R @ loaded.center_of_mass(self._q) + self.pose[:3, 3]
        old = self._conserved.centre + self._time * self._conserved.drift
        angular, linear = self.momentum[:3], self.momentum[3:]
        whole = angular + np.cross(old - centre, linear) + np.cross(own - centre, body.mass * v)
        linear = linear + body.mass * v
        inside = np.concatenate((R.T @ whole, R.T @ linear))
        self.robot = loaded
        self._restart(loaded.rates(self._q, self._qd, inside))

    def _restart(self, rates: Array) -> None:
        """Take the momentum and the mass centre of the present state."""
        self._conserved = Conserved(self.robot, self.pose, self._q, rates)
        self._Q, self._time = quaternion_from_matrix(self.pose[:3, :3]), 0.0
        self.rates = rates

    def _step(self, before: tuple[Array, Array], span: float, first: float, last: float) -> None:
        """Integrate the orientation over a part of a time by the classical Runge-Kutta method."""
        h = (last - first) * span
        start, middle, end = (
            _between(before, (self._q, self._qd), span, part)
            for part in (first, 0.5 * (first + last), last)
        )

        def rate(Q: Array, joints: tuple[Array, Array]) -> Array:
            return quaternion_rate(Q, self._conserved.rates(rotation(Q), *joints)[:3])

        a = rate(self._Q, start)
        b = rate(self._Q + 0.5 * h * a, middle)
        c = rate(self._Q + 0.5 * h * b, middle)
        d = rate(self._Q + h * c, end)
        Q = self._Q + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
        self._Q = Q / np.linalg.norm(Q)


def _between(
    before: tuple[Array, Array], after: tuple[Array, Array], span: float, s: float
) -> tuple[Array, Array]:
    """Return joint values and rates on the cubic between two states, at a part of the time."""
    (q0, v0), (q1, v1) = before, after
    step = q1 - q0
    bend = span * (v0 + v1) - 2.0 * step
    curve = 3.0 * step - span * (2.0 * v0 + v1)
    values = q0 + s * (span * v0 + s * (curve + s * bend))
    return values, v0 + s * (2.0 * curve + 3.0 * s * bend) / span
