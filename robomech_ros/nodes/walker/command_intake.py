"""Takes commands of a walker from their topics, and says which it does not follow, and why."""

from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import Pose
from rclpy.node import Node
from std_msgs.msg import String

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.twist_input import TwistInput
from robomech_ros.nodes.middleware.polled_subscription import Inbox
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.outcomes import Code, name_of
from robomech_ros.spatial import euler_angles_from_matrix
from robomech_ros.walking import Walker

_DEPTH = 10


class CommandIntake:
    """Received commands of a walker.

    - ``duration``: time in which the trunk goes to a new pose (s).
    - ``commanded``: whether the last look found a new twist.
    - ``refusal``: why the last pose or gait was refused; empty if it was not.
    - ``refused``: number of refused poses and gaits.
    """

    def __init__(self, node: Node, walker: Walker, clock: MotionClock, duration: float) -> None:
        self._log, self._walker, self._duration = ThrottledLog(node.get_logger()), walker, duration
        self.commanded, self.refusal, self.refused = False, "", 0
        self.twists = TwistInput(node, "cmd_vel", self._follow, clock)
        gaits = Inbox(node, String, "~/gait", _DEPTH)
        self._readers: list[tuple[Inbox, Callable[[Any], None]]] = [
            (Inbox(node, Pose, "body_pose", _DEPTH), self._pose),
            (gaits, lambda message: walker.command_gait(message.data)),
        ]

    def take(self, stands: bool) -> None:
        """Return what has come since the last look; one that does not stand takes twists only."""
        self.commanded = False
        self.twists.take()
        for inbox, read in self._readers:
            for message in inbox.take():
                try:
                    if not stands:
                        raise BadValueError("the robot", "not up", "one that stands: send a twist")
                    read(message)
                except RobomechError as error:
                    self.refusal = f"command on '{inbox.topic}' refused: {error}"
                    self.refused += 1
                    self._log.warning(self.refusal)
                else:
                    self.refusal = ""

    def _follow(self, twist: Any, age: float) -> None:
        timeout = self._walker.timeout
        if age > timeout:
            raise BadValueError("age of the command", age, f"up to {timeout:g} s, the time-out")
        self._walker.command(twist)
        self.commanded = True

    def _pose(self, message: Pose) -> None:
        T = matrix_from_pose(message, "body_pose")
        yaw, pitch, roll = euler_angles_from_matrix(T[:3, :3], "ZYX")
        answer = self._walker.command_pose([*T[:3, 3], roll, pitch, yaw], self._duration)
        if answer.status != Code.NONE:
            code = answer.status
            raise RobomechError(f"{code.value} {name_of(code)}: {answer.reason}")
