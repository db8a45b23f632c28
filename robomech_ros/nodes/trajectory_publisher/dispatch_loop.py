"""Periodic checks of a robot by a dispatcher, with the clock of a node."""

from collections.abc import Callable

from rclpy.node import Node

from robomech_ros.execution.client.dispatcher import Dispatcher
from robomech_ros.execution.client.execution_request import ExecutionRequest
from robomech_ros.nodes.common.cooperative_wait import steady_timer
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.nodes.process.simulated_clock import missing_time
from robomech_ros.nodes.trajectory_publisher.controller_client import ControllerClient
from robomech_ros.nodes.trajectory_publisher.settings import PublisherSettings, dispatch_settings
from robomech_ros.outcomes import Code, name_of


class DispatchLoop:
    """Tells a dispatcher the time, while it has something to do.

    - ``settings``: how often it looks, and what the dispatcher needs.
    - ``obstruction``: names what an execution request would touch; "" for nothing.
    """

    def __init__(
        self,
        node: Node,
        clock: MotionClock,
        link: ControllerClient,
        settings: PublisherSettings,
        obstruction: Callable[[ExecutionRequest], str],
    ) -> None:
        self._node, self._log = node, ThrottledLog(node.get_logger())
        self.clock = clock
        given = dispatch_settings(settings)
        #: Executes the requests one after the other.
        self.dispatcher = Dispatcher(link, given, self._log_end, self._log_stall, obstruction)
        self._timer = node.create_timer(1.0 / settings.watch_rate, self._look, clock=clock.clock)
        self._timer.cancel()
        self._begin = steady_timer(node, given.controller_timeout, self._require_time)
        self._begin.cancel()
        # A timer that has not fired since it was reset would wait until its old time comes again.
        clock.on_jump(self._take_jump)

    def offer(self, execution: ExecutionRequest) -> None:
        """Queue an execution request; raises QueueFullError if too many wait already."""
        self.dispatcher.offer(execution, self.clock.now())
        self.watch()

    def conclude(self, execution: ExecutionRequest, code: int, text: str) -> None:
        """Take the controller's result of an execution request sent by action."""
        self.dispatcher.conclude(execution, code, text, self.clock.now())

    def watch(self) -> None:
        """Look at the robot again and again while there is something to see."""
        if self.dispatcher.busy:
            self._timer.reset()
            if not self.clock.runs and self._begin.is_canceled():
                self._begin.reset()

    def _look(self) -> None:
        self.dispatcher.step(self.clock.now())
        if not self.dispatcher.busy:
            self._timer.cancel()

    def _require_time(self) -> None:
        """Drop all waiting trajectories if there is no time yet."""
        self._begin.cancel()
        if not self.clock.runs:
            self.dispatcher.close(missing_time(self._node))

    def _take_jump(self, by: float) -> None:
        """Monitor deliveries that wait for their stamp by the new time (s)."""
        self.dispatcher.clock_jumped(by, self.clock.now())
        self.watch()

    def _log_end(self, execution: ExecutionRequest) -> None:
        report = execution.report
        assert report is not None
        if report.code:
            text = f"trajectory failed ({report.code} {name_of(report.code)}): {report.text}"
            # A requested end is no error.
            (self._log.info if report.code == Code.PREEMPTED else self._log.error)(text)
        elif report.text:
            self._log.warning(report.text)
        else:
            self._log.info(f"arrived after {report.duration:.2f} s")

    def _log_stall(self, text: str) -> None:
        self._log.warning(f"waiting trajectories: {len(self.dispatcher.queue)}: {text}")
