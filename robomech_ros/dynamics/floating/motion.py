"""Motions of a chain on a free base at constant momentum, and their simulation.

The momentum determines the twist of the base for given joint values and rates.  The mass centre
moves uniformly and determines the position of the base.  Only the orientation and the joints are
integrated.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from robomech_ros.dynamics.checked_states import refuse_large
from robomech_ros.dynamics.floating.chain import FloatingChain
from robomech_ros.dynamics.friction import friction_model, friction_of_rates
from robomech_ros.dynamics.model import positive_number
from robomech_ros.dynamics.simulation.equations_of_motion import RunAwayError
from robomech_ros.dynamics.simulation.integration import FINISHED
from robomech_ros.dynamics.simulation.simulate import as_times
from robomech_ros.errors import BadValueError, NonFiniteError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.spatial import as_pose, matrix_from_quaternion, quaternion_from_matrix
from robomech_ros.spatial.arrays import as_finite, as_single, check_kind, of_shape, real_array
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array, ArrayLike

FloatingTorque = Callable[[float, Array, Array], ArrayLike]

_TOLERANCE = 1e-12
# A step takes about 2 ms.
_MOST_STEPS = 50_000
# Rate below which dry friction is smoothed (rad/s or m/s).
_REST_RATE = 1e-2


@dataclass(frozen=True, eq=False)
class FloatingMotion:
    """Motion of a chain of n joints on a free base.

    Attributes
    ----------
    t : ndarray, shape (m,)
        Times (s) before the motion ended; the start alone if it ended before all of them.
    poses, tips : ndarray, shape (m, 4, 4)
        Base and tip in the inertial frame (m).
    q : ndarray, shape (m, n)
        Joint values (rad or m).
    rates : ndarray, shape (m, 6 + n)
        Twist of the base at its origin and in its axes, then joint rates.
    momentum : ndarray, shape (m, 6)
        Angular momentum about the mass centre (kg m^2/s), then linear momentum (kg m/s), in the
        inertial axes.
    kinetic, work : ndarray, shape (m,)
        Kinetic energy, and work of the drives less friction (J).
    reason : str
        ``"finished"``, or why the motion ended early.
    """

    t: Array
    poses: Array
    tips: Array
    q: Array
    rates: Array
    momentum: Array
    kinetic: Array
    work: Array
    reason: str


class Conserved:
    """Momentum (6,) and uniform motion of the mass centre, from the state at the start."""

    def __init__(self, robot: FloatingChain, pose: Array, q: Array, rates: Array) -> None:
        self.robot, R = robot, pose[:3, :3]
        inside = robot.momentum(q, rates)
        self.momentum = np.concatenate((R @ inside[:3], R @ inside[3:]))
        self.centre = pose[:3, 3] + R @ robot.center_of_mass(q)
        self.drift = self.momentum[3:] / robot.mass

    def rates(self, R: Array, q: Array, qd: Array) -> Array:
        """Return twist of the base and joint rates, (6 + n,), at an orientation."""
        inside = np.concatenate((R.T @ self.momentum[:3], R.T @ self.momentum[3:]))
        return self.robot.rates(q, qd, inside)

    def pose(self, t: float, R: Array, q: Array) -> Array:
        """Return the pose of the base at a time (s)."""
        away = R @ self.robot.center_of_mass(q)
        return assembled(R, self.centre + t * self.drift - away)

    def motion(
        self, t: Array, Q: Array, q: Array, qd: Array, work: Array, why: str
    ) -> FloatingMotion:
        """Collect states at times (m,)."""
        robot, turns = self.robot, rotation(Q)
        rates = np.array([self.rates(*one) for one in zip(turns, q, qd, strict=True)])
        poses = np.array([self.pose(*one) for one in zip(t, turns, q, strict=True)])
        inside = np.array([robot.momentum(*one) for one in zip(q, rates, strict=True)])
        whole = np.einsum("mij,mkj->mki", turns, inside.reshape(-1, 2, 3)).reshape(-1, 6)
        kinetic = np.array([robot.kinetic_energy(*one) for one in zip(q, rates, strict=True)])
        tips = poses @ forward_kinematics(robot.chain, q)
        return FloatingMotion(t, poses, tips, q, rates, whole, kinetic, work, why)


def simulate_floating(
    robot: FloatingChain,
    pose: ArrayLike,
    q: ArrayLike,
    rates: ArrayLike,
    torque: ArrayLike | FloatingTorque | None,
    duration: float,
    *,
    times: ArrayLike | None = None,
) -> FloatingMotion:
    """Integrate the motion of a chain on a free base under the torques of its drives.

    Drive friction is included.  Gravity is not, because everything falls freely.

    Parameters
    ----------
    robot : FloatingChain
        Chain of n joints.
    pose : array_like, shape (4, 4)
        Base in the inertial frame (m) at the start.
    q : array_like, shape (n,)
        Joint values (rad or m) at the start.
    rates : array_like, shape (6 + n,)
        Twist of the base at its origin and in its axes (rad/s, m/s), then joint rates.
    torque : array_like of shape (n,), callable, or None
        Drive torques (N m or N): constant, ``torque(t, q, rates)``, or none.
    duration : float
        In s.
    times : array_like, shape (m,), optional
        Times of the recorded states (s), increasing, from 0 to the duration; default 101.

    Returns
    -------
    FloatingMotion
        The momentum is constant up to rounding; the relative tolerance of the integration is 1e-12.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 7.5.2 and 7.6.3.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.dynamics import FloatingChain, simulate_floating
    >>> from robomech_ros.robots import Body, load_robot
    >>> robot = FloatingChain(load_robot("ur5e"), Body(100.0, [0.0, 0.0, 0.0], 10.0 * np.eye(3)))
    >>> push = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
    >>> run = simulate_floating(robot, np.eye(4), np.zeros(6), np.zeros(12), push, 1.0)
    >>> bool(np.abs(run.momentum).max() < 1e-12), run.reason
    (True, 'finished')
    """
    kept, start, qd, grid = started(robot, pose, q, rates, duration, times)
    n, drives = robot.n, _as_torque(torque, robot.n)
    friction = friction_model(robot.chain)

    def change(t: float, state: Array) -> Array:
        joints, speeds = state[4 : 4 + n], state[4 + n : 4 + 2 * n]
        u = kept.rates(rotation(state[:4]), joints, speeds)
        tau = of_shape("torque", real_array("torque", drives(t, joints.copy(), u.copy())), (n,))
        tau = tau - friction_of_rates(friction, speeds, np.tanh(speeds / _REST_RATE))
        if not np.isfinite(tau).all():
            raise RunAwayError(f"the motion ran away: the torque at {t:.6g} s is not finite")
        found = robot.forward(joints, u, np.concatenate((np.zeros(6), tau)))
        return np.concatenate(
            (quaternion_rate(state[:4], u[:3]), speeds, found[6:], [tau @ speeds])
        )

    t, states, why = integrated(change, np.concatenate((start, qd, [0.0])), grid)
    return kept.motion(
        t, states[:, :4], states[:, 4 : 4 + n], states[:, 4 + n : -1], states[:, -1], why
    )


def started(
    robot: FloatingChain,
    pose: ArrayLike,
    q: ArrayLike,
    rates: ArrayLike | None,
    duration: float,
    times: ArrayLike | None,
) -> tuple[Conserved, Array, Array, Array]:
    """Check a start; return conserved momentum, quaternion and joints, joint rates, and times."""
    check_kind("robot", robot, FloatingChain, "a FloatingChain")
    T = as_pose(as_single("pose", pose, (4, 4)))
    joints, u = as_single("q", q, (robot.n,)), np.zeros(6 + robot.n)
    if rates is not None:
        u = as_single("rates", rates, (6 + robot.n,))
    end = positive_number("duration", duration)
    grid = as_times(times, end)
    if grid is None:
        grid = np.linspace(0.0, end, 101)
    if not len(grid):
        raise BadValueError("number of times", 0, "1 or more")
    kept = Conserved(robot, T, joints, u)
    return kept, np.concatenate((quaternion_from_matrix(T[:3, :3]), joints)), u[6:], grid


def integrated(
    change: Callable[[float, Array], Array],
    start: Array,
    grid: Array,
    check: Callable[[float, Array], None] = lambda t, state: None,
    tolerance: float = _TOLERANCE,
) -> tuple[Array, Array, str]:
    """Integrate from 0 s; return the reached times, the states there, and the reason for the end.

    A RunAwayError of the check or of the derivative ends the motion.  Other errors of the
    derivative at the start are raised.
    """
    from scipy.integrate import DOP853

    def refusing(t: float, state: Array) -> Array:
        try:
            found = as_finite("derivative", change(t, as_finite("state", state, ())), ())
            # The solver squares derivatives: larger ones would overflow.
            refuse_large("derivative", found)
            return found
        except (BadValueError, NonFiniteError) as error:
            raise RunAwayError(f"the motion ran away at {t:.6g} s: {error}") from None

    at_start = int(np.count_nonzero(grid == 0.0))
    times, states, why = [0.0] * max(at_start, 1), [start] * max(at_start, 1), FINISHED
    steps, inside = iter(range(_MOST_STEPS)), None
    try:
        # The checks of the states find overflows.
        with np.errstate(over="ignore", invalid="ignore"):
            check(0.0, start)
            change(0.0, start)
            solver = DOP853(refusing, 0.0, start, grid[-1], rtol=tolerance, atol=tolerance)
            for wanted in grid[grid > 0.0]:
                while solver.t < wanted:
                    if next(steps, None) is None:
                        raise RunAwayError(f"{_MOST_STEPS} steps did not reach the end")
                    if message := solver.step():
                        raise RunAwayError(f"the integration failed at {solver.t:.6g} s: {message}")
                    check(solver.t, solver.y)
                    inside = None
                inside = inside or solver.dense_output()
                times.append(float(wanted))
                states.append(inside(wanted))
    except RunAwayError as error:
        why = str(error)
    first = 0 if at_start or len(times) == 1 else 1
    return np.array(times[first:]), np.array(states[first:]), why


def _as_torque(torque: ArrayLike | FloatingTorque | None, n: int) -> FloatingTorque:
    if callable(torque):
        return torque
    constant = np.zeros(n) if torque is None else as_single("torque", torque, (n,))
    return lambda t, q, rates: constant


def rotation(Q: Array) -> Array:
    """Return rotation matrices of quaternions (..., 4) whose norms have drifted."""
    return matrix_from_quaternion(Q / np.linalg.norm(Q, axis=-1, keepdims=True))


def quaternion_rate(Q: Array, w: Array) -> Array:
    """Return the derivative of a quaternion (4,) for an angular velocity in its own axes."""
    x, y, z, s = (0.5 * Q).tolist()
    return np.array([[s, -z, y], [z, s, -x], [-y, x, s], [-x, -y, -z]]) @ w
