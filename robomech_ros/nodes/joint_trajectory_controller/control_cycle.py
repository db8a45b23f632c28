"""The regular cycle of the controller: what it does, and when."""

import threading
import time
import traceback
from collections.abc import Callable, Sequence

from rclpy.node import Node

from robomech_ros.nodes.common.messages.message_fields import NANO
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.display.robot_display import RobotDisplay
from robomech_ros.nodes.joint_trajectory_controller.action_base import ActionBase
from robomech_ros.nodes.joint_trajectory_controller.commanded_joints import CommandedJoints
from robomech_ros.nodes.joint_trajectory_controller.goal_server import GoalServer
from robomech_ros.nodes.joint_trajectory_controller.robot import SimulatedRobot
from robomech_ros.nodes.joint_trajectory_controller.settings import ControllerSettings
from robomech_ros.nodes.joint_trajectory_controller.state_publisher import StatePublisher
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.outcomes import Code

_STOP_SECONDS = 3.0


class Cycles:
    """Calls a function at a fixed rate until `stop`.

    By the machine's time it does so in a thread of its own, since what the executor does before it
    waits again takes longer than a cycle; whatever the function shares with callbacks needs a lock.
    With simulated time, which comes through the executor, it is a timer of the node.  Cycles that
    are missed are left out, and those after them come when they would have come.

    - ``node``: the node that does the work.
    - ``rate``: cycles per second.
    - ``work``: called in each cycle.
    """

    def __init__(
        self, node: Node, clock: MotionClock, rate: float, work: Callable[[], None]
    ) -> None:
        self._node, self._log = node, ThrottledLog(node.get_logger())
        self._work = work
        self._period = round(NANO / rate)
        self._over = threading.Event()
        self._thread: threading.Thread | None = None
        if clock.simulated:
            timer = node.create_timer(1.0 / rate, self._call, clock=clock.clock)
            # A timer that has not fired yet would wait until its old time comes again.
            clock.on_jump(lambda by: timer.reset())
        else:
            self._thread = threading.Thread(target=self._run, name="cycles", daemon=True)
            self._thread.start()

    def stop(self) -> None:
        """End after the present cycle; to be called before the node is destroyed."""
        self._over.set()
        if self._thread not in (None, threading.current_thread()):
            assert self._thread is not None
            self._thread.join(_STOP_SECONDS)

    def _run(self) -> None:
        due = time.monotonic_ns() + self._period
        while not self._over.wait((due - time.monotonic_ns()) / NANO):
            if not self._node.context.ok():
                return
            self._call()
            missed = max(time.monotonic_ns() - due, 0) // self._period
            due += (1 + missed) * self._period

    def _call(self) -> None:
        try:
            self._work()
        except Exception:
            # The context may have ended in the meantime.
            if self._node.context.ok() and not self._over.is_set():
                self._log.error(f"a cycle failed, please report this:\n{traceback.format_exc()}")


def serve_control(
    node: Node, robot: SimulatedRobot, clock: MotionClock
) -> tuple[list[ActionBase], Callable[[], None]]:
    """Serve the action follow_joint_trajectory, and topics and services of the controller's state.

    - ``robot``: the robot that executes the goals.

    Returns a list with the server of the action, which is empty if control_msgs is not installed,
    and a callable that publishes controller_state.
    """
    try:
        from robomech_ros.nodes.joint_trajectory_controller.follow_messages import FollowMessages
        from robomech_ros.nodes.joint_trajectory_controller.state_topics import StateTopics
    except ImportError as error:
        if getattr(error, "name", "") != "control_msgs":
            node.get_logger().warning(f"no follow_joint_trajectory: {error}")
        return [], lambda: None
    server = GoalServer(node, robot, FollowMessages(robot.joint_names))
    return [server], StateTopics(node, robot, clock).publish


class ControlCycle:
    """Moves the robot, and publishes its states.

    - ``commanded``: the commanded joints, those of the robot first; they share a lock.
    - ``model``: the whole robot, with the joints that do not belong to the chain.
    - ``settings``: parameters, with the rates.
    - ``publish_control``: publishes controller_state.
    - ``servers``: servers of actions, which publish feedback.
    - ``on_moved``: called in every cycle after the robot has moved; the robot's lock is held.
    """

    def __init__(
        self,
        node: Node,
        commanded: Sequence[CommandedJoints],
        model: RobotModel,
        settings: ControllerSettings,
        publish_control: Callable[[], None],
        servers: Sequence[ActionBase],
        on_moved: Callable[[], None],
    ) -> None:
        self._log = ThrottledLog(node.get_logger())
        self._robot, self._commanded = commanded[0], commanded
        self.states = StatePublisher(node, model, commanded)  #: Publishes joint_states.
        given = bool(settings.robot_description_semantic)
        self._display = RobotDisplay(
            node,
            model.description,
            prefix=model.frame_prefix,
            frames=settings.publish_frames,
            rate=min(settings.frame_rate, settings.publish_rate),
            # Messages of the topic have been taken already.
            describe=settings.publish_description and bool(settings.robot_description),
            semantic=model.semantic.document if given and settings.publish_description else "",
        )
        self._publish_control = publish_control
        self._servers, self._on_moved = servers, on_moved
        rate = settings.publish_rate
        self._cycles_per_feedback = max(round(rate / settings.action_monitor_rate), 1)
        self._cycles_per_frames = max(round(rate / settings.frame_rate), 1)
        self._cycles_per_state = max(round(rate / settings.state_publish_rate), 1)
        self._count = 0
        self._limited = False
        #: Called with the ROS time (s and ns) of each published state.
        self.others: list[Callable[[tuple[int, int]], None]] = []

    def run(self) -> None:
        """Move the robot, and publish what is due."""
        robot = self._robot
        with robot.lock:
            time = robot.time
            for joints in self._commanded:
                try:
                    joints.advance_to(time)
                    if joints.fault:
                        self._log.error(joints.fault)
                except Exception:
                    self._log.error(f"motion failed, please report:\n{traceback.format_exc()}")
                    text = "internal error of the controller, see its log"
                    joints.follower.halt(Code.INTERNAL, text)
            self.publish_joint_states()
            limited = bool(robot.simulated_joints.at_limit.any())
            # Once in each motion.
            if limited and not self._limited:
                saturation = robot.simulated_joints.saturation(robot.joint_names)
                self._log.warning(f"the robot may not follow: {saturation} so far")
            self._limited = limited
            self._on_moved()
            self._count += 1
            if self._count % self._cycles_per_frames == 0:
                self._display.publish(self.states.positions, self.states.stamp)
            if self._count % self._cycles_per_state == 0:
                self._publish_control()
            if self._count % self._cycles_per_feedback == 0:
                for server in self._servers:
                    server.publish_feedback()

    def publish_joint_states(self) -> None:
        """Publish where the joints are; the robot's lock is to be held."""
        stamp = self._robot.stamp()
        self.states.publish(stamp)
        for publish in self.others:
            publish(stamp)
