"""Sends trajectories to a controller one after the other, and sees whether the robot arrives.

It knows neither ROS nor a clock: a gateway sends and knows the joint states, and the owner of the
dispatcher gives the time.
"""

from collections.abc import Callable
from dataclasses import dataclass

from robomech_ros.execution.client.active_execution import ActiveExecution
from robomech_ros.execution.client.controller_interface import ControllerInterface
from robomech_ros.execution.client.dispatch_settings import DispatchSettings
from robomech_ros.execution.client.execution_queue import ExecutionQueue
from robomech_ros.execution.client.execution_request import ExecutionReport, ExecutionRequest
from robomech_ros.execution.client.position_check import off_start
from robomech_ros.execution.client.speed_scaler import too_slow
from robomech_ros.execution.motion_result import MotionResult
from robomech_ros.outcomes import Code
from robomech_ros.typing import Array


@dataclass
class Tally:
    """Counts of past events, for the diagnostics."""

    sent: int = 0
    arrived: int = 0
    failed: int = 0
    last_failure: str = ""


class Dispatcher:
    """A queue of deliveries of which one at a time is being executed.

    ``on_end`` is called with every delivery that has ended, ``on_stall`` once with what is missing
    while deliveries wait for it. ``tally`` counts what has happened so far. ``speed`` is the part
    of the planned speed at which deliveries are executed, above 0 up to 1; while ``paused`` nothing
    is sent and nothing moves. ``obstruction`` names what a delivery would touch, "" for
    nothing; it is called before sending, and repeatedly during the execution.
    """

    def __init__(
        self,
        gateway: ControllerInterface,
        settings: DispatchSettings | None = None,
        on_end: Callable[[ExecutionRequest], None] = lambda delivery: None,
        on_stall: Callable[[str], None] = lambda missing: None,
        obstruction: Callable[[ExecutionRequest], str] = lambda delivery: "",
    ) -> None:
        self._gateway = gateway
        self._settings = settings or DispatchSettings()
        self._on_end, self._obstruction = on_end, obstruction
        self.queue = ExecutionQueue(gateway, self._settings, on_stall)
        self.tally = Tally()
        self.speed = 1.0
        self.paused = False
        self._now = 0.0
        self._active: ActiveExecution | None = None

    @property
    def current(self) -> ExecutionRequest | None:
        """The delivery that is being executed."""
        return None if self._active is None else self._active.delivery

    @property
    def busy(self) -> bool:
        """True if anything is being executed or waits."""
        return self._active is not None or bool(self.queue)

    def set_speed(self, speed: float, now: float) -> None:
        """Execute at another part of the planned speed, also what is under way.

        Raises TrajectoryRefusedError, with nothing changed, where what is under way waits for its
        stamp or would last too long.
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
        """Cancel running and waiting deliveries for a reason; return their number."""
        self._now = now
        count = len(self.queue) + (self._active is not None)
        while self.queue:
            self._end(self.queue.pop(), MotionResult(Code.PREEMPTED, f"not sent: {text}"))
        self.paused = False
        active = self._active
        if active is None or active.cancelled:
            return count
        verdict = active.cancel(text, now)
        if verdict is not None:
            self._end(active.delivery, verdict)
        self.step(now)
        return count

    def offer(self, delivery: ExecutionRequest, now: float) -> None:
        """Queue a delivery, or send it if it is the first; QueueFullError if there is no room."""
        self.queue.add(delivery, now)
        self.step(now)

    def clock_jumped(self, by: float, now: float) -> None:
        """Note that the time of stamps jumped by `by` (s), and that of motions did not.

        What is under way goes on; what waits for its stamp begins that much earlier.
        """
        self._now = now
        self.queue.clock_jumped(by)
        if self._active is not None:
            self._active.clock_jumped(by, now)

    def step(self, now: float) -> None:
        """Look at the robot and do what is due."""
        self._now, active = now, self._active
        verdict = None if active is None else self._look(active, now)
        if active is not None and verdict is not None:
            self._end(active.delivery, verdict)
        self._send_waiting()

    def conclude(self, delivery: ExecutionRequest, code: int, text: str, now: float) -> None:
        """Take the controller's result of a delivery sent by action."""
        active = self._active
        if active is None or delivery is not active.delivery:
            return
        self._now = now
        verdict = active.conclude(code, text, now)
        if verdict is not None:
            self._end(delivery, verdict)
        self.step(now)

    def close(self, text: str) -> None:
        """Drop all waiting and monitored deliveries, and notify the listeners."""
        while self.queue:
            self._end(self.queue.pop(), MotionResult(Code.REJECTED, f"not sent: {text}"))
        if self._active is not None:
            unwatched = f"{text}; the motion is no longer watched"
            self._end(self._active.delivery, MotionResult(Code.REJECTED, unwatched))

    def _change(self, now: float, speed: float, paused: bool) -> None:
        self._now = now
        if self._active is not None and not self._active.keeps_pace:
            self._active.set_pace(0.0 if paused else speed, now)
        self.speed, self.paused = speed, paused

    def _look(self, active: ActiveExecution, now: float) -> MotionResult | None:
        """Check the active execution, and stop it if there is an obstruction."""
        verdict = None
        if not active.keeps_pace and (obstruction := self._obstruction(active.delivery)):
            text = f"the robot has stopped on its path: {obstruction}"
            verdict = active.cancel(text, now, Code.COLLISION)
        return verdict or active.look(now)

    def _send_waiting(self) -> None:
        """Send the next one, and give up those that have waited too long."""
        while self._active is None and self.queue and not self.paused:
            taken = self.queue.take(self._now)
            for delivery, found in taken:
                if isinstance(found, MotionResult):
                    self._end(delivery, found)
                else:
                    self._send(delivery, found)
            if not taken:
                return

    def _send(self, delivery: ExecutionRequest, positions: Array) -> None:
        """Send a delivery, unless the robot is elsewhere or it would last too long."""
        settings = self._settings
        kinds = self._gateway.kinds(delivery.names)
        wrong = off_start(delivery, positions, kinds, settings.start_tolerance)
        wrong = wrong or too_slow(delivery, self.speed, settings.max_duration)
        if wrong:
            self._end(delivery, MotionResult(Code.REJECTED, wrong))
            return
        if obstruction := self._obstruction(delivery):
            self._end(delivery, MotionResult(Code.COLLISION, f"not sent: {obstruction}"))
            return
        self._active = ActiveExecution(
            delivery, self._gateway, settings, positions, self.speed, self._now
        )
        self.tally.sent += 1
        self._gateway.send(delivery)

    def _end(self, delivery: ExecutionRequest, verdict: MotionResult) -> None:
        code, text = verdict
        duration = 0.0 if delivery.begun_at is None else self._now - delivery.begun_at
        if delivery is self.current:
            self._active = None
        if code:
            self.tally.failed += 1
        else:
            self.tally.arrived += 1
        self.tally.last_failure = text if code else ""
        delivery.end(ExecutionReport(int(code), text, duration))
        self._on_end(delivery)
