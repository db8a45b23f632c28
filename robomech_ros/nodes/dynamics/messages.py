"""Decoding of requests about dynamics, and encoding of torque summaries."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from geometry_msgs.msg import Inertia, Vector3, WrenchStamped
from sensor_msgs.msg import JointState

from robomech_ros.dynamics import DynamicSystem, TorqueSummary
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.execution.received_trajectory import joint_order
from robomech_ros.nodes.common.messages.joint_messages import positions_by_name
from robomech_ros.nodes.common.messages.message_fields import (
    duration_from_seconds,
    floats,
    not_negative,
)
from robomech_ros.nodes.common.messages.pose_messages import point_vector
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.dynamics.drives import Drives
from robomech_ros.nodes.frames.robot_frames import RobotFrames
from robomech_ros.robots import Body, SerialChain
from robomech_ros.spatial import inverse_pose
from robomech_ros.typing import Array

# Largest number in a vector, in SI units: products with masses stay far from overflow.
_LARGEST = 1e12
# At which a torque summary looks besides the points; each takes some 200 bytes for a joint.
_MOST_INSTANTS = 100_000
# Fields of a SummarizeTorques response with the names of those of the summary.
_SUMMARISED = (
    *("peak_effort", "rms_effort", "peak_power", "energy_out", "energy_back"),
    *("effort_limit", "saturation"),
)


@dataclass(frozen=True, eq=False)
class Motions:
    """States of a robot with n joints and m drives, which are all joints of a chain.

    - ``qd``, ``qdd``: rates and accelerations of the drives, per s and s^2, shape (k, m).
    """

    order: list[int]  #: Where each drive is among the names of the request.
    width: int  #: Number of names in the request.
    q: Array  #: Positions of all joints (rad or m), shape (k, n).
    qd: Array
    qdd: Array

    def in_request_order(self, rows: Array) -> Array:
        """Put columns of drives in the order of the request's names; joints without one get 0."""
        result = np.zeros((*rows.shape[:-1], self.width))
        result[..., self.order] = rows
        return result

    def torques(self, system: DynamicSystem, gravity: Array, wrench: Array) -> dict[str, Array]:
        """Compute the torques, and what of them gravity, rates and accelerations take.

        - ``system``: the robot with all that it carries.
        - ``gravity``: in the base (m/s^2), shape (3,).
        - ``wrench``: what the surroundings exert on the tip, moment first, in the base (N m and N),
          shape (k, 6).

        Returns arrays (k, m) by the name of the field of the response (N m or N).
        """
        q, qd, qdd = self.q, self.qd, self.qdd
        none, weightless = np.zeros_like(qd), np.zeros(3)
        still = system.without_momentum() if hasattr(system, "without_momentum") else system
        return {
            "effort": system.inverse(q, qd, qdd, gravity=gravity, tip_wrench=wrench),
            "gravity": still.inverse(q, none, none, gravity=gravity),
            "coriolis": system.inverse(q, qd, none, gravity=weightless),
            "inertial": still.inverse(q, none, qdd, gravity=weightless),
        }


def motions(points: Any, joint_names: Any, drives: Drives) -> Motions:
    """Read trajectory points as states.

    - ``points``: sequence of JointTrajectoryPoint; velocities and accelerations may be empty, which
      is 0.
    - ``joint_names``: sequence of str; the order of the numbers: drives or all joints; empty = the
      drives in their order.

    Raises UnknownJointError: with the point and the joint at fault. BadValueError, OutcomeError: as
    :meth:`Drives.postures`.
    """
    names = list(joint_names) or list(drives.names)
    wanted = drives.named(names)
    order = joint_order(names, wanted)
    q, qd, qdd = (
        _rows(points, field, names)[:, order]
        for field in ("positions", "velocities", "accelerations")
    )
    whole = len(wanted) == len(drives.joint_names)
    places = drives.places if whole else np.arange(len(drives.names))
    of_drives = [order[place] for place in places.tolist()]
    posture = drives.postures(q, "points")
    return Motions(of_drives, len(names), posture, qd[:, places], qdd[:, places])


def _rows(points: Any, field: str, names: list[str]) -> Array:
    rows = np.zeros((len(points), len(names)))
    for k, point in enumerate(points):
        values = getattr(point, field)
        if not len(values) and field != "positions":
            continue
        if len(values) != len(names):
            expected = f"{len(names)} for {', '.join(names)}"
            raise WrongSizeError(f"points[{k}].{field}", len(values), expected)
        rows[k] = values
        if not np.isfinite(rows[k]).all():
            worst = names[int(np.flatnonzero(~np.isfinite(rows[k]))[0])]
            raise NonFiniteError(f"points[{k}].{field} of joint '{worst}'", rows[k])
    return rows


