"""Parameters of the servo."""

from dataclasses import dataclass

from robomech_ros.nodes.common.parameters import ParameterError, parameter
from robomech_ros.nodes.common.robot_description import FrameSettings
from robomech_ros.servo.servo import ServoSettings

SPEED_UNITS = "speed_units"
UNITLESS = "unitless"
_DIRECTIONS = ("x", "y", "z", "rx", "ry", "rz")


@dataclass(frozen=True)
class ServoNodeSettings(FrameSettings):
    """Parameters of the node."""

    command_out_topic: str = parameter(
        "joint_trajectory_controller/joint_trajectory",
        "Where the controller listens (trajectory_msgs/JointTrajectory)",
    )
    publish_rate: float = parameter(
        100.0, "How often the stream is continued during motion", 20.0, 1000.0, "Hz"
    )
    command_timeout: float = parameter(
        0.1,
        "How long a command counts without a new one; then the robot brakes",
        0.01,
        1.0,
        "s",
        read_only=False,
    )
    command_in_type: str = parameter(
        SPEED_UNITS,
        "What commands mean: speed_units = rad/s and m/s, unitless = fractions, -1 to 1, of the "
        "three scales below",
        choices=(SPEED_UNITS, UNITLESS),
        read_only=False,
    )
    linear_scale: float = parameter(
        0.4,
        "Linear speed of unitless commands of 1, and towards pose targets",
        1e-6,
        100.0,
        "m/s",
        read_only=False,
    )
    rotational_scale: float = parameter(
        0.8,
        "Angular speed of unitless commands of 1, and towards pose targets",
        1e-6,
        100.0,
        "rad/s",
        read_only=False,
    )
    joint_scale: float = parameter(
        0.5,
        "Largest joint speed of unitless commands, rad/s or m/s",
        1e-6,
        100.0,
        read_only=False,
    )
    free_directions: tuple[str, ...] = parameter(
        (),
        "Components of the tip's pose that twists and pose targets leave to the joints: some of "
        "x, y, z, rx, ry, rz along and about the axes of the tip, such as rz for a tool with an "
        "axis, or rx, ry, rz for positions alone (MoveIt's drift dimensions). Empty = none",
        read_only=False,
    )
    lower_singularity_threshold: float = parameter(
        30.0,
        "Condition number, lengths over the characteristic length, above which motions towards a "
        "singularity are slowed down",
        1.0,
        1e5,
    )
    hard_stop_singularity_threshold: float = parameter(
        90.0, "Condition number at which motions into a singularity stop", 1.0, 1e5
    )
    characteristic_length: float = parameter(
        0.0,
        "Divides linear motions in condition numbers; 0 = that of the robot, computed at the "
        "start in some seconds",
        0.0,
        1e3,
        "m",
    )
    lead: int = parameter(
        2,
        "How many periods ahead of its time a new point is sent: a message may be this late "
        "without disturbing the motion; commands take effect that much later",
        1,
        20,
        "periods",
    )
    longest_lead: int = parameter(
        10,
        "How far the lead rises while points are found to be late, as on a busy machine; it falls "
        "again by a period a second when nothing was late for 10 s. Up to lead = not at all",
        1,
        50,
        "periods",
    )
    tracking_tolerance: float = parameter(
        0.1,
        "How far a joint may be from its commands of the last tracking_delay, rad or m, before "
        "the stream stops; 0 = any distance",
        0.0,
        10.0,
    )
    tracking_delay: float = parameter(
        0.2,
        "How far the joints may lag behind their commands; the stream also stops when joint "
        "states stay away for longer than that and 0.5 s",
        0.0,
        5.0,
        "s",
    )
    halt_messages: int = parameter(
        4,
        "How many messages repeat the plan to stop when there is no command any more; then others "
        "can move the robot",
        1,
        1000,
        "messages",
    )

    @property
    def task_mask(self) -> tuple[bool, ...]:
        """Which components of the pose are held, as `Servo.hold` takes them."""
        return tuple(name not in self.free_directions for name in _DIRECTIONS)


def check_settings(settings: ServoNodeSettings) -> None:
    """Refuse what does not fit together.

    Raises
    ------
    ParameterError
    """
    slow, stop = settings.lower_singularity_threshold, settings.hard_stop_singularity_threshold
    if not slow < stop:
        allowed = f"less than hard_stop_singularity_threshold, {stop:g}"
        raise ParameterError("lower_singularity_threshold", slow, allowed)
    free = settings.free_directions
    if not set(free) < set(_DIRECTIONS):
        allowed = f"at most five of {', '.join(_DIRECTIONS)}"
        raise ParameterError("free_directions", free, allowed)


def longest_lead(settings: ServoNodeSettings) -> int:
    """Return how many periods the stream may be ahead at most."""
    return max(settings.lead, settings.longest_lead)


def core_settings(settings: ServoNodeSettings) -> ServoSettings:
    """Pick what the core needs."""
    return ServoSettings(
        period=1.0 / settings.publish_rate,
        slow_from=settings.lower_singularity_threshold,
        stop_at=settings.hard_stop_singularity_threshold,
        length=settings.characteristic_length or None,
        lead=longest_lead(settings),
    )
