"""Parameters of the node calibration."""

import re
from dataclasses import dataclass

from robomech_ros.nodes.common.parameters import ParameterError, changeable, parameter
from robomech_ros.nodes.common.robot.robot_description import RobotSettings

# Types of calibrations as easy_handeye2 calls them, and the library's names for them.
MOUNT_OF_TYPE = {"eye_in_hand": "eye-in-hand", "eye_on_base": "eye-to-hand"}
# How long a request for a sample may wait, s.
LONGEST_WAIT = 60.0
_PLAIN = re.compile(r"[A-Za-z0-9_-][A-Za-z0-9._-]{0,99}")


@dataclass(frozen=True)
class CalibrationSettings(RobotSettings):
    """Parameters of the node; type, frames and name are those of easy_handeye2."""

    calibration_type: str = changeable(
        "eye_in_hand",
        "Sensor mount: eye_in_hand = the sensor moves with the hand and the target is fixed; "
        "eye_on_base = the sensor is fixed and the target moves with the hand",
        choices=tuple(MOUNT_OF_TYPE),
    )
    robot_base_frame: str = parameter(
        "", "Frame in which poses of the hand are measured. Empty = base of the chain"
    )
    robot_effector_frame: str = parameter("", "Frame of the robot's hand. Empty = tip of the chain")
    tracking_base_frame: str = parameter(
        "",
        "Frame of the sensor to calibrate. Empty = frame of the poses on tracking_topic; without "
        "that topic no sample can be taken",
    )
    tracking_marker_frame: str = parameter(
        "", "Frame of the target on tf; not needed with tracking_topic"
    )
    robot_topic: str = parameter(
        "", "Topic of geometry_msgs/PoseStamped with the hand in robot_base_frame. Empty = from tf"
    )
    tracking_topic: str = parameter(
        "",
        "Topic of geometry_msgs/PoseStamped with the target in tracking_base_frame. Empty = from "
        "tf",
    )
    sample_timeout: float = changeable(
        3.0,
        "Longest wait of take_sample for a stationary robot and a new detection; other requests "
        "are served meanwhile",
        (0.0, LONGEST_WAIT, "s"),
    )
    still_time: float = changeable(
        0.3, "Time that the robot must be at rest before a sample", (0.0, 5.0, "s")
    )
    still_distance: float = changeable(
        5e-4, "Largest translation of the hand in that time", (0.0, 1.0, "m")
    )
    still_angle: float = changeable(
        2e-3, "Largest rotation of the hand in that time", (0.0, 3.2, "rad")
    )
    max_samples: int = changeable(500, "Largest number of samples", (3, 2000, "samples"))
    name: str = parameter("calibration", "File name of save, for requests without one")
    folder: str = parameter(
        "~/.ros/robomech_ros/calibrations",
        "Folder of saved calibrations, created if missing; no request can change it. "
        "easy_handeye2 reads ~/.ros2/easy_handeye2/calibrations. Empty = nothing is saved",
    )
    saved: str = parameter(
        "", "Calibration in folder to publish on /tf_static at startup. Empty = none"
    )


def check_settings(settings: CalibrationSettings) -> None:
    """Refuse a name that is not the plain name of a file."""
    if not is_plain_name(settings.name):
        raise ParameterError("name", settings.name, "letters, digits, '_', '-' and '.'")


def is_plain_name(name: str) -> bool:
    """Return whether this is the name of a file that is in no other folder and not hidden."""
    return _PLAIN.fullmatch(name) is not None
