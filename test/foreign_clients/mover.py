"""A client of MoveIt that plans and executes, with nothing of this project in it.

It prints what became of its goals as JSON.
"""

from __future__ import annotations

import json
import sys
import time
from collections import Counter
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from moveit_msgs.action import ExecuteTrajectory, MoveGroup
from moveit_msgs.msg import (
    Constraints,
    JointConstraint,
    MotionPlanRequest,
    MoveItErrorCodes,
    RobotState,
)
from moveit_msgs.srv import (
    GetMotionPlan,
    GetPlanningScene,
    GetPositionFK,
    GetPositionIK,
    GetStateValidity,
)
from rclpy.action import ActionClient
from rclpy.node import Node
from sensor_msgs.msg import JointState

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from connected_clients import connect

# Every goal and request must be answered within this time, s.
PATIENCE = 60.0
_PLANNING = 2.0
_SPEEDS, _PAUSES = (0.1, 0.6), (0.0, 1.5)
# Codes whose text is told: a robot that ten clients move and that objects hit has no such reasons.
_UNUSUAL = (MoveItErrorCodes.CONTROL_FAILED, MoveItErrorCodes.FAILURE)


class Mover:
    """A node with MoveIt's services and actions.

    Parameters
    ----------
    random : Generator
    names : list of str
        The joints.
    middle, span : ndarray, shape (n,)
        Of the postures that it goes to (rad).
    """

    def __init__(self, random: Any, names: list[str], middle: Any, span: Any) -> None:
        self._random, self._names, self._middle, self._span = random, names, middle, span
        self._node = Node(f"mover_{random.integers(1 << 30)}")
        kinds = {
            "get_planning_scene": GetPlanningScene,
            "plan_kinematic_path": GetMotionPlan,
            "compute_ik": GetPositionIK,
            "compute_fk": GetPositionFK,
            "check_state_validity": GetStateValidity,
        }
        self._services = {n: self._node.create_client(kind, n) for n, kind in kinds.items()}
        self._move = ActionClient(self._node, MoveGroup, "move_action")
        self._execute = ActionClient(self._node, ExecuteTrajectory, "execute_trajectory")
        self.outcomes: Counter[str] = Counter()
        self.unanswered: Counter[str] = Counter()
        self.longest = 0.0

    def connect(self) -> None:
        """Ask each service and action until it answers."""
        wait = partial(rclpy.spin_until_future_complete, self._node)
        connect(self._node, lambda future, seconds: wait(future, timeout_sec=seconds))

    def act(self) -> None:
        """Do one thing of many."""
        actions = (self._go, self._go, self._go, self._plan_and_execute, self._ask)
        actions[self._random.integers(len(actions))]()

    def _posture(self) -> list[float]:
        return (
            self._middle + self._span * self._random.uniform(-1.0, 1.0, len(self._names))
        ).tolist()

    def _request(self) -> MotionPlanRequest:
        joints = [
            JointConstraint(
                joint_name=name,
                position=value,
                tolerance_above=1e-3,
                tolerance_below=1e-3,
                weight=1.0,
            )
            for name, value in zip(self._names, self._posture(), strict=True)
        ]
        request = MotionPlanRequest(allowed_planning_time=_PLANNING)
        request.goal_constraints = [Constraints(joint_constraints=joints)]
        request.start_state.is_diff = True
        # Slow motions are still on their way when an object appears.
        request.max_velocity_scaling_factor = float(self._random.uniform(*_SPEEDS))
        return request

    def _go(self) -> None:
        goal = MoveGroup.Goal(request=self._request())
        goal.planning_options.plan_only = bool(self._random.random() < 0.2)
        what = "plans by action" if goal.planning_options.plan_only else "motions"
        self._finish(what, self._move, goal)

    def _plan_and_execute(self) -> None:
        request = GetMotionPlan.Request(motion_plan_request=self._request())
        answer = self._answer("plan_kinematic_path", request)
        if answer is None:
            return
        found = answer.motion_plan_response
        self.outcomes[f"plans by service: {found.error_code.val}"] += 1
        if found.error_code.val == found.error_code.SUCCESS:
            goal = ExecuteTrajectory.Goal(trajectory=found.trajectory)
            self._finish("executions", self._execute, goal)

    def _ask(self) -> None:
        state = RobotState(joint_state=JointState(name=self._names, position=self._posture()))
        checked = self._answer("check_state_validity", GetStateValidity.Request(robot_state=state))
        if checked is not None:
            self.outcomes[f"states that are {'' if checked.valid else 'not '}valid"] += 1
        placed = self._answer(
            "compute_fk", GetPositionFK.Request(robot_state=state, fk_link_names=["tool0"])
        )
        if placed is None:
            return
        request = GetPositionIK.Request()
        request.ik_request.pose_stamped = placed.pose_stamped[0]
        request.ik_request.robot_state = state
        request.ik_request.avoid_collisions = True
        solved = self._answer("compute_ik", request)
        if solved is not None:
            self.outcomes[f"inverse kinematics: {solved.error_code.val}"] += 1

    def _finish(self, what: str, client: ActionClient, goal: Any) -> None:
        handle = self._done(f"{what}, sent", client.send_goal_async(goal))
        if handle is None:
            return
        if not handle.accepted:
            self.outcomes[f"{what}: rejected"] += 1
            return
        ended = self._done(f"{what}, accepted", handle.get_result_async())
        if ended is not None:
            code = ended.result.error_code
            text = f" {code.message[:200]}" if code.val in _UNUSUAL else ""
            self.outcomes[f"{what}: {code.val}{text}"] += 1

    def _answer(self, service: str, request: Any) -> Any:
        return self._done(service, self._services[service].call_async(request))

    def _done(self, what: str, future: Any) -> Any:
        began = time.monotonic()
        rclpy.spin_until_future_complete(self._node, future, timeout_sec=PATIENCE)
        self.longest = max(self.longest, time.monotonic() - began)
        if future.done():
            return future.result()
        self.unanswered[what] += 1
        return None


def main() -> None:
    """Act for so many seconds: a seed, seconds, and the joints with their ranges come as JSON."""
    given = json.loads(sys.argv[1])
    rclpy.init(args=[])
    random = np.random.default_rng(given["seed"])
    mover = Mover(random, given["names"], np.array(given["middle"]), np.array(given["span"]))
    mover.connect()
    until = time.monotonic() + given["seconds"]
    while time.monotonic() < until:
        mover.act()
        time.sleep(float(random.uniform(*_PAUSES)))
    report = {"outcomes": mover.outcomes, "unanswered": mover.unanswered, "longest": mover.longest}
    print(json.dumps(report), flush=True)
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
