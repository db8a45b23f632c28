"""One control cycle: move the robot, then publish due messages."""

import traceback
from collections.abc import Callable, Sequence

from rclpy.node import Node

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
        self._others: list[Callable[[tuple[int, int]], None]] = []

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
        for publish in self._others:
            publish(stamp)

    def also_publish(self, publish: Callable[[tuple[int, int]], None]) -> None:
        """Call a function with the time stamp (s and ns) of all joint states from now on."""
        self._others.append(publish)
