"""The robot of a page: plans, stops and jogs through the nodes of the suite."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.subscription import Subscription
from trajectory_msgs.msg import JointTrajectory
from visualization_msgs.msg import Marker, MarkerArray

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.nodes.common.robot.robot_description import LATCHED, RobotModel
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.nodes.rvs.gripper import GripperClient, soon
from robomech_ros.nodes.rvs.jog_thread import JoggedRobot
from robomech_ros.nodes.rvs.jogging import Jogger
from robomech_ros.nodes.rvs.messages import motion_from_trajectory, read_marker
from robomech_ros.nodes.rvs.motions import Motions
from robomech_ros.nodes.rvs.settings import RvsSettings
from robomech_ros.nodes.rvs.state_feed import StateFeed
from robomech_ros.nodes.rvs.world_feed import WorldFeed
from robomech_ros.robots.gripper import GripperModel
from robomech_ros.rvs.model.running.live_robot import ViewMarker
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.rvs.layers.live import LiveLayer
    from robomech_ros.rvs.layers.world import WorldLayer

# Markers that are drawn at the most, and points of all of them.
_MOST_MARKERS, _MOST_POINTS = 1000, 100_000
_PLANS = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class RunningRobot(JoggedRobot):
    """Carries out the requests of a page, see ``LiveRobot``, and reports to it."""

    _feed: StateFeed
    _jogger: Jogger

    def __init__(self, node: Node, model: RobotModel, settings: RvsSettings) -> None:
        self._node, self._model, self._settings = node, model, settings
        self._log = ThrottledLog(node.get_logger())
        self._listening: list[Subscription] = []
        self._markers: dict[str, dict[str, ViewMarker]] = {}
        self._world: WorldFeed | None = None

    def begin(self, view: LiveLayer) -> None:
        """Report to this page, from now on."""
        node, model, settings = self._node, self._model, self._settings
        self._view = view
        self._motions = Motions(node, model.commanded.joint_names, settings, view, self._take_plan)
        self.plan, self.execute = self._motions.plan, self._motions.execute
        self.let_plans_wait = self._motions.let_plans_wait
        self._gripper = GripperClient(node, model, settings, view)
        self.move_gripper = self._gripper.move
        self._feed = feed = StateFeed(node, model, settings, view)
        self._jogger = Jogger(node, model, settings, lambda: feed.servo_is_silent, view.show_jog)
        self.hold = self._jogger.hold
        topic = f"{settings.planner}/planned_trajectory"
        node.create_subscription(JointTrajectory, topic, self._take_plan, _PLANS)

    def stop(self) -> None:
        """Stop whatever moves the robot, without waiting for the thread of the node."""
        self._jogger.let_go()
        self._gripper.stop()
        self._motions.stop()

    @property
    def gripper(self) -> GripperModel | None:
        """Its gripper; None if it has none, or none that takes commands."""
        return self._gripper.gripper

    @property
    def gripper_moves(self) -> bool:
        """True if a command to the gripper is under way."""
        return self._gripper.moves

    def follow_world(self, view: WorldLayer) -> None:
        """Send the planning scene to this layer, now and after each change."""
        self._world = WorldFeed(self._node, self._model, view)

    def move_object(self, name: str, pose: Array) -> None:
        """Move an object around the robot to a pose (4, 4) in the base (m)."""
        if self._world is not None:
            self._view.say("world", self._world.move(name, pose))

    def close(self) -> None:
        """Stop following; the node destroys the topics."""
        super().close()
        if self._world is not None:
            self._world.close()

    def want_markers(self, wanted: bool) -> None:
        """Subscribe to markers, or unsubscribe."""
        soon(self._node, lambda: self._listen(wanted))

    def look(self) -> None:
        """Look from time to time whether all is as it was."""
        if self._view.wait_for_viewer(0.0):
            self._motions.look()

    def _take_plan(self, trajectory: JointTrajectory) -> None:
        try:
            self._view.show_plan(
                motion_from_trajectory(self._model, trajectory, self._feed.positions)
            )
        except RobomechError as error:
            self._log.error(f"a planned trajectory cannot be shown: {error}")

    def _listen(self, wanted: bool) -> None:
        for subscription in self._listening:
            self._node.destroy_subscription(subscription)
        self._listening = []
        for number, topic in enumerate(self._settings.marker_topics):
            source = f"markers_{number}"
            self._markers[source] = {}
            self._view.show_markers(source, ())
            if wanted:
                self._listening.append(
                    self._node.create_subscription(
                        MarkerArray,
                        topic,
                        lambda message, source=source: self._take_markers(source, message),
                        LATCHED,
                    )
                )

    def _take_markers(self, source: str, message: MarkerArray) -> None:
        kept = self._markers[source]
        points = sum(len(one.points) for all_ in self._markers.values() for one in all_.values())
        read = 0
        for marker in message.markers:
            name = f"{marker.ns}/{marker.id}"
            if marker.action == Marker.DELETEALL:
                points -= sum(len(one.points) for one in kept.values())
                kept.clear()
                continue
            old = kept.pop(name, None)
            points -= 0 if old is None else len(old.points)
            if marker.action == Marker.DELETE or len(kept) >= _MOST_MARKERS:
                continue
            try:
                read += len(marker.points)
                _check_points(read)
                new = read_marker(self._model, marker)
                _check_points(points + len(new.points))
            except RobomechError as error:
                self._log.error(f"marker '{name}' cannot be shown: {error}")
            else:
                kept[name] = new
                points += len(new.points)
        self._view.show_markers(source, list(kept.values()))


def _check_points(number: int) -> None:
    """Refuse points of all markers together that would hold the page up."""
    if number > _MOST_POINTS:
        raise BadValueError("points of all markers", number, f"{_MOST_POINTS} at most")
