"""The delivery under way: the pace at which it was sent, and whether its motion has ended."""

from robomech_ros.execution.client.controller_interface import ControllerInterface
from robomech_ros.execution.client.dispatch_settings import DispatchSettings
from robomech_ros.execution.client.execution_request import ExecutionRequest
from robomech_ros.execution.client.goal_monitor import CONFIRMATION, GoalMonitor
from robomech_ros.execution.client.speed_scaler import SpeedScaler
from robomech_ros.execution.motion_result import MotionResult
from robomech_ros.execution.rejections import TrajectoryRefusedError
from robomech_ros.outcomes import Code
from robomech_ros.typing import Array

# A robot that still moves this long after it should stand was stopped too late, s.
_STOP_OVERDUE = 0.1


class ActiveExecution:
    """A delivery that is being executed, by a gateway to the controller and settings of an owner.

    It was sent at ``now`` (s) where the robot was at ``positions`` (n,), rad or m, and is executed
    at a pace above 0 up to 1. ``cancelled`` is the reason for a cancellation, or empty;
    ``cancel_code`` is then the code of the result.
    """

    def __init__(
        self,
        delivery: ExecutionRequest,
        gateway: ControllerInterface,
        settings: DispatchSettings,
        positions: Array,
        pace: float,
        now: float,
    ) -> None:
        self.delivery = delivery
        self.cancelled, self.cancel_code = "", Code.PREEMPTED
        self._gateway, self._settings = gateway, settings
        self._reached: tuple[str, float] | None = None
        delivery.depart(now)
        self._pace = SpeedScaler(delivery, positions, pace, settings.max_duration)
        self._watch = GoalMonitor(delivery, gateway, settings, positions)

    @property
    def keeps_pace(self) -> bool:
        """True if its speed no longer changes: it is cancelled, or has arrived."""
        return bool(self.cancelled) or self._reached is not None

    def set_pace(self, pace: float, now: float) -> None:
        """Make the rest of it go at another pace, 0 to 1; 0 = stop on the path.

        Raises TrajectoryRefusedError where it waits for its stamp, or its rest would last too long.
        """
        limit = self._gateway.acceleration(self.delivery.names)
        if self._pace.change(now, pace, limit):
            self._watch.begin_anew()
            self._gateway.send(self.delivery)

    def cancel(self, text: str, now: float, code: Code = Code.PREEMPTED) -> MotionResult | None:
        """Stop on the path and give up, for a reason; None while the robot stops."""
        self.cancelled, self.cancel_code = text, code
        if self.delivery.transport.answers and not self._pace.stops:
            self._gateway.cancel(self.delivery)
            return None
        try:
            self.set_pace(0.0, now)
        except TrajectoryRefusedError as error:
            late = f"{text}; {error}, and the controller may still execute it"
            return MotionResult(code, late)
        return None

    def clock_jumped(self, by: float, now: float) -> None:
        """Advance a motion that waits for its stamp by `by` (s); others go on."""
        delivery = self.delivery
        if not delivery.waits(now) or self._reached is not None:
            return
        if delivery.paced_on_way:
            self._set_pace_again(now)
            return
        delivery.clock_jumped(by)
        delivery.await_stamp(now)
        self._pace.postpone(now + max(delivery.delay, 0.0))
        self._watch.begin_anew()

    def conclude(self, code: int, text: str, now: float) -> MotionResult | None:
        """Take the controller's result; returns the verdict if that is final."""
        if code and self._gateway.runs_before(self.delivery):
            if self._set_pace_again(now):
                return None
            self._gateway.cancel(self.delivery)
        if code and (code != Code.PREEMPTED or self.cancel_code == code):
            return MotionResult(code, text)
        if self.cancelled:
            return MotionResult(self.cancel_code, self.cancelled)
        if not self._pace.stops:
            self._reached = text, now
        return None

    def look(self, now: float) -> MotionResult | None:
        """Look at the robot at a time (s); None while the motion goes on."""
        watch = self._watch
        watch.look(now)
        if self._reached is not None:
            return self._confirmed(*self._reached, now)
        lost = watch.lost(self._settings.controller_timeout)
        if lost is not None:
            self._gateway.cancel(self.delivery)
            return lost
        if self._pace.stops:
            return self._stopped(now)
        return self._overdue() if self.delivery.transport.answers else watch.arrival()

    def _set_pace_again(self, now: float) -> bool:
        """Send a change of pace anew that the controller did not take; whether that was done."""
        limit = self._gateway.acceleration(self.delivery.names)
        changed = self._pace.change_again(now, limit)
        self._watch.begin_anew()
        if changed:
            self._gateway.send(self.delivery)
        return changed

    def _confirmed(self, text: str, since: float, now: float) -> MotionResult | None:
        """Return the controller's success once the joint states confirm it.

        A controller also reports success of what a trajectory from the topic has replaced.
        """
        off = self._watch.off
        if off and now - since <= CONFIRMATION:
            return None
        wrong = off or self._watch.left_out
        if not wrong:
            return MotionResult(Code.NONE, text)
        said = f"the controller reports success, but {wrong}"
        return MotionResult(Code.PREEMPTED, f"{said}; something else has taken over, or moves it")

    def _stopped(self, now: float) -> MotionResult | None:
        """See that the robot stands where it was sent, and end what was cancelled."""
        late, off, stands = self._watch.late, self._watch.off, self._watch.stands
        if late > _STOP_OVERDUE and off and not stands and self._set_pace_again(now):
            return None
        if late > self._settings.arrival_timeout and off:
            return MotionResult(Code.GOAL_TOLERANCE, f"it did not stop as commanded: {off}")
        if late >= 0.0 and self.cancelled and stands:
            return MotionResult(self.cancel_code, self.cancelled)
        return None

    def _overdue(self) -> MotionResult | None:
        """See that the controller says in time how the motion ended."""
        settings, lasts, elapsed = self._settings, self.delivery.lasts, self._watch.elapsed
        if elapsed <= lasts + settings.arrival_timeout + settings.controller_timeout:
            return None
        self._gateway.cancel(self.delivery)
        text = (
            f"no result from the controller {elapsed:.1f} s after sending; the trajectory "
            f"lasts {lasts:.3g} s"
        )
        return MotionResult(Code.TIMED_OUT, text)
