"""The node that stands in for MoveIt's move_group."""

from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, Any

from rclpy.node import Node

from robomech_ros.errors import RobomechError
from robomech_ros.errors.formatting import counted
from robomech_ros.nodes.common.cooperative_wait import Worker, steady_timer
from robomech_ros.nodes.common.joints.joint_limits import robot_limits
from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.parameters import NodeParameters
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.common.robot.robot_source import when_robot_known
from robomech_ros.nodes.frames.robot_frames import RobotFrames
from robomech_ros.nodes.move_group.settings import MoveGroupSettings
from robomech_ros.nodes.process.memory import settle_pages
from robomech_ros.nodes.process.run import run_node

if TYPE_CHECKING:
    from robomech_ros.nodes.move_group.motion_services import MotionServices
    from robomech_ros.nodes.move_group.planning import MotionPlanning

# Packages of messages that the node cannot do without.
_PACKAGES = ("moveit_msgs", "control_msgs")
# Time after which the first clients have made the node load what they need (s).
_SETTLED = 60.0


class MissingMessagesError(RobomechError):
    """A package of messages is not installed."""

    def __init__(self, package: str) -> None:
        super().__init__(
            f"move_group needs {package}: `make setup` builds it, a ROS distribution has it as "
            f"ros-$ROS_DISTRO-{package.replace('_', '-')}"
        )


def require_messages() -> None:
    """Raise MissingMessagesError if a package of messages is not installed."""
    for package in _PACKAGES:
        try:
            import_module(package)
        except ImportError:
            raise MissingMessagesError(package) from None


class MoveGroupNode(Node):
    """MoveIt's services, actions and topics, and the planning scene, for one robot."""

    SETTINGS = MoveGroupSettings

    def __init__(self, **options: Any) -> None:
        require_messages()
        super().__init__("move_group", **options)
        self._planning: MotionPlanning | None = None
        self._motions: MotionServices | None = None
        # Plans take seconds.
        self._worker = Worker(self)
        self._table = NodeParameters(self, MoveGroupSettings)
        self._monitor = JointStateMonitor(self)
        settings = self._table.settings
        when_robot_known(self, settings, self._serve, **robot_limits(self, settings))

    def stop(self) -> None:
        """Answer all requests that wait for a plan."""
        text = "the node move_group shuts down"
        self._worker.give_up(text)
        if self._planning is not None:
            self._planning.give_up(text)

    def destroy_node(self) -> None:
        """Destroy the node, its actions, and its thread for plans."""
        self._worker.close()
        if self._motions is not None:
            self._motions.destroy()
        super().destroy_node()

    def _serve(self, model: RobotModel) -> None:
        # Parts that need messages of MoveIt, or the libraries of collisions.
        from robomech_ros.collision.libraries import ompl
        from robomech_ros.nodes.move_group.execution import Execution
        from robomech_ros.nodes.move_group.motion_services import MotionServices
        from robomech_ros.nodes.move_group.planner_services import PlannerServices
        from robomech_ros.nodes.move_group.planning import MotionPlanning
        from robomech_ros.nodes.move_group.scene_services import SceneServices
        from robomech_ros.nodes.move_group.scenes import Scenes
        from robomech_ros.nodes.move_group.validity_service import ValidityService
        from robomech_ros.nodes.moveit.cartesian_service import CartesianPathService
        from robomech_ros.nodes.moveit.services import MoveItServices
        from robomech_ros.nodes.moveit.whole_robot import WholeRobot

        def settings() -> MoveGroupSettings:
            return self._table.settings

        frames = RobotFrames(self, model, self._monitor, settings)
        scenes = Scenes(model, self._worker, settings().padding)
        robot = WholeRobot(frames, lambda: scenes.world.attached)
        self._planning = MotionPlanning(self, robot, scenes, self._worker, settings)
        MoveItServices(self, robot, settings, scenes)
        CartesianPathService(self, robot, settings, self._worker, scenes)
        ValidityService(self, robot, settings, scenes)
        SceneServices(self, robot, scenes, settings())
        PlannerServices(self, settings)
        execution = Execution(self, robot, scenes, settings)
        self._motions = MotionServices(self, self._planning, execution)
        text = f"; {scenes.unchecked}" if scenes.unchecked else ""
        self.get_logger().info(
            f"ready: {model.chain.name}, {counted(model.chain.n, 'joint')}{text}"
        )
        # The first plan does not wait for it.
        self._worker.begin(ompl)
        self._worker.begin(settle_pages)
        self._settling = steady_timer(self, _SETTLED, self._settle)

    def _settle(self) -> None:
        """Release memory that only the first requests needed."""
        self._settling.cancel()
        self._worker.begin(settle_pages)


main = partial(run_node, MoveGroupNode)

if __name__ == "__main__":
    raise SystemExit(main())
