"""Monitor of the joints: start of a stream, and tracking of it."""

from collections import deque
from dataclasses import dataclass
from typing import NamedTuple

from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.messages.error_codes import NoStateError
from robomech_ros.nodes.common.parameters import parameter
from robomech_ros.servo.tracking import TrackedJoints, Tracking
from robomech_ros.typing import Array

# Timeout of the next state of the joints (s).
_STATE_DUE = 0.2
# Timeout of joint states beyond the tracking delay while the robot is driven (s).
_STATE_LOST = 0.5
# The least lag of this number of looks counts.
_LOOKS = 10


@dataclass(frozen=True)
class StreamSettings:
    """Parameters of nodes that stream commands to the controller."""

    command_out_topic: str = parameter(
        "joint_trajectory_controller/joint_trajectory",
        "Command topic of the controller (trajectory_msgs/JointTrajectory)",
    )
    tracking_tolerance: float = parameter(
        0.1,
        "Largest deviation of a joint from its commands of the last tracking_delay, rad or m, "
        "before the node stops commanding the robot; 0 = any distance",
        (0.0, 10.0),
    )
    tracking_delay: float = parameter(
        0.2,
        "Allowed lag of the joints behind their commands. The node also stops commanding if no "
        "joint states arrive for this time plus 0.5 s",
        (0.0, 5.0, "s"),
    )


class Fault(NamedTuple):
    """Reason for no longer driving a robot, and the joints at fault."""

    why: str
    joints: tuple[str, ...]


class TrackingMonitor:
    """Monitors the joints of a robot during a stream of commands.

    - ``settings``: largest deviation of a joint from its commands, and largest lag behind them.
    """

    def __init__(
        self, joints: TrackedJoints, monitor: JointStateMonitor, settings: StreamSettings
    ) -> None:
        self._names, self._monitor = joints.joint_names, monitor
        self._tolerance, self._delay = settings.tracking_tolerance, settings.tracking_delay
        self._tracking = Tracking(joints, self._tolerance, self._delay)
        # Number of received joint states, and the time (s) of the last one.
        self._updates, self._updated_at = 0, 0.0
        self._waits_from: float | None = None
        self._lags: deque[float] = deque(maxlen=_LOOKS)

    def position(self) -> Array | None:
        """Return the latest positions (rad or m), shape (n,); None if one is unknown."""
        return self._monitor.positions(self._names)

    def fresh_state(self, now: float) -> tuple[Array, Array] | None:
        """Return positions and velocities (n,) received after the first call; None until then."""
        position = self.position()
        update_count = self._monitor.update_count(self._names)
        if self._waits_from is None:
            # Earlier states may be old: the next one is the present one.
            self._waits_from, self._updates = now, update_count
        if position is None or update_count <= self._updates:
            return None
        return position, self._monitor.velocities(self._names)

    def is_overdue(self, now: float) -> bool:
        """Return whether the state that `fresh_state` waits for should have come by now."""
        late = self._waits_from is not None and now > self._waits_from + _STATE_DUE
        return late or self.position() is None

    def stop_waiting(self) -> None:
        """Stop waiting: the next call of `fresh_state` is a first one."""
        self._waits_from = None

    def why_no_state(self) -> str:
        """Say why the joints are unknown, or that a state is awaited."""
        try:
            self._monitor.require(self._names)
        except NoStateError as error:
            return str(error)
        return "waits for a new state of the joints"

    def begin(self, now: float) -> None:
        """Start to monitor a stream at the present time (s)."""
        self._tracking.begin()
        self._lags.clear()
        self._waits_from = None
        self._updates, self._updated_at = self._monitor.update_count(self._names), now

    def expect(self, time: float, position: Array) -> None:
        """Note the commanded positions at a time (s)."""
        self._tracking.tell(time, position)

    def lag(self, now: float) -> float | None:
        """Return the least recent lag (s) behind the stream, since the age of states varies."""
        position = self.position()
        lag = None if position is None else self._tracking.lag(now, position)
        if lag is None:
            self._lags.clear()
            return None
        self._lags.append(lag)
        return min(self._lags) if len(self._lags) == _LOOKS else None

    def fault(self, now: float) -> Fault | None:
        """Return the joints that do not follow their commands or have no state, if any."""
        if not self._tolerance:
            return None
        position = self.position()
        update_count = self._monitor.update_count(self._names)
        if position is None or update_count <= self._updates:
            silent = now - self._updated_at
            lost = silent > self._delay + _STATE_LOST
            return Fault(f"no state of the joints for {silent:.3g} s", ()) if lost else None
        self._updates, self._updated_at = update_count, now
        found = self._tracking.deviation(now, position)
        return None if found is None else Fault(found.text, (found.joint,))