def rates(state: JointState, field: str, drives: Drives, model: RobotModel) -> Array:
    """Read velocities or efforts of the drives, (m,), by name as positions are; empty = 0."""
    values = getattr(state, field)
    if not len(values):
        return np.zeros(len(drives.names))
    if not state.name and len(values) == len(drives.joint_names):
        return positions_by_name(state, drives.joint_names, "state", (), field)[drives.places]
    return positions_by_name(state, drives.names, "state", model.joint_names, field)


def without_rates(state: JointState) -> JointState:
    """Return the positions and names of a state without its rates."""
    numbers = len(state.velocity) + len(state.effort)
    return JointState() if numbers and not len(state.position) else state


def gravity_vector(given: Vector3, configured: Array) -> Array:
    """Read the acceleration of gravity (m/s^2), shape (3,); all zero = the configured one."""
    vector = _vector(given, "gravity")
    return vector if vector.any() else configured


async def tip_wrench(
    message: WrenchStamped,
    frames: RobotFrames,
    joint_names: Sequence[str],
    q: Array,
    patience: float,
) -> Array:
    """Read the wrench that the surroundings exert on the tip, moment first, in the base's axes.

    - ``message``: in the axes of any frame that the robot or tf knows.
    - ``joint_names``: the n joints.
    - ``q``: joint values (rad or m) of the states in which it acts, shape (m, n).
    - ``patience``: how long to wait for the frame (s).

    Returns an array (m, 6), N m and N, at the tip's origin.

    Raises FrameUnavailableError, NoStateError.
    """
    force = _vector(message.wrench.force, "tip_wrench.wrench.force")
    moment = _vector(message.wrench.torque, "tip_wrench.wrench.torque")
    at = dict(zip(joint_names, q.T, strict=True))
    pose = await frames.in_base(message.header.frame_id, patience, message.header.stamp, at)
    axes, wrench = pose[..., :3, :3], np.empty((len(q), 6))
    wrench[:, :3], wrench[:, 3:] = axes @ moment, axes @ force
    return wrench


def payload_body(inertia: Inertia, frame: str, chain: SerialChain) -> Body | None:
    """Read a load, in the frame of the tip; None = no load.

    Raises UnknownLinkError, BadValueError: the frame is not fixed to the tip, or no body has these
    numbers.
    """
    link = chain.link_frame(frame or chain.tip)
    if link.joints != chain.n:
        carrying = ", ".join(each.name for each in chain.frames if each.joints == chain.n)
        raise BadValueError("payload.header.frame_id", frame, f"one of {carrying}")
    if not_negative("payload.inertia.m", inertia.m, "a mass in kg, not negative") == 0.0:
        return None
    xx, xy, xz = inertia.ixx, inertia.ixy, inertia.ixz
    yy, yz, zz = inertia.iyy, inertia.iyz, inertia.izz
    moments = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if not np.isfinite(moments).all():
        raise NonFiniteError("payload.inertia moments", moments)
    body = Body(inertia.m, _vector(inertia.com, "payload.inertia.com"), moments)
    if fault := body.fault():
        raise BadValueError("payload.inertia", moments.tolist(), f"those of a body; {fault}")
    return body.expressed_in(inverse_pose(chain.link_frame(chain.tip).offset) @ link.offset)


def _vector(given: Vector3, what: str) -> Array:
    vector = point_vector(given, what)
    if np.abs(vector).max() > _LARGEST:
        raise BadValueError(what, vector.tolist(), f"magnitudes of at most {_LARGEST:g}")
    return vector


def instants(times: Array, period: float) -> Array:
    """Divide the spans between instants; none is above a period (s), but there are not too many."""
    period = max(period, float(times[-1] - times[0]) / _MOST_INSTANTS)
    parts = [
        np.linspace(begin, end, max(int(np.ceil((end - begin) / period)), 1), endpoint=False)
        for begin, end in pairwise(times)
    ]
    return np.concatenate([*parts, times[-1:]])


def encode_summary(summary: TorqueSummary, drives: Sequence[str], response: Any) -> Any:
    """Fill a SummarizeTorques response."""
    names = list(drives)
    response.joint_names = names
    for field in _SUMMARISED:
        setattr(response, field, floats(getattr(summary, field)))
    response.peak_effort_time = _durations(summary.peak_effort_time)
    over = np.flatnonzero(summary.saturation > 1.0)
    response.saturated_joints = [names[i] for i in over]
    response.saturation_time = _durations(summary.saturation_time[over])
    response.summary = summary.in_words(names)
    return response


def _durations(seconds: Array) -> list[Any]:
    return [duration_from_seconds(value) for value in seconds.tolist()]
