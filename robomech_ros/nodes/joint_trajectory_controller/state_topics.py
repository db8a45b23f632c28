"""Topics controller_state, speed_scaling_input, and service query_state, as of ros2_control."""

from typing import Any

from builtin_interfaces.msg import Time
from control_msgs.msg import JointTrajectoryControllerState, SpeedScalingFactor
from control_msgs.srv import QueryTrajectoryState
from rclpy.node import Node

from robomech_ros.errors import RobomechError
from robomech_ros.execution.controller.desired_state import desired_state, past_the_end
from robomech_ros.execution.joints import State
from robomech_ros.execution.rejections import TrajectoryRefusedError
from robomech_ros.nodes.common.messages.message_fields import duration_from_seconds, floats
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.services import serve
from robomech_ros.nodes.joint_trajectory_controller.commanded_joints import CommandedJoints
from robomech_ros.nodes.joint_trajectory_controller.messages import point_from_state
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog

_DEPTH = 10


class StateTopics:
    """Publishes states while somebody subscribes, and answers where the joints should be.

    Clients also say here at which part of its speed trajectories are followed.
    """

    def __init__(self, node: Node, robot: CommandedJoints, clock: MotionClock) -> None:
        self._robot, self._clock = robot, clock
        self._log = ThrottledLog(node.get_logger())
        kind = JointTrajectoryControllerState
        self._message = kind(joint_names=robot.joint_names)
        self._publisher = node.create_publisher(kind, "~/controller_state", _DEPTH)
        node.create_subscription(SpeedScalingFactor, "~/speed_scaling_input", self._scale, _DEPTH)
        serve(node, QueryTrajectoryState, "~/query_state", self._answer)

    def publish(self) -> None:
        """Publish the present state; the robot's lock is to be held."""
        if not self._publisher.get_subscription_count():
            return
        message, follower = self._message, self._robot.follower
        desired, actual, goal = follower.desired, follower.actual, follower.active
        time = duration_from_seconds(goal.time if goal is not None else 0.0)
        message.speed_scaling_factor = follower.motion.scale
        stamp = message.header.stamp
        stamp.sec, stamp.nanosec = self._robot.stamp()
        message.reference = point_from_state(desired, time)
        message.feedback = point_from_state(actual, time)
        message.error = point_from_state(desired - actual, time)
        # The commands of the simulated joints are positions.
        message.output.positions = message.reference.positions
        message.output.time_from_start = time
        self._publisher.publish(message)

    def _scale(self, message: SpeedScalingFactor) -> None:
        if not 0.0 <= message.factor <= 1.0:
            text = f"speed scaling factor is {message.factor}, expected from 0 (pause) to 1"
            self._log.error(text)
            return
        with self._robot.lock:
            self._robot.advance()
            self._robot.follower.motion.scale = message.factor

    def _answer(self, request: Any, response: Any) -> Any:
        response.name = self._robot.joint_names
        try:
            state, over = self._desired_at(request.time)
        except RobomechError as error:
            response.message = str(error)
            return response
        response.success = not over
        if over:
            end = f"{over:.6g} s after the end of the trajectory"
            response.message = f"{end}: position is its last point, where the robot holds"
        response.position = floats(state.position)
        response.velocity = floats(state.velocity)
        response.acceleration = floats(state.acceleration)
        return response

    def _desired_at(self, stamp: Time) -> tuple[State, float]:
        """Return where the joints should be at a time, and how long (s) past the end that is."""
        robot = self._robot
        if robot.refuse_all:
            raise TrajectoryRefusedError(robot.refuse_all)
        with robot.lock:
            robot.advance()
            ahead = self._clock.until(stamp, robot.follower.now)
            follower = robot.follower
            return desired_state(follower, ahead), past_the_end(follower, ahead)
