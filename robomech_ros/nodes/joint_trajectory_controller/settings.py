"""Parameters of the simulated robot."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors.formatting import counted
from robomech_ros.execution.controller.follower_settings import FollowerSettings
from robomech_ros.execution.controller.simulated_joints import Faults
from robomech_ros.nodes.common.parameters import ParameterError, changeable, parameter
from robomech_ros.nodes.common.robot.floating_base import FloatingSettings, check_momentum
from robomech_ros.nodes.common.robot.gripper_names import GripperNames, listed_names
from robomech_ros.nodes.display.robot_display import ALWAYS, AUTO, NEVER
from robomech_ros.trajectory.limits import Limits
from robomech_ros.typing import Array

KINEMATIC, DYNAMIC = "kinematic", "dynamic"
SPLINES, NO_INTERPOLATION = "splines", "none"


@dataclass(frozen=True)
class ControllerSettings(FloatingSettings, GripperNames):
    """Parameters of the node.

    Those of the gripper have names as of ros2_control's gripper controllers, with ``gripper_``
    before them.
    """

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
    publish_rate: float = parameter(
        100.0, "Rate of the simulated motion and of joint_states", (1.0, 1000.0, "Hz")
    )
    action_monitor_rate: float = parameter(
        20.0, "Rate of action feedback; at most publish_rate", (0.1, 1000.0, "Hz")
    )
    state_publish_rate: float = parameter(
        50.0, "Rate of controller_state; at most publish_rate", (0.1, 1000.0, "Hz")
    )
    walk_efforts_topic: str = parameter(
        "walker/joint_efforts",
        "Walking machines: topic of the joint torques that joint_states shows; empty = none",
    )
    initial_positions: tuple[float, ...] = parameter(
        (),
        "Joint positions at startup and after a reset, base to tip, rad or m; for a parallel "
        "robot its drives, or all joints. Empty = the robot's home, else the middle of the "
        "limits, 0 for joints without limits",
    )
    start_tolerance: float = parameter(
        0.01,
        "Largest distance of a trajectory's first point, at time 0, from the current position of "
        "a joint at rest, rad or m",
        (0.0, 10.0),
    )
    path_tolerance: float = changeable(
        0.0,
        "Largest deviation of a joint from its path while moving, rad or m; 0 = any distance",
        (0.0, 10.0),
    )
    goal_tolerance: float = changeable(
        0.01,
        "Largest deviation of a joint from the last point at the end, rad or m; 0 = any distance",
        (0.0, 10.0),
    )
    stopped_velocity_tolerance: float = changeable(
        0.01, "Largest joint speed at the end, rad/s or m/s; 0 = any speed", (0.0, 10.0)
    )
    goal_time: float = changeable(
        1.0,
        "Time after its end in which a trajectory may still reach its goal; 0 = any time",
        (0.0, 3600.0, "s"),
    )
    cmd_timeout: float = parameter(
        0.0,
        "Longest time after its end that a trajectory may last; then the robot holds. 0 = any time",
        (0.0, 3600.0, "s"),
    )
    allow_partial_joints_goal: bool = parameter(
        False, "Accept trajectories that name only some of the joints; the others hold"
    )
    allow_trajectory_replacement: bool = parameter(
        True,
        "Continue the current motion until the time stamp of a new trajectory. False: the new one "
        "replaces it on arrival, and the robot moves to its first point until then",
    )
    interpolation_method: str = parameter(
        SPLINES,
        "Interpolation between points: splines = linear, cubic or quintic, depending on the "
        "fields of the points; none = one point at a time",
        choices=(SPLINES, NO_INTERPOLATION),
    )
    allow_nonzero_velocity_at_trajectory_end: bool = parameter(
        False, "Accept trajectories that end in motion; the robot then brakes beyond the last point"
    )
    max_acceleration_ratio: float = parameter(
        5.0,
        "Largest ratio of acceleration to its limit on the curve through points with velocities; "
        "trajectories beyond it are rejected. 0 = any. Ratios from 1 on are logged",
        (0.0, 1e6),
    )
    max_points: int = parameter(
        10_000,
        "Largest number of points; longer trajectories are rejected",
        (1, 1_000_000, "points"),
    )
    max_duration: float = parameter(
        3600.0,
        "Longest trajectory, and longest wait for its start; longer ones are rejected",
        (0.001, 1e6, "s"),
    )
    simulation: str = parameter(
        KINEMATIC,
        "Simulation model: kinematic = the joints follow exactly, or with tracking_lag; dynamic = "
        "drives move them, with mass, friction and effort limits",
        choices=(KINEMATIC, DYNAMIC),
    )
    dynamic_control: str = parameter(
        "computed-torque",
        "Dynamic: drive controller: computed-torque, or pd-gravity = PD with gravity compensation",
        choices=("computed-torque", "pd-gravity"),
    )
    dynamic_bandwidth: float = parameter(
        50.0, "Dynamic: natural frequency of the error decay", (1.0, 200.0, "rad/s")
    )
    dynamic_damping: float = parameter(
        1.0, "Dynamic: damping ratio of the error decay; 1 = critical", (0.1, 2.0)
    )
    dynamic_observer: float = parameter(
        2000.0,
        "Dynamic: rate of the observer that compensates unmodelled efforts, such as those of a "
        "payload; 0 = off",
        (0.0, 10_000.0, "rad/s"),
    )
    gravity: tuple[float, ...] = parameter(
        (0.0, 0.0, -9.81),
        "Dynamic: gravity vector (down) in the base link of the chain",
        (-1000.0, 1000.0, "m/s^2"),
    )
    payload_mass: float = changeable(
        0.0,
        "Dynamic: mass at the tip that the drive controller does not know. Floating base: mass "
        "that the tip has captured",
        (0.0, 1000.0, "kg"),
    )
    payload_com: tuple[float, ...] = changeable(
        (0.0, 0.0, 0.0), "Position of that mass in the frame of the tip", (-10.0, 10.0, "m")
    )
    payload_velocity: tuple[float, ...] = changeable(
        (0.0, 0.0, 0.0),
        "Floating base: velocity of that mass before it was captured, in the inertial frame",
        (-1000.0, 1000.0, "m/s"),
    )
    momentum: tuple[float, ...] = parameter(
        (),
        "Floating base: momentum of the whole robot at startup and after a reset, in the inertial "
        "frame: angular about the mass centre (N m s), then linear (N s). Empty = zero",
        (-1e9, 1e9),
    )
    odom_frame_id: str = parameter(
        "odom", "Floating base: inertial frame of odom and /tf, where the base is at startup"
    )
    tracking_lag: float = parameter(
        0.0,
        "Kinematic: time constant of the joints behind their commands; 0 = none",
        (0.0, 100.0, "s"),
    )
    publish_frames: str = parameter(
        AUTO,
        "Publication of /tf and /tf_static, if tf2_msgs is installed; auto = frames of the robot "
        "without another publisher",
        choices=(AUTO, ALWAYS, NEVER),
    )
    frame_rate: float = parameter(20.0, "Rate of /tf; at most publish_rate", (0.1, 1000.0, "Hz"))
    publish_description: bool = parameter(
        True,
        "Publish the robot of the parameter robot_description as a URDF on the latched topic "
        "robot_description, and the SRDF of robot_description_semantic on the topic of that name. "
        "Each is published only without another publisher",
    )
    fault_stuck_joints: str = changeable(
        "", "Simulated fault: joints that do not move, separated by commas. Empty = none"
    )
    fault_delay: float = changeable(
        0.0, "Simulated fault: delay of the commands to the joints", (0.0, 10.0, "s")
    )
    fault_dropped_commands: float = changeable(
        0.0,
        "Simulated fault: fraction of lost commands; joints then keep the previous one",
        (0.0, 1.0),
    )
    fault_offset: tuple[float, ...] = changeable(
        (),
        "Simulated fault: offset of the joint sensors, base to tip, rad or m. Empty = none",
        (-10.0, 10.0),
    )
    fault_noise: float = changeable(
        0.0,
        "Simulated fault: standard deviation of the noise on measured positions, rad or m",
        (0.0, 1.0),
    )
    fault_seed: int = changeable(
        0, "Seed of the noise, and of the choice of lost commands", (0, 2**31 - 1)
    )


def check_simulation(
    settings: ControllerSettings, floating: bool = False, why_kinematic: str = ""
) -> None:
    """Check that parameters of the simulation go together.

    - ``why_kinematic``: why the robot has no dynamic simulation; empty if it has one.

    Raises ParameterError: one belongs to the other kind of simulation, or a vector does not have
    three numbers.
    """
    other = "tracking_lag" if settings.simulation == DYNAMIC else "payload_mass"
    value = getattr(settings, other)
    if value and not floating:
        raise ParameterError(other, value, f"0 with simulation: {settings.simulation}")
    if why_kinematic and settings.simulation != KINEMATIC:
        raise ParameterError("simulation", settings.simulation, f"{KINEMATIC}: {why_kinematic}")
    check_momentum(settings.momentum)
    for name in ("momentum", "payload_velocity"):
        if not floating and any(getattr(settings, name)):
            allowed = "zero or empty: the base of the robot does not float"
            raise ParameterError(name, list(getattr(settings, name)), allowed)
    for name in ("gravity", "payload_com", "payload_velocity"):
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

    Raises ParameterError: the parameter does not have one position for every joint, or one is
    outside its limits.
    """
    given = settings.initial_positions
    if not given:
        return home
    position, names = np.array(given), limits.joint_names
    if len(position) != len(names):
        allowed = f"a list of {counted(len(names), 'number')}, for {', '.join(names)}, or empty"
        raise ParameterError("initial_positions", list(given), allowed)
    for joint, value, low, high, unit in zip(
        names, given, limits.lower, limits.upper, limits.units, strict=True
    ):
        if not low <= value <= high:
            allowed = f"from {low:.6g} to {high:.6g} {unit} for joint '{joint}'"
            raise ParameterError("initial_positions", value, allowed)
    return position


def faults_of(
    settings: ControllerSettings, joint_names: Sequence[str], others: Sequence[str] = ()
) -> Faults:
    """Read the faults of the joints of a robot; its fingers may be stuck, too.

    Raises ParameterError: a joint that the robot does not have, or not one offset for every joint.
    """
    names = list(joint_names)
    stuck = listed_names(settings.fault_stuck_joints)
    for name in stuck:
        if name not in names and name not in others:
            allowed = f"names with commas between, of {', '.join((*names, *others))}"
            raise ParameterError("fault_stuck_joints", settings.fault_stuck_joints, allowed)
    offset = settings.fault_offset
    if offset and len(offset) != len(names):
        allowed = f"a list of {counted(len(names), 'number')}, for {', '.join(names)}, or empty"
        raise ParameterError("fault_offset", list(offset), allowed)
    return Faults(
        stuck=np.isin(names, stuck),
        offset=np.array(offset) if offset else np.zeros(len(names)),
        delay=settings.fault_delay,
        dropped=settings.fault_dropped_commands,
        noise=settings.fault_noise,
        seed=settings.fault_seed,
    )
