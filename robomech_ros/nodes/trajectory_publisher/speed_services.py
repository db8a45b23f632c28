"""The services pause, resume, cancel and set_speed."""

from collections.abc import Callable
from typing import Any

from rclpy.node import Node

from robomech_interfaces.srv import SetSpeed
from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.nodes.common.messages.error_codes import answer
from robomech_ros.nodes.common.messages.message_fields import duration_from_seconds, finite_number
from robomech_ros.nodes.common.services import serve, serve_trigger
from robomech_ros.nodes.trajectory_publisher.dispatch_loop import DispatchLoop

CANCELLED = "cancelled by the service cancel"

# Slowest part of the planned speed: that of the limits in a plan, too.
_SLOWEST = 1e-6


class SpeedServices:
    """Services that set the speed of trajectories, and that stop them.

    - ``loop``: executes the trajectories.
    - ``cancel_program``: ends the running program, for a reason; returns whether one was running.
    - ``give_up_requests``: gives up the requests that wait for a plan; returns their number.
    """

    def __init__(
        self,
        node: Node,
        loop: DispatchLoop,
        cancel_program: Callable[[str], bool],
        give_up_requests: Callable[[], int],
    ) -> None:
        self._dispatcher = loop.dispatcher
        self._loop, self._cancel_program = loop, cancel_program
        self._give_up_requests = give_up_requests
        for name, act in (
            ("pause", self._pause),
            ("resume", self._resume),
            ("cancel", self._cancel),
        ):
            serve_trigger(node, f"~/{name}", act)
        serve(node, SetSpeed, "~/set_speed", self._set_speed)

    def _pause(self) -> str:
        if self._dispatcher.paused:
            return "paused already"
        self._dispatcher.pause(self._loop.clock.now())
        moves = self._dispatcher.current is not None
        what = "the robot stops on its path" if moves else "nothing is under way"
        return f"{what}; what comes waits for resume"

    def _resume(self) -> str:
        if not self._dispatcher.paused:
            raise RobomechError("nothing to resume: not paused")
        self._dispatcher.resume(self._loop.clock.now())
        self._loop.watch()
        moves = self._dispatcher.current is not None
        return "the robot moves on" if moves else "nothing was waiting"

    def _cancel(self) -> str:
        ran = self._cancel_program(f"program {CANCELLED}")
        count = self._give_up_requests()
        count += self._dispatcher.cancel(CANCELLED, self._loop.clock.now())
        self._loop.watch()
        what = f"trajectories dropped: {count}; the robot stops on its path"
        if not count:
            what = "the program is dropped" if ran else "nothing was under way or waiting"
        return what

    def _set_speed(self, request: Any, response: Any) -> Any:
        now, speed = self._loop.clock.now(), finite_number("speed", request.speed)
        if not _SLOWEST <= speed <= 1.0:
            hint = f"from {_SLOWEST:g} up to 1, a part of the planned speed (~/pause stops)"
            raise BadValueError("speed", speed, hint)
        self._dispatcher.set_speed(speed, now)
        current = self._dispatcher.current
        if current is not None and not self._dispatcher.paused:
            left = max(current.sent_at + current.lasts - now, 0.0)
            response.remaining = duration_from_seconds(left)
        return answer(response)
