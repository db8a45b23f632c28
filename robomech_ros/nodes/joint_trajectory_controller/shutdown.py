"""The end of the controller: the robot slows down and holds before the node goes."""

from collections.abc import Sequence

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.task import Future

from robomech_ros.execution.controller.follower import Phase
from robomech_ros.nodes.common.cooperative_wait import wake
from robomech_ros.nodes.joint_trajectory_controller.commanded_joints import CommandedJoints
from robomech_ros.outcomes import Code

_WHY = "the controller shuts down; the robot holds"
# How long the robot may take to slow down when the node ends, s; then it holds at once.
_LONGEST_STOP = 2.0
_STEADY = ClockType.STEADY_TIME


class Shutdown:
    """Stops the robot and waits until it stands.

    Parameters
    ----------
    node : Node
        What ends.
    commanded : sequence of CommandedJoints
        What is to stand; they share a lock.
    """

    def __init__(self, node: Node, commanded: Sequence[CommandedJoints]) -> None:
        self._node, self._commanded = node, commanded
        self._lock = commanded[0].lock
        self._standing: Future | None = None

    async def stand(self) -> None:
        """Refuse all trajectories from now on, slow down, and hold."""
        # By the machine's time: simulated time may stand still.
        deadline = self._node.create_timer(
            _LONGEST_STOP, self._halt, clock=Clock(clock_type=_STEADY)
        )
        standing: Future = Future()
        with self._lock:
            self._standing = standing
            for joints in self._commanded:
                joints.close(_WHY)
            self.look()
        await standing
        self._node.destroy_timer(deadline)

    def look(self) -> None:
        """Let `stand` go on as soon as the robot stands; the joints' lock is to be held."""
        standing = all(joints.follower.phase is Phase.HOLDING for joints in self._commanded)
        if self._standing is not None and standing and not self._standing.done():
            self._standing.set_result(None)
            wake(self._node)

    def _halt(self) -> None:
        with self._lock:
            for joints in self._commanded:
                if joints.follower.phase is not Phase.HOLDING:
                    joints.follower.halt(Code.PREEMPTED, _WHY)
            self.look()
