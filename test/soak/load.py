"""Everything that clients do to the suite, mixed, again and again."""

from __future__ import annotations

import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from attack import ODDS, Attack
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import TwistStamped
from known_robot import known_arm
from messages import SHARES, MessageMaker
from nav_msgs.msg import Path as PathMessage
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool, Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint
from visualization_msgs.msg import MarkerArray

from robomech_interfaces.msg import ServoStatus
from robomech_interfaces.srv import (
    AnalyzeSingularity,
    Execute,
    PlanCartesian,
    PlanJoint,
    QueryWorkspace,
    SetSpeed,
)
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.messages.pose_messages import stamped_pose
from robomech_ros.nodes.middleware.queue_depth import ask
from robomech_ros.robots import SerialChain

__all__ = ["Load"]

PATIENCE = 60.0
# Random things in each round.
_RANDOM = 100
_SENSIBLE = {"request": 0.85, "message": 0.12, "goal": 0.03}
# How far a planned motion goes from home (rad or m).
_FAR = 0.15
_PROFILES = 6
# A plan of so long (s), and a path of this length (m) that takes as long, have almost as many
# points as they may have.
_LONGEST, _STEP = 99, 0.02
_STREAM, _PERIOD = 25, 0.02
_TOPICS = (
    (JointState, "joint_states"),
    (JointTrajectory, "trajectory_planner/planned_trajectory"),
    (PathMessage, "trajectory_planner/planned_path"),
    (MarkerArray, "kinematics/markers"),
    (ServoStatus, "servo/status"),
)
# How many rounds there are for each client that is killed without a word.
_ROUNDS_A_KILL = 10
_VICTIM = Path(__file__).with_name("victim.py")


