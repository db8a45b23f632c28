"""Parameters of the browser view."""

from dataclasses import dataclass

from robomech_ros.nodes.common.parameters import parameter
from robomech_ros.nodes.common.robot.floating_base import FloatingSettings
from robomech_ros.nodes.common.robot.gripper_names import GripperNames
from robomech_ros.rvs.serving.address import GREATEST_PORT, HOST, PORT


@dataclass(frozen=True)
class RvsSettings(FloatingSettings, GripperNames):
    """Parameters of the node."""

    port: int = parameter(PORT, "Port of the page; 0 = a free port", (0, GREATEST_PORT))
    host: str = parameter(
        HOST,
        "Address on which the page listens; by default only this machine can connect. Everyone "
        "with the printed address of the page can command the robot",
    )
    rate: float = parameter(
        30.0, "Largest display rate of the robot while a browser is connected", (1.0, 60.0, "Hz")
    )
    state_timeout: float = parameter(
        1.0, "Age above which joint states are reported as old", (0.1, 60.0, "s")
    )
    planner: str = parameter("trajectory_planner", "Name of the trajectory planner")
    publisher: str = parameter("trajectory_publisher", "Name of the trajectory publisher")
    controller: str = parameter(
        "joint_trajectory_controller", "Name of the controller; its service hold stops the robot"
    )
    servo: str = parameter("servo", "Name of the servo that jogs the robot")
    mobile_base: str = parameter(
        "mobile_base", "Name of the node of a rolling robot; its topics are displayed and commanded"
    )
    walker: str = parameter(
        "walker", "Name of the node of a walking machine; its topics are displayed and commanded"
    )
    marker_topics: tuple[str, ...] = parameter(
        ("kinematics/markers", "calibration/markers"),
        "Topics of visualization_msgs/MarkerArray that the page can show",
    )
    jog_timeout: float = parameter(
        0.4,
        "Time without a heartbeat before a jogged robot stops; the page sends ten a second while "
        "a jog button is pressed",
        (0.2, 2.0, "s"),
    )
    jog_joint_speed: float = parameter(
        0.5, "Largest jog speed of revolute joints", (1e-3, 10.0, "rad/s")
    )
    jog_linear_speed: float = parameter(
        0.1,
        "Largest jog speed of the tip, of prismatic joints, and over the ground",
        (1e-3, 10.0, "m/s"),
    )
    jog_angular_speed: float = parameter(
        0.5, "Largest angular jog speed of the tip or robot", (1e-3, 10.0, "rad/s")
    )
