"""Everybody who works with one robot: what they ask for, and how to see that it is on the way."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from callers import ByAction, ByExecute, ByRequests, ByServo, ByTopic
from control_msgs.action import FollowJointTrajectory, GripperCommand
from control_msgs.msg import GripperCommand as GripperCommandMessage
from sensor_msgs.msg import JointState
from session import Session, Work
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.action import ExecuteTrajectory
from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import (
    Execute,
    PlanCartesian,
    PlanJoint,
    SolveIKBatch,
    SummarizeTorques,
)
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.messages.pose_messages import stamped_pose
from robomech_ros.outcomes import name_of
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array

__all__ = ["Arm"]


_CONTROLLER = "joint_trajectory_controller"
_GRIPPER = "gripper_controller/gripper_cmd"
# Where a finger is that has opened, m.
_OPEN = 0.04
# The first joint goes from here to there and back, rad from home, and the others a little.
_FAR, _LITTLE = 2.0, 0.3
# On the way a joint is faster than these parts of its limit; by the servo it goes as fast as that.
_FAST, _DRIVEN, _COMMANDED = 0.3, 0.3, 0.4
# Part of the velocity limits at which motions are planned: on a busy machine, too, a fault comes on
# their way.
_SLOW = 0.5
# States are news for so long, s.
_FRESH = 0.5
# How many poses, waypoints and repetitions make a request one that takes its time.
_POSES, _WAYPOINTS = 10_000, 40
# Positions that differ by less are the same, rad or m.
_SAME = 1e-6
_NO_ANSWER, _ARRIVED = "no answer", "arrived"
# On a busy machine the motion after a fault may be one that is lost by itself.
_TRIES = 3


class Arm:
    """Somebody with a robot that goes to and fro between two postures.

    Parameters
    ----------
    session : Session
        The suite.
    chain : SerialChain
        The robot.
    """

    def __init__(self, session: Session, chain: SerialChain) -> None:
        self._session, self._chain = session, chain
        turn = np.full(chain.n, _LITTLE)
        turn[0] = _FAR
        self._ends = chain.home() - turn, chain.home() + turn

    def works(self) -> dict[str, Work]:
        """Return what can be under way, by the name of who asks for it."""
        node = self._session.node
        motions = [ByExecute(node), ByTopic(node), *self._actions()]
        works = [Work(each, self._plan, self._moves(_FAST), self.next) for each in motions]
        hand = self._hand()
        works.append(Work(hand, self._grip, self._fingers_move, lambda: self._next_grip(hand)))
        servo = ByServo(node, self._moves(_DRIVEN))
        works.append(Work(servo, self._command, self._moves(_DRIVEN), self.next))
        for kind, service, make in (
            (SolveIKBatch, "kinematics/solve_ik_batch", self._poses),
            (SummarizeTorques, "dynamics/summarize_torques", self._torques),
            (PlanCartesian, "trajectory_planner/plan_cartesian", self._waypoints),
        ):
            asks = ByRequests(node, kind, service)
            works.append(Work(asks, make, asks.on_the_way, self.next))
        return {work.caller.name: work for work in works}

    def _actions(self) -> list[ByAction]:
        return [
            ByAction(
                self._session.node,
                ExecuteTrajectory,
                f"{_CONTROLLER}/execute_trajectory",
                lambda plan: ExecuteTrajectory.Goal(trajectory=plan),
                lambda result: result.error_msg,
            ),
            ByAction(
                self._session.node,
                FollowJointTrajectory,
                f"{_CONTROLLER}/follow_joint_trajectory",
                lambda plan: FollowJointTrajectory.Goal(trajectory=plan),
                lambda result: result.error_string,
            ),
        ]

    def _hand(self) -> ByAction:
        return ByAction(
            self._session.node,
            GripperCommand,
            _GRIPPER,
            lambda command: GripperCommand.Goal(command=command),
            lambda result: "",
        )

    def _grip(self) -> GripperCommandMessage:
        """Open the fingers where they are closed, and close them where they are not."""
        at = self._session.samples.latest()[0][-1]
        return GripperCommandMessage(position=0.0 if at > 0.5 * _OPEN else _OPEN)

    def _fingers_move(self) -> bool:
        samples = self._session.samples
        return samples.silent < _FRESH and bool(samples.latest()[1][-1])

    def _next_grip(self, hand: ByAction) -> str:
        """Move the fingers to the other end; returns what came of it."""
        self._session.until(lambda: self._session.samples.stands, "the robot stands")
        hand.begin(self._grip())
        self._session.until(hand.over, "the fingers arrive")
        return _ARRIVED if hand.over() == "succeeded" else hand.over()

    def next(self) -> str:
        """Plan and execute a motion from where the robot stands; returns what came of it."""
        said = _NO_ANSWER
        for tried in range(_TRIES):
            said = self._execute()
            if said == _ARRIVED:
                return f"{said}, after {tried} that did not" if tried else said
        return said

    def _execute(self) -> str:
        session = self._session
        session.until(lambda: session.samples.stands, "the robot stands")
        request = Execute.Request(trajectory=self._plan())
        answer = session.call(Execute, "trajectory_publisher/execute", request)
        if answer is None:
            return _NO_ANSWER
        code = answer.error_code
        return f"{code} {name_of(code)}: {answer.error_msg}" if code else _ARRIVED

    def _moves(self, part: float) -> Callable[[], bool]:
        """Return a function that says whether a joint goes faster than this part of its limit."""
        samples = self._session.samples

        def moves() -> bool:
            if not samples.count or samples.silent > _FRESH:
                return False
            velocity = np.abs(samples.latest()[1]) / samples.limits.velocity
            return bool(velocity.max() > part)

        return moves

    def _goal(self) -> Array:
        """Return the posture that is farther from where the robot is."""
        position = self._session.samples.latest()[0]
        return max(self._ends, key=lambda end: float(abs(end[0] - position[0])))

    def _plan(self) -> JointTrajectory:
        """Plan to the other posture, once the planner knows where the robot is."""
        session, plans = self._session, []
        goal = JointState(name=list(self._chain.joint_names), position=self._goal().tolist())
        request = PlanJoint.Request(
            goal=goal, profile=PlanJoint.Request.RUCKIG, velocity_scale=_SLOW
        )

        def planned() -> bool:
            answer = session.call(PlanJoint, "trajectory_planner/plan_joint", request)
            assert answer is not None, "plan_joint: no answer"
            if answer.error_code == ErrorCode.NO_STATE:
                return False
            assert answer.error_code == 0, f"plan_joint: {answer.error_msg}"
            plans.append(answer.trajectory)
            start = np.array(answer.trajectory.points[0].positions)
            place = session.samples.latest()[0][: self._chain.n]
            return bool(np.abs(start - place).max() < _SAME)

        session.until(planned, "a plan from where the robot is")
        return plans[-1]

    def _command(self) -> JointState:
        name, limit = self._chain.joint_names[0], self._chain.velocity[0]
        ahead = self._goal()[0] - self._session.samples.latest()[0][0]
        return JointState(name=[name], velocity=[float(np.sign(ahead) * _COMMANDED * limit)])

    def _postures(self, count: int) -> Array:
        low, high = self._ends
        return low + np.linspace(0.0, 1.0, count)[:, None] * (high - low)

    def _poses(self) -> SolveIKBatch.Request:
        tips = forward_kinematics(self._chain, self._postures(_POSES))
        rows = [stamped_pose(T, "").pose for T in tips]
        flat = [
            value
            for pose in rows
            for part in (pose.position, pose.orientation)
            for value in (getattr(part, axis) for axis in part.get_fields_and_field_types())
        ]
        return SolveIKBatch.Request(poses=flat)

    def _torques(self) -> SummarizeTorques.Request:
        return SummarizeTorques.Request(trajectory=self._plan())

    def _waypoints(self) -> PlanCartesian.Request:
        tips = forward_kinematics(self._chain, self._postures(_WAYPOINTS))
        start = JointState(
            name=list(self._chain.joint_names), position=self._postures(2)[0].tolist()
        )
        waypoints = [stamped_pose(T, "") for T in tips[1:]]
        return PlanCartesian.Request(
            start=start, waypoints=waypoints, path=PlanCartesian.Request.SPLINE
        )
