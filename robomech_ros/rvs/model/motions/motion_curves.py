"""The curves of a motion: positions, rates and torques over time, and their limits."""

from typing import NamedTuple

import numpy as np

from robomech_ros.dynamics import inverse_dynamics
from robomech_ros.errors import BadValueError, MissingInertiaError
from robomech_ros.parallel import Mechanism, ParallelDynamics
from robomech_ros.robots import SerialChain
from robomech_ros.rvs.motion import Motion
from robomech_ros.typing import Array

QUANTITIES = ("position", "velocity", "acceleration", "jerk", "torque")
# Suffixes of the unit of a position for its derivatives.
_PER = ("", "/s", "/s²", "/s³")


class Quantity(NamedTuple):
    """One quantity of the joints that have it in the same unit.

    - ``lower``, ``upper``: its limits, shape (k,); infinite where there is none.
    """

    name: str
    unit: str
    #: Numbers of the k joints.
    joints: tuple[int, ...]
    #: Values in the unit ``unit``, shape (m, k).
    values: Array
    lower: Array
    upper: Array


class MotionCurves(NamedTuple):
    """The curves of a motion."""

    #: Times, beginning at 0 (s), shape (m,).
    times: Array
    quantities: tuple[Quantity, ...]
    #: A sentence for each quantity that is not known.
    missing: tuple[str, ...]


def motion_curves(motion: Motion) -> MotionCurves:
    """Return the curves of a motion: of all joints of an arm, of the drives of a parallel robot.

    Rates missing from the motion are differences of its samples; torques are those of
    the rigid bodies, without friction.
    """
    robot, times = motion.chain, motion.times - motion.times[0]
    if not isinstance(robot, SerialChain | Mechanism):
        raise BadValueError("what moves", robot.name, "an arm or a parallel robot")
    qd = _rate(motion.q, times) if motion.qd is None else motion.qd
    qdd = _rate(qd, times) if motion.qdd is None else motion.qdd
    qddd = _rate(qdd, times) if motion.qddd is None else motion.qddd
    shown = driven_joints(robot)
    units = [robot.units[k] for k in shown]
    ends = robot.lower[shown], robot.upper[shown]
    quantities = _of_unit(units, "position", motion.q[:, shown], ends)
    for name, values in (("velocity", qd), ("acceleration", qdd), ("jerk", qddd)):
        quantities += _of_unit(units, name, values[:, shown], _bounds(robot, name, shown))
    missing: tuple[str, ...] = ()
    try:
        tau = _torques(robot, motion.q, qd, qdd) if motion.tau is None else motion.tau[:, shown]
        quantities += _of_unit(units, "torque", tau, _bounds(robot, "effort", shown))
    except MissingInertiaError:
        missing = ("No torques: the robot's description has no masses.",)
    return MotionCurves(times, tuple(quantities), missing)


def driven_joints(robot: SerialChain | Mechanism) -> list[int]:
    """Return the numbers of the joints whose curves are drawn."""
    if isinstance(robot, SerialChain):
        return list(range(robot.n))
    return [int(k) for k in robot.drive_index]


def _torques(robot: SerialChain | Mechanism, q: Array, qd: Array, qdd: Array) -> Array:
    if isinstance(robot, SerialChain):
        return inverse_dynamics(robot, q, qd, qdd)
    drives = robot.drive_index
    return ParallelDynamics(robot).inverse(q, qd[:, drives], qdd[:, drives])


def _bounds(robot: SerialChain | Mechanism, limit: str, shown: list[int]) -> tuple[Array, Array]:
    most = np.asarray(getattr(robot, limit), dtype=np.float64)[shown]
    most = np.where(np.isnan(most), np.inf, most)
    return -most, most


def _rate(values: Array, times: Array) -> Array:
    if len(times) < 2:
        return np.zeros_like(values)
    return np.gradient(values, times, axis=0)


def _of_unit(
    units: list[str], name: str, values: Array, limits: tuple[Array, Array]
) -> list[Quantity]:
    """Separate revolute from prismatic joints."""
    quantities = []
    for unit in dict.fromkeys(units):
        joints = tuple(k for k, other in enumerate(units) if other == unit)
        shown = ("N m" if unit == "rad" else "N") if name == "torque" else unit
        if name != "torque":
            shown += _PER[QUANTITIES.index(name)]
        low, high = (limit[list(joints)] for limit in limits)
        quantities.append(Quantity(name, shown, joints, values[:, list(joints)], low, high))
    return quantities
