"""The end of the controller: the robot slows down and holds before the node goes."""

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.task import Future

from robomech_ros.execution.controller.follower import Phase
from robomech_ros.execution.controller.trajectory_goal import End
from robomech_ros.nodes.common.pauses import wake
from robomech_ros.nodes.joint_trajectory_controller.robot import SimulatedRobot
from robomech_ros.outcomes import Code

__all__ = ["Shutdown"]

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
    robot : SimulatedRobot
        What is to stand.
    """

    def __init__(self, node: Node, robot: SimulatedRobot) -> None:
        self._node = node
        self._robot = robot
        self._standing: Future | None = None

    async def stand(self) -> None:
        """Refuse all trajectories from now on, slow down, and hold."""
        # By the machine's time: simulated time may stand still.
        deadline = self._node.create_timer(
            _LONGEST_STOP, self._halt, clock=Clock(clock_type=_STEADY)
        )
        standing: Future = Future()
        with self._robot.lock:
            self._robot.refuse_all = _WHY
            self._standing = standing
            self._robot.follower.stop(End.ABORTED, Code.PREEMPTED, _WHY)
            self.look()
        await standing
        self._node.destroy_timer(deadline)

    def look(self) -> None:
        """Let `stand` go on as soon as the robot stands; the robot's lock is to be held."""
        standing = self._robot.follower.phase is Phase.HOLDING
        if self._standing is not None and standing and not self._standing.done():
            self._standing.set_result(None)
            wake(self._node)

    def _halt(self) -> None:
        """Hold at once."""
        with self._robot.lock:
            self._robot.follower.halt(Code.PREEMPTED, _WHY)
            self.look()