class Load:
    """A client of all nodes.

    Parameters
    ----------
    node : Node
        Who calls.
    names : list of str
        The nodes that are called.
    chain : SerialChain
        The robot.
    seed : int
        Of the random numbers.
    alive : callable
        Says whether the nodes still run.
    wild : bool
        Whether messages may be as hostile as those of `make fuzz`.

    Attributes
    ----------
    rounds : int
        How many are done.
    counts : Counter
        What was done in them, beside random things.
    """

    def __init__(
        self,
        node: Node,
        names: list[str],
        chain: SerialChain,
        seed: int,
        alive: Callable[[], bool],
        *,
        wild: bool,
    ) -> None:
        self.counts: Counter[str] = Counter()
        self._node, self._chain, self._rng = node, chain, np.random.default_rng(seed)
        maker = MessageMaker(self._rng, known_arm(chain), SHARES if wild else (0.0,))
        odds = ODDS if wild else _SENSIBLE
        self.attack = Attack(node, names, maker, self._rng, alive, odds)
        self._twists = node.create_publisher(TwistStamped, "servo/delta_twist_cmds", 10)
        self._executor = SingleThreadedExecutor(context=node.context)
        self.rounds = 0

    def touch_everything(self) -> None:
        """Ask for all that is loaded or computed for the first who asks, and for the longest plans.

        Buffers of the middleware stay as large as the largest message that went through them.
        """
        self._call("kinematics/query_workspace", QueryWorkspace, QueryWorkspace.Request())
        posture = JointState(position=self._chain.home().tolist())
        self._call(
            "kinematics/analyze_singularity", AnalyzeSingularity,
            AnalyzeSingularity.Request(state=posture),
        )  # fmt: skip
        via = JointTrajectoryPoint(positions=(self._chain.home() + _FAR).tolist())
        away = JointState(position=via.positions)
        T = forward_kinematics(self._chain, self._chain.home()).copy()
        T[2, 3] -= _STEP
        end = stamped_pose(T, "")
        for profile in range(_PROFILES):
            request = PlanJoint.Request(start=posture, goal=posture, via=[via], profile=profile)
            self._call("trajectory_planner/plan_joint", PlanJoint, request)
            request = PlanJoint.Request(start=posture, goal=away, profile=profile)
            request.duration = Duration(sec=_LONGEST)
            self._call("trajectory_planner/plan_joint", PlanJoint, request)
            path = PlanCartesian.Request(start=posture, waypoints=[end], profile=profile)
            path.max_linear_speed = _STEP / _LONGEST
            self._call("trajectory_planner/plan_cartesian", PlanCartesian, path)
        self._undo()

    def round(self) -> None:
        """Do a little of everything, and wait for all answers."""
        self.attack.run(_RANDOM)
        self._undo()
        self._move(cancelled=self.rounds % 3 == 2)
        self._drive()
        self._come_and_go()
        if self.rounds % _ROUNDS_A_KILL == 0:
            self._be_killed()
        self.rounds += 1

    def _call(self, service: str, kind: Any, request: Any) -> Any:
        answer = self.attack.call(service, kind, request)
        self.counts["calls"] += answer is not None
        self.attack.outcome.unanswered.update([service] if answer is None else [])
        return answer

    def _undo(self) -> None:
        """Take back what random requests may have paused, held or slowed down."""
        for service in ("trajectory_publisher/cancel", "trajectory_publisher/resume"):
            self._call(service, Trigger, Trigger.Request())
        self._call("servo/pause_servo", SetBool, SetBool.Request(data=False))
        self._call("trajectory_publisher/set_speed", SetSpeed, SetSpeed.Request(speed=1.0))
        self._call("joint_trajectory_controller/hold", Trigger, Trigger.Request())

    def _move(self, *, cancelled: bool) -> None:
        """Plan a motion near home and execute it, to its end or until it is cancelled."""
        away = self._rng.uniform(-_FAR, _FAR, self._chain.n)
        goal = np.clip(self._chain.home() + away, self._chain.lower, self._chain.upper)
        request = PlanJoint.Request(profile=int(self._rng.integers(_PROFILES)))
        request.goal.position = goal.tolist()
        plan = self._call("trajectory_planner/plan_joint", PlanJoint, request)
        if plan is None or plan.error_code:
            self.counts["refused plans"] += 1
            return
        self.counts["plans"] += 1
        execute = ask(self._node, Execute, "trajectory_publisher/execute")
        answer = execute.call_async(Execute.Request(trajectory=plan.trajectory))
        if cancelled:
            self._spin(0.2)
            self._call("trajectory_publisher/cancel", Trigger, Trigger.Request())
        self.attack.wait_for(answer)
        done = answer.result()
        if done is None:
            self.attack.outcome.unanswered["trajectory_publisher/execute"] += 1
        else:
            self.counts[f"motions that ended with {done.error_code}"] += 1
        self._node.destroy_client(execute)

    def _drive(self) -> None:
        """Stream twists to the servo for half a second."""
        twist = TwistStamped()
        linear = self._rng.uniform(-0.05, 0.05, 3)
        twist.twist.linear.x, twist.twist.linear.y, twist.twist.linear.z = linear.tolist()
        for _ in range(_STREAM):
            self._twists.publish(twist)
            self._spin(_PERIOD)
        self.counts["streams"] += 1

    def _spin(self, seconds: float) -> None:
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0.0:
            self.attack.spin_once(left)

    def _come_and_go(self) -> None:
        """Appear as a client and a listener, as a new participant and within an old one."""
        context = rclpy.Context()
        context.init(args=[])
        passer = Node("passer", context=context)
        try:
            for node in (self._node, passer):
                self._listen_and_call(node)
        finally:
            passer.destroy_node()
            context.try_shutdown()
        self.counts["clients that came and went"] += 2

    def _listen_and_call(self, node: Node) -> None:
        heard: list[Any] = []
        listening = [node.create_subscription(*topic, heard.append, 10) for topic in _TOPICS]
        client = ask(node, Trigger, "kinematics/ready")
        assert client.wait_for_service(PATIENCE), "kinematics/ready is gone"
        answer = client.call_async(Trigger.Request())
        executor = SingleThreadedExecutor(context=node.context)
        if node is not self._node:
            executor.add_node(node)
            executor.spin_until_future_complete(answer, PATIENCE)
            executor.remove_node(node)
        else:
            self.attack.wait_for(answer)
        executor.shutdown()
        if not answer.done():
            self.attack.outcome.unanswered["kinematics/ready"] += 1
        for subscription in listening:
            node.destroy_subscription(subscription)
        node.destroy_client(client)

    def _be_killed(self) -> None:
        """Be a client whose process is killed while it waits for an answer."""
        victim = subprocess.Popen([sys.executable, str(_VICTIM)], stdout=subprocess.PIPE)
        assert victim.stdout is not None
        victim.stdout.readline()
        victim.kill()
        victim.wait()
        victim.stdout.close()
        self.counts["clients killed"] += 1
