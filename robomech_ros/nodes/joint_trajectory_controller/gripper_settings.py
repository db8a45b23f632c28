"""Parameters of the gripper of the simulated robot."""

from dataclasses import dataclass

from robomech_ros.nodes.common.gripper_names import GripperNames
from robomech_ros.nodes.common.parameters import parameter


@dataclass(frozen=True)
class GripperSettings(GripperNames):
    """Names as of ros2_control's gripper controllers, with ``gripper_`` before them."""

    parallel_gripper_controller: str = parameter(
        "parallel_gripper_controller",
        "Name below which it has gripper_cmd as a ParallelGripperCommand; another than "
        "gripper_controller",
    )
    gripper_goal_tolerance: float = parameter(
        0.01, "How far a finger joint may be from its goal that has reached it, rad or m", 0.0, 10.0
    )
    gripper_allow_stalling: bool = parameter(
        False,
        "Whether gripper_cmd succeeds where something between the fingers stops them",
        read_only=False,
    )
    gripper_stall_velocity_threshold: float = parameter(
        0.001, "Speed up to which a finger joint stands, rad/s or m/s", 0.0, 10.0
    )
    gripper_stall_timeout: float = parameter(
        1.0, "How long fingers stand before they have stalled", 0.0, 60.0, "s"
    )
    gripper_max_effort: float = parameter(
        0.0,
        "The most that a finger joint exerts, N m or N; 0 = its effort limit",
        0.0,
        1e6,
    )
    gripper_max_velocity: float = parameter(
        0.0,
        "How fast gripper_cmd moves a finger joint, rad/s or m/s; 0 = as fast as its limit allows",
        0.0,
        1e3,
    )
    gripper_object_width: float = parameter(
        0.0,
        "Simulated object between the fingers: its width, where it stops fingers that close; "
        "0 = nothing",
        0.0,
        10.0,
        "m",
        read_only=False,
    )
