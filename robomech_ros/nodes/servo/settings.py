"""Parameters of the servo."""

from dataclasses import dataclass

from robomech_ros.nodes.common.joints.tracking_monitor import StreamSettings
from robomech_ros.nodes.common.parameters import ParameterError, changeable, parameter
from robomech_ros.nodes.common.robot.robot_description import FrameSettings
from robomech_ros.servo.servo import ServoSettings

SPEED_UNITS = "speed_units"
UNITLESS = "unitless"
_DIRECTIONS = ("x", "y", "z", "rx", "ry", "rz")


@dataclass(frozen=True)
class ServoNodeSettings(StreamSettings, FrameSettings):
    """Parameters of the node."""

    publish_rate: float = parameter(
        100.0, "Rate of trajectory messages during motion", (20.0, 1000.0, "Hz")
    )
    command_timeout: float = changeable(
        0.1, "Command timeout; the robot then brakes", (0.01, 1.0, "s")
    )
    command_in_type: str = changeable(
        SPEED_UNITS,
        "Units of commands: speed_units = rad/s and m/s, unitless = fractions of the three scales "
        "below, -1 to 1",
        choices=(SPEED_UNITS, UNITLESS),
    )
    linear_scale: float = changeable(
        0.4,
        "Linear speed of unitless commands of 1, and towards pose targets",
        (1e-6, 100.0, "m/s"),
    )
    rotational_scale: float = changeable(
        0.8,
        "Angular speed of unitless commands of 1, and towards pose targets",
        (1e-6, 100.0, "rad/s"),
    )
    joint_scale: float = changeable(
        0.5, "Largest joint speed of unitless commands, rad/s or m/s", (1e-6, 100.0)
    )
    free_directions: tuple[str, ...] = changeable(
        (),
        "Components of the tip's pose that twists and pose targets leave free: some of x, y, z, "
        "rx, ry, rz, along and about the axes of the tip. Examples: rz for a tool with an axis; "
        "rx, ry, rz for positions alone (MoveIt's drift dimensions). Empty = none",
    )
    lower_singularity_threshold: float = parameter(
        30.0,
        "Condition number (lengths divided by the characteristic length) above which motions "
        "towards a singularity are slowed down",
        (1.0, 1e5),
    )
    hard_stop_singularity_threshold: float = parameter(
        90.0, "Condition number at which motions into a singularity stop", (1.0, 1e5)
    )
    check_collisions: bool = changeable(
        True,
        "With a planning scene on monitored_planning_scene, slow down before contact and stop; "
        "false = ignore the scene",
    )
    self_collision_proximity_threshold: float = parameter(
        0.01,
        "Distance within which motion towards contact of two links is slowed down",
        (0.0, 1.0, "m"),
    )
    scene_collision_proximity_threshold: float = parameter(
        0.02,
        "Distance within which motion towards contact with an object is slowed down",
        (0.0, 1.0, "m"),
    )
    padding: float = parameter(
        0.001, "Distance from objects at which motion towards them ends", (0.0, 1.0, "m")
    )
    characteristic_length: float = parameter(
        0.0,
        "Length that divides linear motions in condition numbers; 0 = that of the robot, computed "
        "at startup in a few seconds",
        (0.0, 1e3, "m"),
    )
    lead: int = parameter(
        2,
        "Number of periods by which a point is sent ahead of its time. A message may be this late "
        "without disturbing the motion; commands take effect that much later",
        (1, 20, "periods"),
    )
    max_lead: int = parameter(
        10,
        "Largest lead while points are late, as on a busy machine. It falls by one period a "
        "second after 10 s without late points. Values up to lead = constant lead",
        (1, 50, "periods"),
    )
    halt_messages: int = parameter(
        4,
        "Number of stop messages after the last command; then other nodes can move the robot",
        (1, 1000, "messages"),
    )

    @property
    def task_mask(self) -> tuple[bool, ...]:
        """Held components of the pose, as for `Servo.hold`."""
        return tuple(name not in self.free_directions for name in _DIRECTIONS)


def check_settings(settings: ServoNodeSettings) -> None:
    """Raise ParameterError for what does not fit together."""
    slow, stop = settings.lower_singularity_threshold, settings.hard_stop_singularity_threshold
    if not slow < stop:
        allowed = f"less than hard_stop_singularity_threshold, {stop:g}"
        raise ParameterError("lower_singularity_threshold", slow, allowed)
    free = settings.free_directions
    if not set(free) < set(_DIRECTIONS):
        allowed = f"at most five of {', '.join(_DIRECTIONS)}"
        raise ParameterError("free_directions", free, allowed)


def max_lead(settings: ServoNodeSettings) -> int:
    """Return how many periods the stream may be ahead at most."""
    return max(settings.lead, settings.max_lead)


def core_settings(settings: ServoNodeSettings) -> ServoSettings:
    """Pick what the core needs."""
    return ServoSettings(
        period=1.0 / settings.publish_rate,
        slow_from=settings.lower_singularity_threshold,
        stop_at=settings.hard_stop_singularity_threshold,
        length=settings.characteristic_length or None,
        lead=max_lead(settings),
    )
