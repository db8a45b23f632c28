"""Parameters of the browser view."""

from dataclasses import dataclass

from robomech_ros.nodes.common.gripper_names import GripperNames
from robomech_ros.nodes.common.parameters import parameter
from robomech_ros.rvs.serving.address import GREATEST_PORT, HOST, PORT


@dataclass(frozen=True)
class RvsSettings(GripperNames):
    """Parameters of the node."""

    port: int = parameter(PORT, "Port of the page; 0 = a free one", 0, GREATEST_PORT)
    host: str = parameter(
        HOST,
        "Address of this machine that the page listens on; by default only this machine reaches "
        "it. Whoever has the printed address of the page may command the robot",
    )
    rate: float = parameter(
        30.0,
        "How often the robot is drawn at most, while somebody looks",
        1.0,
        60.0,
        "Hz",
    )
    state_timeout: float = parameter(
        1.0, "Age from which on joint states are called old", 0.1, 60.0, "s"
    )
    planner: str = parameter("trajectory_planner", "Name of the trajectory planner")
    publisher: str = parameter("trajectory_publisher", "Name of the trajectory publisher")
    controller: str = parameter(
        "joint_trajectory_controller", "Name of the controller, whose service hold stops the robot"
    )
    servo: str = parameter("servo", "Name of the servo, by which the robot is jogged")
    mobile_base: str = parameter(
        "mobile_base", "Name of the node of a rolling robot, whose topics are shown and commanded"
    )
    walker: str = parameter(
        "walker", "Name of the node of a walking machine, whose topics are shown and commanded"
    )
    marker_topics: tuple[str, ...] = parameter(
        ("kinematics/markers", "calibration/markers"),
        "Topics of visualization_msgs/MarkerArray that the page shows where that is wanted",
    )
    jog_silence: float = parameter(
        0.4,
        "How long a page that holds a jog button may say nothing before the robot is stopped; it "
        "says so ten times a second",
        0.2,
        2.0,
        "s",
    )
    jog_joint_speed: float = parameter(
        0.5, "Greatest jogging speed of joints that turn", 1e-3, 10.0, "rad/s"
    )
    jog_linear_speed: float = parameter(
        0.1,
        "Greatest jogging speed of the tip, of joints that slide, and over the ground",
        1e-3,
        10.0,
        "m/s",
    )
    jog_angular_speed: float = parameter(
        0.5, "Greatest speed at which tip or robot are turned by jogging", 1e-3, 10.0, "rad/s"
    )
