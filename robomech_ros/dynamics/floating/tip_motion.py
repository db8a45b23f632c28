"""Motions of a chain on a free base that are prescribed for its tip in inertial space."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robomech_ros.dynamics.floating.chain import FloatingChain, least_rates
from robomech_ros.dynamics.floating.motion import (
    FloatingMotion,
    integrated,
    quaternion_rate,
    rotation,
    started,
)
from robomech_ros.dynamics.simulation.equations_of_motion import RunAwayError
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial import (
    as_pose,
    matrix_from_rotation_vector,
    pose_error,
    rotation_vector_from_matrix,
)
from robomech_ros.spatial.arrays import as_flag, as_single, check_kind
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array, ArrayLike

FloatingPath = Callable[[float], tuple[Array, Array]]
# Begins the reason of a motion that ends there.
SINGULAR = "the generalised Jacobian is singular"
# Tolerance of the integration; rounding of long paths is an order below.
_TOLERANCE = 1e-11
# Feedback gain for the tip's pose error, times the duration.
_RETURN = 2.0


def move_floating_tip(
    robot: FloatingChain,
    pose: ArrayLike,
    q: ArrayLike,
    goal: ArrayLike | None,
    duration: float,
    *,
    rates: ArrayLike | None = None,
    times: ArrayLike | None = None,
) -> FloatingMotion:
    """Move the tip straight to a pose in inertial space, or hold it, while the base reacts.

    The tip follows the 3-4-5 polynomial and turns about one axis.  Joint rates are the least-norm
    solution of the generalised Jacobian.

    Parameters
    ----------
    robot : FloatingChain
        Chain of six joints or more.
    pose : array_like, shape (4, 4)
        Base in the inertial frame (m) at the start.
    q : array_like, shape (n,)
        Joint values (rad or m) at the start.
    goal : array_like, shape (4, 4), or None
        Tip in the inertial frame (m) at the end; None holds it where it is.
    duration : float
        In s.
    rates : array_like, shape (6 + n,), optional
        Rates at the start, whose momentum is conserved.  Default at rest.
    times : array_like, shape (m,), optional
        As for :func:`simulate_floating`.

    Returns
    -------
    FloatingMotion
        ``work`` is the change of kinetic energy.  The motion ends early if a joint reaches a limit
        of position or velocity, or if the generalised Jacobian becomes singular.

    References
    ----------
    Umetani, Yoshida, Resolved motion rate control of space manipulators with generalized Jacobian
    matrix, IEEE Trans. Robotics and Automation 5, 1989.
    """
    first, last = _ends(robot, pose, q, goal)
    turn = rotation_vector_from_matrix(last[:3, :3] @ first[:3, :3].T)
    straight = np.concatenate((turn, last[:3, 3] - first[:3, 3]))

    def path(t: float) -> tuple[Array, Array]:
        part = min(max(t / duration, 0.0), 1.0)
        along = part**3 * (10.0 + part * (6.0 * part - 15.0))
        speed = 30.0 * (part * (1.0 - part)) ** 2 / duration
        wanted = assembled(
            matrix_from_rotation_vector(along * turn) @ first[:3, :3],
            first[:3, 3] + along * straight[3:],
        )
        return wanted, speed * straight

    return follow_floating_path(robot, pose, q, path, duration, rates=rates, times=times)


def follow_floating_path(
    robot: FloatingChain,
    pose: ArrayLike,
    q: ArrayLike,
    path: FloatingPath,
    duration: float,
    *,
    rates: ArrayLike | None = None,
    times: ArrayLike | None = None,
    velocity_limits: bool = True,
) -> FloatingMotion:
    """Follow a path of the tip in inertial space while the base reacts.

    Joint rates are the least-norm solution of the generalised Jacobian.

    Parameters
    ----------
    robot : FloatingChain
        Chain of six joints or more.
    pose : array_like, shape (4, 4)
        Base in the inertial frame (m) at the start.
    q : array_like, shape (n,)
        Joint values (rad or m) at the start.
    path : callable
        ``path(t)`` returns the pose of the tip, shape (4, 4) (m), and its twist [omega; v], shape
        (6,), at the tip and in the inertial axes (rad/s, m/s).
    duration : float
        In s.  At rest, t can be any path coordinate.
    rates, times
        As for :func:`move_floating_tip`.
    velocity_limits : bool, optional
        Whether the velocity limits of the joints end the motion.

    Returns
    -------
    FloatingMotion
        As from :func:`move_floating_tip`.
    """
    kept, start, _, grid = started(robot, pose, q, rates, duration, times)
    n, chain = robot.n, robot.chain
    _check_joints(robot)
    _check_path(path)
    limited = as_flag("velocity_limits", velocity_limits)

    def joint_rates(t: float, R: Array, joints: Array) -> tuple[Array, bool]:
        wanted, moving = path(t)
        tip = kept.pose(t, R, joints) @ forward_kinematics(chain, joints)
        twist = moving + _RETURN / duration * pose_error(wanted, tip)
        inside = np.concatenate((R.T @ twist[:3], R.T @ twist[3:]))
        adrift = kept.rates(R, joints, np.zeros(n))
        return least_rates(robot, joints, inside, adrift)

    def change(t: float, state: Array) -> Array:
        R, joints = rotation(state[:4]), state[4:]
        speeds, _ = joint_rates(t, R, joints)
        return np.concatenate(
            (quaternion_rate(state[:4], kept.rates(R, joints, speeds)[:3]), speeds)
        )

    def check(t: float, state: Array) -> None:
        joints = state[4:]
        speeds, regular = joint_rates(t, rotation(state[:4]), joints)
        if not regular:
            raise RunAwayError(f"{SINGULAR} at {t:.6g} s")
        outside = np.maximum(chain.lower - joints, joints - chain.upper)
        _stop_at_limit(chain, outside, f"its position limit at {t:.6g} s")
        if limited:
            beyond = np.abs(speeds) - chain.velocity
            _stop_at_limit(chain, beyond, f"its velocity limit at {t:.6g} s")

    t, states, why = integrated(change, start, grid, check, _TOLERANCE)
    joints = states[:, 4:]
    speeds = np.array(
        [joint_rates(*one)[0] for one in zip(t, rotation(states[:, :4]), joints, strict=True)]
    )
    found = kept.motion(t, states[:, :4], joints, speeds, np.zeros(len(t)), why)
    found.work[:] = found.kinetic - found.kinetic[0]
    return found


def _ends(
    robot: FloatingChain, pose: ArrayLike, q: ArrayLike, goal: ArrayLike | None
) -> tuple[Array, Array]:
    """Return the poses of the tip at the start and the end of a motion."""
    check_kind("robot", robot, FloatingChain, "a FloatingChain")
    _check_joints(robot)
    base, joints = as_pose(as_single("pose", pose, (4, 4))), as_single("q", q, (robot.n,))
    first = base @ forward_kinematics(robot.chain, joints)
    return first, first if goal is None else as_pose(as_single("goal", goal, (4, 4)), what="goal")


def _check_path(path: FloatingPath) -> None:
    """Refuse what does not return a pose and a twist."""
    expected = "a function of the time that returns a pose (4, 4) and a twist (6,)"
    if not callable(path):
        raise BadValueError("path", path, expected)
    try:
        pose, twist = path(0.0)
    except (TypeError, ValueError) as error:
        raise BadValueError("path", str(error), expected) from None
    as_pose(as_single("pose of the path", pose, (4, 4)))
    as_single("twist of the path", twist, (6,))


def _check_joints(robot: FloatingChain) -> None:
    if robot.n < 6:
        raise BadValueError("number of joints", robot.n, "6 or more, to move the tip along a line")


def _stop_at_limit(chain: SerialChain, beyond: Array, limit: str) -> None:
    """End the motion where a joint is beyond a limit; NaN stands for no limit."""
    for joint, excess in zip(chain.joint_names, beyond.tolist(), strict=True):
        if excess > 0.0:
            raise RunAwayError(f"joint '{joint}' came to {limit}")
