"""Grasp results as responses of the node."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from geometry_msgs.msg import Twist, Vector3, WrenchStamped
from std_msgs.msg import Header
from trajectory_msgs.msg import JointTrajectoryPoint

from robomech_ros.hands import (
    Contact,
    ContactForces,
    ForceStatus,
    GraspMobility,
    GraspQuality,
    Hand,
    finger_torques,
    grasp_mobility,
    grasp_quality,
    hand_jacobian,
    internal_forces,
    is_force_closed,
    is_form_closed,
)
from robomech_ros.kinematics import InverseKinematicsResult
from robomech_ros.nodes.common.messages.error_codes import answer
from robomech_ros.nodes.common.messages.message_fields import floats
from robomech_ros.nodes.common.messages.pose_messages import linear_rows_first, stamped_twist
from robomech_ros.nodes.grasping.requests import HandPosture, in_space
from robomech_ros.outcomes import Code
from robomech_ros.typing import Array


@dataclass(frozen=True, eq=False)
class GraspAnalysis:
    """Analysis of contacts, and of the hand that makes them if its state is specified."""

    force_closed: bool
    form_closed: bool
    quality: GraspQuality
    grasp_matrix: Array
    internal_forces: Array
    #: The hand, its Jacobian, and the mobility of the grasp.
    of_hand: tuple[Hand, Array, GraspMobility] | None = None

    def fill(self, frame: str, response: Any) -> Any:
        """Write all of it to an AnalyzeGrasp response, in a frame."""
        quality, G, inner = self.quality, self.grasp_matrix, self.internal_forces
        response.force_closed, response.form_closed = self.force_closed, self.form_closed
        response.quality_lower, response.quality_upper = quality.lower, quality.upper
        response.certified, response.length = quality.certified, quality.length
        weakest = in_space(quality.weakest)
        response.weakest = _wrench(np.r_[weakest[:3] * quality.length, weakest[3:]], frame)
        response.grasp_matrix = floats(linear_rows_first(G))
        response.force_components = G.shape[1]
        response.rank = G.shape[1] - inner.shape[1]
        response.internal_forces = floats(np.ascontiguousarray(inner))
        response.internal_count = inner.shape[1]
        if self.of_hand is not None:
            hand, jacobian, found = self.of_hand
            response.joint_names = list(hand.joint_names)
            response.hand_jacobian = floats(np.ascontiguousarray(jacobian))
            response.mobility = found.mobility
            response.object_twists = _twists(found.object_twists)
            response.loose_twists = _twists(found.loose_twists)
        response.summary = self.summary()
        return answer(response)

    def summary(self) -> str:
        """Say it in words."""
        quality = self.quality
        if self.force_closed:
            kind = "force and form closed" if self.form_closed else "force closed"
            bounds = "" if quality.certified else ", bounds not as close as asked for"
            lines = [
                f"{kind}: every load is held; quality {quality.lower:.6g} to {quality.upper:.6g} N "
                f"of 1 N of normal forces, moments over {quality.length:.4g} m{bounds}"
            ]
        else:
            lines = ["not closed: some loads are not held"]
        if self.of_hand is not None:
            found = self.of_hand[2]
            loose = found.loose_twists.shape[1]
            lines.append(
                f"mobility {found.mobility}: the object moves in {found.object_twists.shape[1]} "
                f"directions with its fingers, and in {loose} with all joints locked"
            )
        return "\n".join(lines)


def analysed(
    contacts: Sequence[Contact], matrix: Array, made_by: HandPosture | None, **options: Any
) -> GraspAnalysis:
    """Analyse contacts.

    - ``matrix``: grasp matrix of the contacts about the origin, shape (6, m), or (3, m) in the
      plane.
    - ``made_by``: posture of the hand that makes the contacts; None if it is not given.
    - ``**options``: options of :func:`grasp_quality`.

    Raises RobomechError: the hand cannot make the contacts, or a tolerance or length is invalid.
    """
    quality = grasp_quality(contacts, **options)
    closed = is_force_closed(contacts), is_form_closed(contacts)
    found = *closed, quality, matrix, internal_forces(contacts)
    if made_by is None:
        return GraspAnalysis(*found)
    hand, q, fingers = made_by
    J = hand_jacobian(hand, q, contacts, fingers=fingers)
    mobility = grasp_mobility(hand, q, contacts, fingers=fingers)
    return GraspAnalysis(*found, (hand, J, mobility))


def fill_forces(found: ContactForces, load: Array, frame: str, response: Any) -> Any:
    """Write contact forces, or the wrench that separates, to a ContactForces response."""
    if found.status is ForceStatus.NOT_CONVERGED:
        text = "the conic solver found neither forces nor a proof that there are none"
        return answer(response, Code.NOT_CONVERGED, text)
    if found.separating_wrench is not None:
        s = in_space(found.separating_wrench)
        response.separating_wrench = _wrench(s, frame)
        text = (
            "no forces inside the friction cones hold this load: the contacts exert nothing along "
            f"the wrench of force {_listed(s[3:])} and torque {_listed(s[:3])}, and the load "
            f"needs {-float(s @ in_space(load)):.4g}"
        )
        return answer(response, Code.LOAD_NOT_HELD, text)
    response.forces = [
        Vector3(**dict(zip("xyz", one, strict=False))) for one in found.forces.tolist()
    ]
    response.torsions = floats(found.torsions)
    response.largest, response.total = found.largest, found.total
    return answer(response)


def fill_efforts(
    made_by: HandPosture, contacts: Sequence[Contact], components: Array, response: Any
) -> None:
    """Write the efforts that exert contact forces to a ContactForces response."""
    hand, q, fingers = made_by
    efforts = finger_torques(hand, q, contacts, components, fingers=fingers)
    limits = np.concatenate([one.effort for one in hand.fingers])
    names = hand.joint_names
    response.joint_names = list(names)
    response.efforts = floats(efforts)
    response.overloaded_joints = [names[k] for k in np.flatnonzero(np.abs(efforts) > limits)]


def fill_postures(
    hand: Hand,
    found: Sequence[InverseKinematicsResult],
    owners: Sequence[int],
    whole: tuple[Array, Array],
    response: Any,
) -> Any:
    """Write postures of fingers and of the whole hand to a SolveGrasp response."""
    q, distance = whole
    response.joint_names = list(hand.joint_names)
    response.solutions = [JointTrajectoryPoint(positions=floats(row)) for row in q]
    response.seed_distances = floats(distance)
    response.counts = [len(one.q) for one in found]
    response.finger_postures = [
        JointTrajectoryPoint(positions=floats(row)) for one in found for row in one.q
    ]
    response.complete = all(one.complete for one in found)
    response.codes = [int(one.status) for one in found]
    failed = [k for k, one in enumerate(found) if not len(one.q)]
    reasons = [f"{hand.finger_names[owners[k]]}: {found[k].reason}" for k in failed]
    code = response.codes[failed[0]] if failed else Code.NONE
    return answer(response, code, "; ".join(reasons))


def _wrench(wrench: Array, frame: str) -> WrenchStamped:
    """Convert a wrench (6,), moment first, to a message in a frame; the stamp stays 0."""
    message = WrenchStamped(header=Header(frame_id=frame))
    torque, force = message.wrench.torque, message.wrench.force
    torque.x, torque.y, torque.z, force.x, force.y, force.z = wrench.tolist()
    return message


def _twists(columns: Array) -> list[Twist]:
    return [stamped_twist(column, "").twist for column in columns.T]


def _listed(vector: Array) -> str:
    return " ".join(f"{x:.4g}" for x in vector + 0.0)
