"""Requests, goals and messages that are meant: what clients of the suite send all day."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.message_fields import duration_from_seconds
from robomech_ros.nodes.common.messages.pose_messages import pose_from_matrix, stamped_pose
from robomech_ros.robots import SerialChain
from robomech_ros.spatial import inverse_pose, pose_exponential
from robomech_ros.typing import Array

__all__ = ["ValidMaker"]


# How far from home postures are, rad or m, and how far a moving tip goes, m.
_NEAR, _STEP = 0.3, 0.02
_PROFILES = 6
# Samples of one request to calibrate a camera in the hand, and where that and its target are, m.
_SAMPLES = 2
_CAMERA, _TARGET = pose_exponential(
    [[0.1, 0.2, 0.3, 0.0, 0.1, 0.2], [0.0, 2.0, 0.5, 0.8, 0.0, 0.1]]
)
# Times of a motion that stays at home and of one that leaves it, s.
_SHORT, _LONG = 0.05, 0.5


class ValidMaker:
    """Makes requests that a robot near its home posture can answer.

    Parameters
    ----------
    chain : SerialChain
        The robot.
    rng : numpy.random.Generator
    """

    def __init__(self, chain: SerialChain, rng: np.random.Generator) -> None:
        self._chain, self._rng, self._made = chain, rng, 0
        self._fill: dict[str, Callable[[Any], None]] = {
            "SolveFK_Request": self._states,
            "SolveIK_Request": self._target,
            "SolveIKBatch_Request": self._poses_in_rows,
            "GetJacobian_Request": self._state,
            "AnalyzeSingularity_Request": self._state,
            "QueryWorkspace_Request": self._poses,
            "InverseDynamics_Request": self._points,
            "ForwardDynamics_Request": self._state,
            "MassMatrix_Request": self._state,
            "SetPayload_Request": self._payload,
            "SummarizeTorques_Request": self._motion,
            "PlanJoint_Request": self._plan,
            "PlanCartesian_Request": self._path,
            "GetCartesianPath_Request": self._moveit_path,
            "GetPositionIK_Request": self._moveit_pose,
            "GetPositionFK_Request": self._moveit_links,
            "Execute_Request": self._rest,
            "SetSpeed_Request": self._full_speed,
            "AddSamples_Request": self._samples,
            "ExecuteTrajectory_Goal": self._motion,
            "FollowJointTrajectory_Goal": self._motion,
        }

    def make(self, kind: type) -> Any:
        """Make a request or a goal; of a type that is not known here, with all defaults."""
        self._made += 1
        message = kind()
        fill = self._fill.get(kind.__name__)
        if fill is not None:
            fill(message)
        return message

    def posture(self) -> Array:
        """Return positions near home, shape (n,) (rad or m)."""
        chain = self._chain
        away = self._rng.uniform(-_NEAR, _NEAR, chain.n)
        return np.clip(chain.home() + away, chain.lower, chain.upper)

    def _joints(self) -> JointState:
        return joint_state(self._chain.joint_names, self.posture())

    def _pose(self) -> PoseStamped:
        return stamped_pose(forward_kinematics(self._chain, self.posture()), "")

    def _trajectory(self, seconds: float, end: Array) -> JointTrajectory:
        """Return a motion from home, at rest at both of its ends."""
        rest = [0.0] * self._chain.n
        rows = ((0.0, self._chain.home()), (seconds, end))
        points = [
            JointTrajectoryPoint(
                positions=q.tolist(),
                velocities=rest,
                accelerations=rest,
                time_from_start=duration_from_seconds(time),
            )
            for time, q in rows
        ]
        return JointTrajectory(joint_names=list(self._chain.joint_names), points=points)

    def _states(self, request: Any) -> None:
        request.states = [self._joints()]

    def _state(self, request: Any) -> None:
        request.state = self._joints()

    def _target(self, request: Any) -> None:
        request.target = self._pose()

    def _poses(self, request: Any) -> None:
        request.poses = [self._pose()]

    def _poses_in_rows(self, request: Any) -> None:
        pose = self._pose().pose
        place, turn = pose.position, pose.orientation
        request.poses = [place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w]

    def _points(self, request: Any) -> None:
        request.points = [JointTrajectoryPoint(positions=self.posture().tolist())]

    def _payload(self, request: Any) -> None:
        request.payload.inertia.m = 0.1

    def _plan(self, request: Any) -> None:
        request.start = joint_state(self._chain.joint_names, self._chain.home())
        request.goal = self._joints()
        request.profile = self._made % _PROFILES

    def _end_of_path(self) -> PoseStamped:
        T = forward_kinematics(self._chain, self._chain.home()).copy()
        T[:3, 3] += self._rng.uniform(-_STEP, _STEP, 3)
        return stamped_pose(T, "")

    def _path(self, request: Any) -> None:
        request.start = joint_state(self._chain.joint_names, self._chain.home())
        request.waypoints = [self._end_of_path()]
        request.profile = self._made % _PROFILES

    def _moveit_path(self, request: Any) -> None:
        home = joint_state(self._chain.joint_names, self._chain.home())
        request.start_state.joint_state = home
        request.waypoints = [self._end_of_path().pose]
        request.max_step = 0.01

    def _moveit_pose(self, request: Any) -> None:
        request.ik_request.robot_state.joint_state = self._joints()
        request.ik_request.pose_stamped = self._pose()

    def _moveit_links(self, request: Any) -> None:
        request.robot_state.joint_state = self._joints()
        request.fk_link_names = [self._chain.tip]

    def _rest(self, request: Any) -> None:
        request.trajectory = self._trajectory(_SHORT, self._chain.home())

    def _full_speed(self, request: Any) -> None:
        request.speed = 1.0

    def _samples(self, request: Any) -> None:
        """Give where the hand is, and a target before the base as a camera on the hand sees it."""
        T = np.array([forward_kinematics(self._chain, self.posture()) for _ in range(_SAMPLES)])
        seen = inverse_pose(T @ _CAMERA) @ _TARGET
        request.robot.poses = [pose_from_matrix(one) for one in T]
        request.tracking.poses = [pose_from_matrix(one) for one in seen]

    def _motion(self, message: Any) -> None:
        away = self._chain.home() + self._rng.uniform(-_STEP, _STEP, self._chain.n)
        message.trajectory = self._trajectory(_LONG, away)
