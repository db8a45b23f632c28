"""Commands as they arrive: checked, in units of the core, with the time until they are stale."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from geometry_msgs.msg import PoseStamped, TwistStamped
from sensor_msgs.msg import JointState

from robomech_ros.errors import BadValueError, NonFiniteError, UnknownJointError, WrongSizeError
from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.messages.error_codes import FrameUnavailableError
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, twist_vector
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.frames.robot_frames import RobotFrames
from robomech_ros.nodes.servo.settings import SPEED_UNITS, ServoNodeSettings
from robomech_ros.servo.commands import JointCommand, PoseCommand, TwistCommand
from robomech_ros.typing import Array

Axes = Callable[[Array], Array]

# No robot moves faster: rad/s or m/s.
_FASTEST = 1e3
# A unitless command may exceed 1 by rounding.
_UNIT = 1.0 + 1e-9
_UNITS = ("rad/s",) * 3 + ("m/s",) * 3
_COMPONENTS = ("angular.x", "angular.y", "angular.z", "linear.x", "linear.y", "linear.z")


@dataclass(frozen=True, eq=False)
class CommandReader:
    """Reads commands for one robot.

    Each method raises RobomechError for a field that cannot be: a frame that is not known or has no
    state, a joint that is not known, a value out of range.
    """

    model: RobotModel
    frames: RobotFrames  #: Finds the frames that commands name.
    monitor: JointStateMonitor  #: Knows the joints that move frames.
    clock: MotionClock  #: The clock that decides which commands are stale.
    settings: Callable[[], ServoNodeSettings]  #: Returns the present parameters.
    ahead: Callable[[], float]  #: Returns the lead of the stream (s).

    def twist(self, message: TwistStamped) -> TwistCommand:
        """Read a twist of the tip's origin, in the axes of the frame of its header."""
        settings, twist = self.settings(), twist_vector(message.twist)
        scales = np.repeat((settings.rotational_scale, settings.linear_scale), 3)
        names = [f"twist.{component}" for component in _COMPONENTS]
        rates = self._speeds(twist, scales, names, _UNITS)
        axes = self._axes_of(message.header.frame_id)
        return TwistCommand(rates, axes, self._until(message.header))

    def pose(self, message: PoseStamped) -> PoseCommand:
        """Read a pose of the tip in the frame of its header, as that is now."""
        settings, target = self.settings(), matrix_from_pose(message.pose)
        place = self.frames.find(message.header.frame_id)
        names = place.joint_names
        at = dict(zip(names, self.monitor.require(names), strict=True)) if names else {}
        target = place.pose(at) @ target
        speeds = settings.linear_scale, settings.rotational_scale
        return PoseCommand(target, *speeds, self._until(message.header))

    def joint_state(self, message: JointState) -> JointCommand:
        """Read velocities of joints by name; the others stand."""
        rates = self._joint_speeds(message.name, message.velocity, "velocity", scaled=True)
        return JointCommand(rates, self._until(message.header))

    def joint_jog(self, message: Any) -> JointCommand:
        """Read a control_msgs/JointJog: velocities, or displacements within its duration."""
        duration = float(message.duration)
        if not (math.isfinite(duration) and duration >= 0.0):
            raise BadValueError("duration", duration, "a time of 0 s (not given) or more")
        until = self._until(message.header)
        if duration:
            until = min(until, self.clock.now() + duration)
        names = message.joint_names
        if not message.displacements:
            rates = self._joint_speeds(names, message.velocities, "velocities", scaled=True)
            return JointCommand(rates, until)
        if message.velocities:
            raise BadValueError("velocities", list(message.velocities), "none beside displacements")
        if not duration:
            raise BadValueError("duration", duration, "more than 0 s, for displacements")
        displacements = np.array(message.displacements, dtype=np.float64)
        with np.errstate(over="ignore"):
            speeds = displacements / duration
        if np.isfinite(displacements).all() and not np.isfinite(speeds).all():
            raise BadValueError("duration", duration, "a time in which the displacements can be")
        rates = self._joint_speeds(names, speeds.tolist(), "displacements", scaled=False)
        return JointCommand(rates, until)

    def _joint_speeds(
        self, names: Sequence[str], values: Sequence[float], what: str, *, scaled: bool
    ) -> Array:
        """Return the speeds of all joints of the chain (rad/s or m/s)."""
        known = self.model.chain.joint_names
        if len(names) != len(values):
            raise WrongSizeError(what, len(values), f"{len(names)}, one for every name")
        if not names:
            raise WrongSizeError("joint names", 0, f"one at least of {', '.join(known)}")
        for name in names:
            if name not in known:
                raise UnknownJointError(name, known)
        if len(set(names)) < len(names):
            twice = next(name for i, name in enumerate(names) if name in names[:i])
            raise WrongSizeError("joint names", len(names), f"each once; '{twice}' is repeated")
        given = np.array(values, dtype=np.float64)
        shown = [f"{what} of joint '{name}'" for name in names]
        scale = np.full(len(names), self.settings().joint_scale)
        units = [f"{self.model.chain.units[known.index(name)]}/s" for name in names]
        speeds = self._speeds(given, scale, shown, units, scaled=scaled)
        rates = np.zeros(len(known))
        rates[[known.index(name) for name in names]] = speeds
        return rates

    def _speeds(
        self,
        given: Array,
        scales: Array,
        names: Sequence[str],
        units: Sequence[str],
        *,
        scaled: bool = True,
    ) -> Array:
        """Check numbers, and give them as speeds."""
        bad = np.flatnonzero(~np.isfinite(given))
        if len(bad):
            raise NonFiniteError(names[bad[0]], float(given[bad[0]]))
        unitless = scaled and self.settings().command_in_type != SPEED_UNITS
        over = np.flatnonzero(np.abs(given) > (_UNIT if unitless else _FASTEST))
        if len(over):
            expected = "from -1 to 1, as command_in_type is unitless"
            if not unitless:
                expected = f"at most {_FASTEST:g} {units[over[0]]}"
            raise BadValueError(names[over[0]], float(given[over[0]]), expected)
        return given * scales if unitless else given

    def _until(self, header: Any) -> float:
        """Return until when (s) a command counts that was made at the stamp of its header.

        The stream is sent ahead of its time, so the robot brakes later than that.
        """
        timeout = self.settings().command_timeout
        sent_ahead = min(self.ahead(), 0.5 * timeout)
        now = self.clock.now()
        ahead = self.clock.until(header.stamp, now)
        if ahead < -timeout:
            what = f"made {-ahead:.3g} s ago"
        elif ahead > timeout:
            what = f"{ahead:.3g} s in the future"
        else:
            return now + timeout - sent_ahead + min(ahead, 0.0)
        expected = f"a command from the last {timeout:g} s, the parameter command_timeout"
        stamp = header.stamp
        raise BadValueError("stamp", f"{stamp.sec}.{stamp.nanosec:09d}, {what}", expected)

    def _axes_of(self, frame: str) -> Axes:
        """Find the axes of a frame, which turn with the joints that carry it."""
        place, chain = self.frames.find(frame), self.model.chain
        count = len(place.joint_names)
        if place.joint_names != chain.joint_names[:count]:
            beside = next(name for name in place.joint_names if name not in chain.joint_names)
            known = [self.model.frame_of(link.name) for link in chain.frames]
            why = f"joint '{beside}', which is not of the chain, moves it"
            raise FrameUnavailableError(frame, known, why)
        return lambda q: place.pose_at(q[:count])[:3, :3]
