"""Parameters of the simulated robot."""

from dataclasses import dataclass

import numpy as np

from robomech_ros.execution.controller.follower_settings import FollowerSettings
from robomech_ros.nodes.common.parameters import ParameterError, parameter
from robomech_ros.nodes.display.robot_display import ALWAYS, AUTO, NEVER
from robomech_ros.nodes.joint_trajectory_controller.gripper_settings import GripperSettings
from robomech_ros.trajectory.limits import Limits
from robomech_ros.typing import Array

KINEMATIC, DYNAMIC = "kinematic", "dynamic"
SPLINES, NO_INTERPOLATION = "splines", "none"


@dataclass(frozen=True)
class ControllerSettings(GripperSettings):
    """Parameters of the node."""

    publish_rate: float = parameter(
        100.0, "How often the robot moves and joint_states is published", 1.0, 1000.0, "Hz"
    )
    action_monitor_rate: float = parameter(
        20.0, "How often an action gets feedback; at most publish_rate", 0.1, 1000.0, "Hz"
    )
    state_publish_rate: float = parameter(
        50.0, "How often controller_state is published; at most publish_rate", 0.1, 1000.0, "Hz"
    )
    initial_positions: tuple[float, ...] = parameter(
        (),
        "Where the joints are at start and after a reset, base to tip, rad or m; of a parallel "
        "robot its drives, or all joints. Empty = the robot's home, else the middle of their "
        "limits, 0 for joints without",
    )
    start_tolerance: float = parameter(
        0.01,
        "How far the first point of a trajectory, at time 0, may be from the present position of "
        "a joint at rest, rad or m",
        0.0,
        10.0,
    )
    path_tolerance: float = parameter(
        0.0,
        "How far a joint may be from its path while moving, rad or m; 0 = any distance",
        0.0,
        10.0,
        read_only=False,
    )
    goal_tolerance: float = parameter(
        0.01,
        "How far a joint may be from the last point at the end, rad or m; 0 = any distance",
        0.0,
        10.0,
        read_only=False,
    )
    stopped_velocity_tolerance: float = parameter(
        0.01,
        "How fast a joint may be at the end, rad/s or m/s; 0 = any speed",
        0.0,
        10.0,
        read_only=False,
    )
    goal_time: float = parameter(
        1.0,
        "How long after its end a trajectory may still reach its goal; 0 = any time",
        0.0,
        3600.0,
        "s",
        read_only=False,
    )
    cmd_timeout: float = parameter(
        0.0,
        "How long after its end a trajectory may last at all; then the robot holds. 0 = any time",
        0.0,
        3600.0,
        "s",
    )
    allow_partial_joints_goal: bool = parameter(
        False, "Whether a trajectory may name only some of the joints; the others hold"
    )
    allow_trajectory_replacement: bool = parameter(
        True,
        "Whether the present motion continues until the stamp of a new trajectory; otherwise the "
        "new one takes over on arrival, and the robot moves to its first point until then",
    )
    interpolation_method: str = parameter(
        SPLINES,
        "How the joints get from point to point: splines = linearly, by cubics or quintics, as "
        "the fields of the points allow; none = commanded one point at a time",
        choices=(SPLINES, NO_INTERPOLATION),
    )
    allow_nonzero_velocity_at_trajectory_end: bool = parameter(
        False,
        "Whether a trajectory may end moving; the robot then brakes beyond its last point",
    )
    max_acceleration_ratio: float = parameter(
        5.0,
        "How many times its acceleration limit a joint may accelerate on the curve through points "
        "with velocities, which is refused beyond that; 0 = any. From 1 on the log says so",
        0.0,
        1e6,
    )
    max_points: int = parameter(
        10_000, "Most points of a trajectory; longer ones are refused", 1, 1_000_000, "points"
    )
    max_duration: float = parameter(
        3600.0,
        "Longest trajectory, and longest wait until one begins; longer ones are refused",
        0.001,
        1e6,
        "s",
    )
    simulation: str = parameter(
        KINEMATIC,
        "How the robot is simulated: kinematic = the joints follow exactly, or with tracking_lag; "
        "dynamic = drives move them, with mass, friction and effort limits",
        choices=(KINEMATIC, DYNAMIC),
    )
    dynamic_control: str = parameter(
        "computed-torque",
        "Dynamic: the controller of the drives: computed-torque, or pd-gravity = PD with gravity "
        "compensation",
        choices=("computed-torque", "pd-gravity"),
    )
    dynamic_bandwidth: float = parameter(
        50.0, "Dynamic: natural frequency with which errors decay", 1.0, 200.0, "rad/s"
    )
    dynamic_damping: float = parameter(
        1.0, "Dynamic: damping ratio with which errors decay; 1 = critical", 0.1, 2.0
    )
    dynamic_observer: float = parameter(
        2000.0,
        "Dynamic: rate of the observer that compensates efforts which the model does not explain, "
        "such as those of a payload; 0 = off",
        0.0,
        10_000.0,
        "rad/s",
    )
    gravity: tuple[float, ...] = parameter(
        (0.0, 0.0, -9.81),
        "Dynamic: acceleration of gravity in the base link of the chain, pointing where things "
        "fall",
        -1000.0,
        1000.0,
        "m/s^2",
    )
    payload_mass: float = parameter(
        0.0,
        "Dynamic: mass at the tip, unknown to the controller of the drives",
        0.0,
        1000.0,
        "kg",
        read_only=False,
    )
    payload_com: tuple[float, ...] = parameter(
        (0.0, 0.0, 0.0),
        "Dynamic: where that mass is, as a point in the frame of the tip",
        -10.0,
        10.0,
        "m",
        read_only=False,
    )
    tracking_lag: float = parameter(
        0.0,
        "Kinematic: time constant with which the joints follow their commands; 0 = exactly",
        0.0,
        100.0,
        "s",
    )
    publish_frames: str = parameter(
        AUTO,
        "Whether /tf and /tf_static are published, where tf2_msgs is installed; auto = those "
        "frames of the robot that nobody else publishes",
        choices=(AUTO, ALWAYS, NEVER),
    )
    frame_rate: float = parameter(
        20.0, "How often /tf is published; at most publish_rate", 0.1, 1000.0, "Hz"
    )
    publish_description: bool = parameter(
        True,
        "Whether the robot of the parameter robot_description is published as a URDF on the "
        "latched topic robot_description, and the SRDF of robot_description_semantic on the topic "
        "of that name, each unless somebody else publishes one",
    )
    fault_stuck_joints: str = parameter(
        "",
        "Simulated fault: joints that do not move, names with commas between. Empty = none",
        read_only=False,
    )
    fault_delay: float = parameter(
        0.0,
        "Simulated fault: how long commands take to reach the joints",
        0.0,
        10.0,
        "s",
        read_only=False,
    )
    fault_dropped_commands: float = parameter(
        0.0,
        "Simulated fault: fraction of the commands that get lost; joints then keep the previous "
        "one",
        0.0,
        1.0,
        read_only=False,
    )
    fault_offset: tuple[float, ...] = parameter(
        (),
        "Simulated fault: offset that the joint sensors add, base to tip, rad or m. Empty = none",
        -10.0,
        10.0,
        read_only=False,
    )
    fault_noise: float = parameter(
        0.0,
        "Simulated fault: standard deviation of the noise on measured positions, rad or m",
        0.0,
        1.0,
        read_only=False,
    )
    fault_seed: int = parameter(
        0,
        "Seed of the noise, and of the choice of lost commands",
        0,
        2**31 - 1,
        read_only=False,
    )


