"""Frames of a robot on /tf: those that nobody else publishes."""

from collections.abc import Collection

from rclpy.clock import Clock, ClockType
from rclpy.node import Node

from robomech_ros.nodes.common.error_codes import shortened
from robomech_ros.nodes.display.external_frames import FixedFrames, MovingFrames
from robomech_ros.nodes.display.frame_publisher import FramePublisher
from robomech_ros.nodes.display.other_publishers import PERIOD

# Frames are published from this look on, later where others are on /tf: a robot_state_publisher
# needs joint_states before it says anything.
FIRST, FIRST_BESIDE_OTHERS = 2, 4
_MOST_NAMES = 5


class UnclaimedFrames:
    """Has a publisher publish those frames of a robot that nobody else does, whoever comes or goes.

    Parameters
    ----------
    node : Node
        Owner of the timer and the log, which says at every change who publishes what.
    publisher : FramePublisher
        Of all frames.
    robot : str
        Name of the robot.
    rate : float
        How often frames are due (Hz).
    """

    def __init__(self, node: Node, publisher: FramePublisher, robot: str, rate: float) -> None:
        self._node, self._publisher, self._robot = node, publisher, robot
        self._moving = MovingFrames(node, publisher, rate)
        self._fixed = FixedFrames(node, publisher)
        self._left: frozenset[str] | None = None
        self._looks = 0
        node.create_timer(PERIOD, self._look, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _look(self) -> None:
        self._looks += 1
        moving, fixed = self._moving.look(), self._fixed.look()
        others = {*self._moving.others.nodes, *self._fixed.others.nodes}
        if fixed is None or self._looks < (FIRST_BESIDE_OTHERS if others else FIRST):
            return
        left = moving | fixed
        if left == self._left:
            return
        self._left = left
        self._publisher.choose(
            [frame for frame in self._publisher.moving if frame not in left],
            [frame for frame in self._publisher.fixed if frame not in left],
        )
        self._node.get_logger().info(self._decision(left, sorted(others)))

    def _decision(self, left: Collection[str], others: list[str]) -> str:
        count = len(self._publisher.moving) + len(self._publisher.fixed)
        topic, robot = self._publisher.topic, self._robot
        if not left:
            return f"{topic}: nobody else publishes frames of {robot}: this node does, all {count}"
        who = others[0] if len(others) == 1 else f"one or more of {shortened(others, _MOST_NAMES)}"
        hint = ""
        if any(name.endswith(f"/{self._node.get_name()}") for name in others):
            hint = ". If that is another robot, set frame_prefix (bringup --namespace does)"
        if len(left) == count:
            return f"{topic}: all {count} frames of {robot} come from {who}, not from here{hint}"
        some = f"{len(left)} of {count} frames of {robot} come from {who}"
        names = shortened(sorted(left), _MOST_NAMES)
        return f"{topic}: {some}: {names}; the others from here{hint}"
