"""The node that drives the robot by twists and joint velocities, as they come."""

from contextlib import suppress
from functools import partial
from threading import Thread
from typing import Any

from rclpy.node import Node
from std_srvs.srv import SetBool

from robomech_ros.errors import RobomechError
from robomech_ros.errors.formatting import counted
from robomech_ros.kinetostatics.singularities.generic_rank import scaling_length
from robomech_ros.nodes.common.cooperative_wait import steady_timer
from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.parameters import NodeParameters
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.common.robot.robot_source import when_robot_known
from robomech_ros.nodes.common.services import serve
from robomech_ros.nodes.process.memory import settle_pages
from robomech_ros.nodes.process.run import run_node
from robomech_ros.nodes.servo.driver import Driver
from robomech_ros.nodes.servo.settings import ServoNodeSettings, check_settings, core_settings
from robomech_ros.robots import SerialChain
from robomech_ros.servo.servo import Servo

# How often it is looked whether the robot's length is found (s).
_LOOK = 0.05


class ServoNode(Node):
    """Drives the robot by twists of the tip or joint velocities, within all limits."""

    SETTINGS = ServoNodeSettings
    _driver: Driver | None = None

    def __init__(self, **options: Any) -> None:
        super().__init__("servo", **options)
        self._table = NodeParameters(self, ServoNodeSettings, check=check_settings)
        check_settings(self._table.settings)
        self._motion_clock = MotionClock(self)
        self._monitor = JointStateMonitor(self)
        when_robot_known(self, self._table.settings, self._serve)

    def destroy_node(self) -> None:
        """Destroy the node, and end its thread."""
        if self._driver is not None:
            self._driver.close()
        super().destroy_node()

    def _serve(self, model: RobotModel) -> None:
        """Find the characteristic length, which takes some seconds, while others are served."""
        if self._table.settings.characteristic_length:
            self._drive(model)
            return
        search = Thread(target=_find_length, args=(model.chain,), daemon=True)
        search.start()

        def look() -> None:
            if not search.is_alive():
                timer.cancel()
                self._drive(model)

        timer = steady_timer(self, _LOOK, look)

    def _drive(self, model: RobotModel) -> None:
        settings = self._table.settings
        try:
            servo = Servo(model.chain, core_settings(settings))
        except RobomechError as error:
            # Other nodes that were brought up with this one can do without it.
            self.get_logger().error(f"this robot cannot be driven: {error}")
            return
        self._driver = driver = Driver(
            self, model, servo, self._monitor, self._motion_clock, lambda: self._table.settings
        )
        serve(self, SetBool, "~/pause_servo", self._pause)
        self.get_logger().info(
            f"ready: {model.chain.name}, {counted(model.chain.n, 'joint')}, "
            f"{settings.publish_rate:g} Hz to '{driver.stream.topic}'"
        )
        # The search for the length has loaded more.
        settle_pages()
        driver.wake()

    def _pause(self, request: Any, response: Any) -> Any:
        assert self._driver is not None
        self._driver.pause(bool(request.data))
        response.success = True
        response.message = "paused: brakes and holds" if request.data else "follows commands"
        return response


def _find_length(chain: SerialChain) -> None:
    """Find the length, which is kept; a fault of the chain is reported when it is used."""
    with suppress(RobomechError):
        scaling_length(chain, None)


main = partial(run_node, ServoNode)

if __name__ == "__main__":
    raise SystemExit(main())