def check_simulation(settings: ControllerSettings) -> None:
    """Check that parameters of the simulation go together.

    Raises
    ------
    ParameterError
        One belongs to the other kind of simulation, or a vector does not have three numbers.
    """
    other = "tracking_lag" if settings.simulation == DYNAMIC else "payload_mass"
    value = getattr(settings, other)
    if value:
        raise ParameterError(other, value, f"0 with simulation: {settings.simulation}")
    for name in ("gravity", "payload_com"):
        vector = getattr(settings, name)
        if len(vector) != 3:
            raise ParameterError(name, list(vector), "a list of 3 numbers: x, y, z")


def follower_settings(settings: ControllerSettings) -> FollowerSettings:
    """Pick what the follower needs."""
    return FollowerSettings(
        start_tolerance=settings.start_tolerance,
        longest_wait=settings.max_duration,
        command_timeout=settings.cmd_timeout,
        interpolate=settings.interpolation_method == SPLINES,
        wait_for_stamp=settings.allow_trajectory_replacement,
        max_acceleration_ratio=settings.max_acceleration_ratio,
    )


def initial_position(settings: ControllerSettings, limits: Limits, home: Array) -> Array:
    """Return the initial position (rad or m), shape (n,): that of the parameter, else home.

    Raises
    ------
    ParameterError
        The parameter does not have one position for every joint, or one is outside its limits.
    """
    given = settings.initial_positions
    if not given:
        return home
    position, names = np.array(given), limits.joint_names
    if len(position) != len(names):
        allowed = f"a list of {len(names)} numbers, for {', '.join(names)}, or empty"
        raise ParameterError("initial_positions", list(given), allowed)
    for joint, value, low, high, unit in zip(
        names, given, limits.lower, limits.upper, limits.units, strict=True
    ):
        if not low <= value <= high:
            allowed = f"from {low:.6g} to {high:.6g} {unit} for joint '{joint}'"
            raise ParameterError("initial_positions", value, allowed)
    return position
