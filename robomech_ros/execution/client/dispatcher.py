"""Sends trajectories to a controller one after the other, and sees whether the robot arrives.

It knows neither ROS nor a clock: a gateway sends and knows the joint states, and whoever owns the
dispatcher says what time it is.
"""

from collections import deque
from collections.abc import Callable

from robomech_ros.execution.client.comparison import off_goal, off_start
from robomech_ros.execution.client.delivery import Delivery, Report, Stage
from robomech_ros.execution.client.dispatch_settings import (
    DispatchSettings,
    Gateway,
    QueueFullError,
    Tally,
    stopped,
    with_place,
)
from robomech_ros.execution.client.pacer import Pacer
from robomech_ros.execution.client.progress import Progress
from robomech_ros.execution.refusals import TrajectoryRefusedError
from robomech_ros.outcomes import Code

__all__ = ["Dispatcher"]

# How long the joint states may take to confirm what the controller says, and to come at all, s.
_CONFIRMATION = 1.0
# So long after it should stand a robot that does not was not told in time, s.
_UNHEARD = 0.1


class Dispatcher:
    """A queue of deliveries of which one at a time is being executed.

    Parameters
    ----------
    gateway : Gateway
        The way to the controller.
    settings : DispatchSettings
        What the owner decides.
    on_end : callable
        Called with every delivery that has ended, for the log.
    on_stall : callable
        Called once with what is missing while deliveries wait for it.

    Attributes
    ----------
    current : Delivery or None
        The one that is being executed.
    queue : deque of Delivery
        Those that wait.
    tally : Tally
        What has happened so far.
    speed : float
        Part of the planned speed at which deliveries are executed, above 0 up to 1.
    paused : bool
        Whether nothing is sent and nothing moves until `resume`.
    """

    def __init__(
        self,
        gateway: Gateway,
        settings: DispatchSettings | None = None,
        on_end: Callable[[Delivery], None] = lambda delivery: None,
        on_stall: Callable[[str], None] = lambda missing: None,
    ) -> None:
        self.current: Delivery | None = None
        self.queue: deque[Delivery] = deque()
        self.tally = Tally()
        self._gateway = gateway
        self._settings = settings or DispatchSettings()
        self._on_end = on_end
        self._on_stall = on_stall
        self._now = 0.0
        self._away_since: float | None = None
        self._silent_since: float | None = None
        self._result: tuple[int, str, float] | None = None
        self._progress: Progress | None = None
        self._pacer = Pacer(self._settings.max_duration)
        self._cancelled = ""

    @property
    def busy(self) -> bool:
        """Whether anything is being executed or waits."""
        return self.current is not None or bool(self.queue)

    @property
    def speed(self) -> float:
        """Part of the planned speed."""
        return self._pacer.speed

    @property
    def paused(self) -> bool:
        """Whether everything waits."""
        return self._pacer.paused

    def set_speed(self, speed: float, now: float) -> None:
        """Execute at another part of the planned speed, also what is under way.

        Raises
        ------
        TrajectoryRefusedError
            What is under way waits for its stamp, or would last too long; nothing has changed.
        """
        self._change(now, speed, self.paused)

    def pause(self, now: float) -> None:
        """Stop what is under way on its path, and send nothing; raises as `set_speed` does."""
        self._change(now, self.speed, True)

    def resume(self, now: float) -> None:
        """Go on where `pause` has stopped; raises as `set_speed` does."""
        self._change(now, self.speed, False)
        self.step(now)

    def cancel(self, text: str, now: float) -> int:
        """Stop what is under way on its path and give it up, and all that waits, for a reason.

        Returns
        -------
        int
            How many deliveries that are.
        """
        self._now = now
        count = len(self.queue) + (self.current is not None)
        while self.queue:
            self._end(self.queue.popleft(), Code.PREEMPTED, f"not sent: {text}")
        delivery, self._pacer.paused = self.current, False
        if delivery is None or self._cancelled:
            return count
        self._cancelled = text
        if delivery.transport.answers and not self._pacer.stops:
            self._gateway.cancel(delivery)
        else:
            self._stop(delivery)
        self.step(now)
        return count

    def _stop(self, delivery: Delivery) -> None:
        """Stop a delivery that was cancelled; one that has not begun cannot be called back."""
        try:
            self._repace(delivery, 0.0)
        except TrajectoryRefusedError as error:
            text = f"{self._cancelled}; {error}, and the controller may still execute it"
            self._end(delivery, Code.PREEMPTED, text)

    def _change(self, now: float, speed: float, paused: bool) -> None:
        self._now = now
        if self.current is not None and not self._cancelled and self._result is None:
            self._repace(self.current, 0.0 if paused else speed)
        self._pacer.speed, self._pacer.paused = speed, paused

    def _repace(self, delivery: Delivery, pace: float) -> None:
        limit = self._gateway.acceleration(delivery.names)
        if self._pacer.change(delivery, self._now, pace, limit):
            self._watch_from_now(delivery)
            self._gateway.send(delivery)

    def _repace_again(self, delivery: Delivery) -> bool:
        """Send a change of pace anew that the controller did not take; whether that was done."""
        limit = self._gateway.acceleration(delivery.names)
        changed = self._pacer.change_again(delivery, self._now, limit)
        self._watch_from_now(delivery)
        if changed:
            self._gateway.send(delivery)
        return changed

    def _watch_from_now(self, delivery: Delivery) -> None:
        positions = self._gateway.positions(delivery.names)
        if positions is not None:
            self._progress = Progress(delivery, positions, self._gateway.heard(delivery.names))

    def offer(self, delivery: Delivery, now: float) -> None:
        """Queue a delivery, and send it if nothing is before it.

        Raises
        ------
        QueueFullError
            It is not accepted.
        """
        if len(self.queue) >= self._settings.capacity:
            raise QueueFullError(self._settings.capacity)
        delivery.due = now + delivery.delay if delivery.delay else None
        self.queue.append(delivery)
        self.step(now)

    def clock_jumped(self, by: float, now: float) -> None:
        """Take note that the time of stamps jumped by `by` (s), and that of motions did not.

        What is under way goes on; what waits for its stamp begins that much earlier.
        """
        self._now, delivery = now, self.current
        for each in self.queue:
            each.clock_jumped(by)
        if delivery is None or not delivery.waits(now) or self._result is not None:
            return
        if delivery.paced_on_way:
            self._repace_again(delivery)
            return
        delivery.clock_jumped(by)
        delivery.await_stamp(now)
        self._pacer.postpone(now + max(delivery.delay, 0.0))
        self._watch_from_now(delivery)

    def step(self, now: float) -> None:
        """Look at the robot and do what is due."""
        self._now = now
        if self.current is not None:
            self._watch(self.current)
        while self.current is None and self.queue and not self.paused:
            if not self._send_next(self.queue[0]):
                break

    def concluded(self, delivery: Delivery, code: int, text: str, now: float) -> None:
        """Take the controller's result of a delivery sent by action."""
        if delivery is not self.current:
            return
        self._now = now
        if code and self._gateway.runs_before(delivery):
            if self._repace_again(delivery):
                return
            self._gateway.cancel(delivery)
        if code:
            self._end(delivery, code, text)
        elif self._cancelled:
            self._end(delivery, Code.PREEMPTED, self._cancelled)
        elif not self._pacer.stops:
            self._result = (code, text, now)
        self.step(now)

    def close(self, text: str) -> None:
        """Give up all that waits and is being watched, and tell those who listen."""
        while self.queue:
            self._end(self.queue.popleft(), Code.REJECTED, f"not sent: {text}")
        if self.current is not None:
            self._end(self.current, Code.REJECTED, f"{text}; the motion is no longer watched")

    def _send_next(self, delivery: Delivery) -> bool:
        """Send the first of the queue; whether it was sent or done with."""
        missing = self._gateway.missing(delivery.transport)
        if missing:
            self._wait_for(missing)
            return False
        self._away_since, self.tally.stalled = None, ""
        positions = self._gateway.positions(delivery.names)
        if positions is None:
            return self._waited_for_states(delivery)
        self._silent_since = None
        self.queue.popleft()
        place = positions, self._gateway.continuous(delivery.names), self._settings.start_tolerance
        off = off_start(delivery, *place) or self._pacer.too_slow(delivery)
        if off:
            self._end(delivery, Code.REJECTED, off)
            return True
        self.current, self._result = delivery, None
        delivery.depart(self._now)
        self._pacer.begin(delivery, positions)
        self._progress = Progress(delivery, positions, self._gateway.heard(delivery.names))
        self.tally.sent += 1
        self._gateway.send(delivery)
        return True

    def _waited_for_states(self, delivery: Delivery) -> bool:
        """Give up the first of the queue once its joints were not heard of for too long.

        The controller is there, so those behind it, which may name other joints, must not wait.
        """
        if self._silent_since is None:
            self._silent_since = self._now
        waited = self._now - self._silent_since
        if waited < self._settings.controller_timeout:
            return False
        self._silent_since = None
        self.queue.popleft()
        joints = ", ".join(delivery.names)
        self._end(delivery, Code.NO_STATE, f"no joint states of {joints} within {waited:.1f} s")
        return True

    def _wait_for(self, missing: str) -> None:
        """Nothing can be sent: after a while tell those who wait for an answer."""
        self._silent_since = None
        if self._away_since is None:
            self._away_since = self._now
        waited = self._now - self._away_since
        if waited < self._settings.controller_timeout:
            return
        text = f"{missing} not there after {waited:.1f} s"
        if not self.tally.stalled:
            self._on_stall(text)
        self.tally.stalled = text
        for delivery in list(self.queue):
            if delivery.transport.answers:
                self.queue.remove(delivery)
                self._end(delivery, Code.REJECTED, text)
            else:
                waiting = f"{text}; the trajectory stays queued"
                delivery.tell(Report(int(Code.REJECTED), waiting, 0.0))

    def _watch(self, delivery: Delivery) -> None:
        elapsed, progress = self._now - delivery.sent_at, self._look(delivery)
        off = self._off_goal(delivery)
        if self._result is not None:
            code, text, since = self._result
            if not off or self._now - since > _CONFIRMATION:
                unconfirmed = off and f"the controller reports success, but {off}"
                self._end(delivery, code, text or unconfirmed)
        elif gone := self._gone(delivery, progress, self._settings.controller_timeout):
            self._gateway.cancel(delivery)
            self._end(delivery, Code.REJECTED, with_place(gone, off))
        elif self._pacer.stops:
            self._watch_stop(delivery, elapsed, progress, off)
        elif delivery.transport.answers:
            self._watch_controller(delivery, elapsed)
        else:
            self._watch_robot(delivery, elapsed, progress, off)

    def _look(self, delivery: Delivery) -> Progress:
        assert self._progress is not None
        positions = self._gateway.positions(delivery.names)
        self._progress.look(self._now, positions, self._gateway.heard(delivery.names))
        return self._progress

    def _watch_robot(
        self, delivery: Delivery, elapsed: float, progress: Progress, off: str
    ) -> None:
        """See by the joint states whether the robot has arrived, or will not."""
        settings, late = self._settings, elapsed - delivery.lasts
        if late >= 0.0 and not off and progress.stands:
            self._end(delivery, Code.NONE, "")
        elif off and progress.stuck > settings.standstill_timeout:
            self._end(delivery, *stopped(progress, off))
        elif late > settings.arrival_timeout:
            patience = max(settings.arrival_timeout, _CONFIRMATION)
            gone = self._gone(delivery, progress, patience)
            if gone:
                self._end(delivery, Code.REJECTED, with_place(gone, off))
            else:
                self._end(delivery, Code.GOAL_TOLERANCE, off or "the robot does not come to rest")

    def _watch_stop(self, delivery: Delivery, elapsed: float, progress: Progress, off: str) -> None:
        """See that the robot stands where it was told to, and end what was cancelled."""
        late = elapsed - delivery.lasts
        if late > _UNHEARD and off and not progress.stands and self._repace_again(delivery):
            return
        if late > self._settings.arrival_timeout and off:
            self._end(delivery, Code.GOAL_TOLERANCE, f"it did not stop as it was told to: {off}")
        elif late >= 0.0 and self._cancelled and progress.stands:
            self._end(delivery, Code.PREEMPTED, self._cancelled)

    def _gone(self, delivery: Delivery, progress: Progress, patience: float) -> str:
        """Say what was not there for longer than `patience` (s); empty if all is there."""
        missing = self._gateway.missing(delivery.transport)
        if not missing:
            self._away_since = None
        elif self._away_since is None:
            self._away_since = self._now
        if self._away_since is not None and self._now - self._away_since > patience:
            return f"the controller is gone: {missing} disappeared"
        if progress.silent > patience:
            joints = ", ".join(delivery.names)
            return (
                f"the controller is gone: no joint states of {joints} for {progress.silent:.1f} s"
            )
        return ""

    def _watch_controller(self, delivery: Delivery, elapsed: float) -> None:
        """See that the controller is not overdue."""
        settings = self._settings
        allowed = delivery.lasts + settings.arrival_timeout + settings.controller_timeout
        if elapsed > allowed:
            self._gateway.cancel(delivery)
            text = (
                f"no result from the controller {elapsed:.1f} s after sending; the trajectory "
                f"lasts {delivery.lasts:.3g} s"
            )
            self._end(delivery, Code.TIMED_OUT, text)

    def _off_goal(self, delivery: Delivery) -> str:
        """Say how the robot is off the goal; empty if it is there."""
        positions = self._gateway.positions(delivery.names)
        if positions is None:
            return f"no joint states of {', '.join(delivery.names)}"
        continuous = self._gateway.continuous(delivery.names)
        return off_goal(delivery, positions, continuous, self._settings.goal_tolerance)

    def _end(self, delivery: Delivery, code: int, text: str) -> None:
        duration = self._now - delivery.begun_at if delivery.stage is Stage.SENT else 0.0
        if delivery is self.current:
            self.current, self._away_since, self._cancelled = None, None, ""
        if code:
            self.tally.failed += 1
        else:
            self.tally.arrived += 1
        self.tally.last_failure = text if code else ""
        delivery.end(Report(int(code), text, duration))
        self._on_end(delivery)
