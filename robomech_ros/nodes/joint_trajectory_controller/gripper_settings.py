"""Parameters of the gripper of the simulated robot."""

from dataclasses import dataclass

from robomech_ros.nodes.common.gripper_names import GripperNames
from robomech_ros.nodes.common.parameters import changeable, parameter


@dataclass(frozen=True)
class GripperSettings(GripperNames):
    """Names as of ros2_control's gripper controllers, with ``gripper_`` before them."""

    parallel_gripper_controller: str = parameter(
        "parallel_gripper_controller",
        "Name before /gripper_cmd (ParallelGripperCommand); must differ from gripper_controller",
    )
    gripper_goal_tolerance: float = parameter(
        0.01,
        "Largest distance from the goal of a finger joint that has reached it, rad or m",
        (0.0, 10.0),
    )
    gripper_allow_stalling: bool = changeable(
        False, "gripper_cmd succeeds if an object between the fingers stops them"
    )
    gripper_stall_velocity_threshold: float = parameter(
        0.001, "Largest speed of a finger joint at rest, rad/s or m/s", (0.0, 10.0)
    )
    gripper_stall_timeout: float = parameter(
        1.0, "Time at rest after which the fingers count as stalled", (0.0, 60.0, "s")
    )
    gripper_max_effort: float = parameter(
        0.0, "Largest effort of a finger joint, N m or N; 0 = its effort limit", (0.0, 1e6)
    )
    gripper_max_velocity: float = parameter(
        0.0,
        "Speed of a finger joint during gripper_cmd, rad/s or m/s; 0 = as its limit allows",
        (0.0, 1e3),
    )
    gripper_object_width: float = changeable(
        0.0,
        "Width of a simulated object that stops closing fingers; 0 = no object",
        (0.0, 10.0, "m"),
    )
