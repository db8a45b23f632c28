"""Parameters of the node grasping."""

from dataclasses import dataclass

from robomech_ros.nodes.common.parameters import changeable, parameter
from robomech_ros.nodes.common.robot.robot_description import check_frame_prefix


@dataclass(frozen=True)
class GraspingSettings:
    """Parameters of the node."""

    robot_description: str = parameter(
        "",
        "Hand: name in config/robots/hands, or path or text of its YAML. Empty = none: only "
        "contacts are analysed",
    )
    frame_prefix: str = parameter("", "Prefix of the hand's frames in headers, such as left/")
    max_wrenches: int = changeable(
        2000,
        "Largest number of wrenches used for the quality bounds; then these are returned as they "
        "are",
        (10, 5000),
    )
    max_queue_time: float = changeable(
        30.0,
        "Longest wait of analyze_grasp for earlier requests; then it fails with code 205",
        (1e-9, 1e6, "s"),
    )


def check_settings(settings: GraspingSettings) -> None:
    """Refuse a prefix that tf does not allow."""
    check_frame_prefix(settings.frame_prefix)
