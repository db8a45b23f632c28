"""The services pause, resume, cancel and set_speed."""

import math
from collections.abc import Callable
from typing import Any

from rclpy.node import Node
from std_srvs.srv import Trigger

from robomech_interfaces.srv import SetSpeed
from robomech_ros.errors import BadValueError, NonFiniteError, RobomechError
from robomech_ros.nodes.common.error_codes import answer, code_of
from robomech_ros.nodes.common.message_fields import duration_from_seconds
from robomech_ros.nodes.middleware.queue_depth import serve
from robomech_ros.nodes.trajectory_publisher.dispatch_loop import DispatchLoop

CANCELLED = "cancelled by the service cancel"

# Slowest part of the planned speed: that of the limits in a plan, too.
_SLOWEST = 1e-6


class SpeedServices:
    """Lets clients say how fast trajectories are executed, and whether at all.

    Parameters
    ----------
    node : Node
        Owner of the services.
    loop : DispatchLoop
        What executes.
    cancel_program : callable
        Ends the program that runs, for a reason; returns whether one did.
    give_up_requests : callable
        Gives up the requests that wait for a plan; returns how many do.
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
        serve(node, Trigger, "~/pause", self._pause)
        serve(node, Trigger, "~/resume", self._resume)
        serve(node, Trigger, "~/cancel", self._cancel)
        serve(node, SetSpeed, "~/set_speed", self._set_speed)

    def _pause(self, request: Any, response: Any) -> Any:
        if self._dispatcher.paused:
            return _said(response, True, "paused already")
        try:
            self._dispatcher.pause(self._loop.clock.now())
        except RobomechError as error:
            return _said(response, False, str(error))
        moves = self._dispatcher.current is not None
        what = "the robot stops on its path" if moves else "nothing is under way"
        return _said(response, True, f"{what}; what comes waits for resume")

    def _resume(self, request: Any, response: Any) -> Any:
        if not self._dispatcher.paused:
            return _said(response, False, "nothing to resume: not paused")
        try:
            self._dispatcher.resume(self._loop.clock.now())
        except RobomechError as error:
            return _said(response, False, str(error))
        self._loop.watch()
        moves = self._dispatcher.current is not None
        return _said(response, True, "the robot moves on" if moves else "nothing was waiting")

    def _cancel(self, request: Any, response: Any) -> Any:
        ran = self._cancel_program(f"program {CANCELLED}")
        count = self._give_up_requests() + self._dispatcher.cancel(
            CANCELLED, self._loop.clock.now()
        )
        self._loop.watch()
        what = f"{count} trajectories dropped; the robot stops on its path"
        if not count:
            what = "the program is dropped" if ran else "nothing was under way or waiting"
        return _said(response, True, what)

    def _set_speed(self, request: Any, response: Any) -> Any:
        now = self._loop.clock.now()
        try:
            self._dispatcher.set_speed(_checked(request.speed), now)
        except RobomechError as error:
            return answer(response, code_of(error), str(error))
        current = self._dispatcher.current
        if current is not None and not self._dispatcher.paused:
            left = max(current.sent_at + current.lasts - now, 0.0)
            response.remaining = duration_from_seconds(left)
        return answer(response)


def _checked(speed: float) -> float:
    if not math.isfinite(speed):
        raise NonFiniteError("speed", speed)
    if not _SLOWEST <= speed <= 1.0:
        hint = f"from {_SLOWEST:g} up to 1, a part of the planned speed (~/pause stops)"
        raise BadValueError("speed", speed, hint)
    return speed


def _said(response: Any, success: bool, message: str) -> Any:
    response.success = success
    response.message = message
    return response
