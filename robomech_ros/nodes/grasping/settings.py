"""Parameters of the node grasping."""

from dataclasses import dataclass

from robomech_ros.nodes.common.parameters import ParameterError, parameter


@dataclass(frozen=True)
class GraspingSettings:
    """Parameters of the node."""

    robot_description: str = parameter(
        "",
        "The hand: its name in config/robots/hands, or the path or the text of its YAML. Empty = "
        "none: contacts alone are analysed",
    )
    frame_prefix: str = parameter(
        "", "What the names of the hand's frames begin with in headers, such as left/"
    )
    most_points: int = parameter(
        2000,
        "Wrenches after which the bounds of a quality are given as they are",
        10,
        5000,
        read_only=False,
    )
    longest_wait: float = parameter(
        30.0,
        "How long analyze_grasp waits for requests that came before; then it refuses, with 205",
        1e-9,
        1e6,
        "s",
        read_only=False,
    )


def check_settings(settings: GraspingSettings) -> None:
    """Refuse a prefix that tf does not allow.

    Raises
    ------
    ParameterError
    """
    if settings.frame_prefix.startswith("/"):
        expected = "a text without a slash in front, such as left/: tf has no such frames"
        raise ParameterError("frame_prefix", settings.frame_prefix, expected)
