"""Common part of all actions of the controller: active goals, their cancellation and end."""

import traceback
from abc import ABC, abstractmethod
from typing import Any, Generic, TypeVar

from rclpy.action import CancelResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.task import Future

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.joint_trajectory_controller.commanded_joints import CommandedJoints
from robomech_ros.nodes.middleware.liveliness import LIVELY
from robomech_ros.nodes.middleware.queue_depth import serve_action
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog

# A client may ask for the result this long after the motion has ended, s.
_RESULT_KEPT = 60

Motion = TypeVar("Motion")


class ActionBase(ABC, Generic[Motion]):
    """Serves an action; the joints are moved by the node's cycles, nothing here waits.

    Its clients see by the liveliness of its status when the process is killed.

    - ``options``: more for the action server.
    """

    # Name of its goals in the log.
    _what: str

    def __init__(
        self, node: Node, joints: CommandedJoints, kind: Any, name: str, **options: Any
    ) -> None:
        self._node, self._log = node, ThrottledLog(node.get_logger())
        self._lock = joints.lock
        # Motions by goal; the lock is to be held while it changes.
        self._served: dict[bytes, tuple[ServerGoalHandle, Motion]] = {}
        self._idle: Future = Future()
        self._destroyed = False
        self._server = serve_action(
            node,
            kind,
            name,
            self._execute,
            cancel_callback=self._cancel,
            result_timeout=_RESULT_KEPT,
            status_pub_qos_profile=LIVELY,
            **options,
        )

    @abstractmethod
    def _start(self, request: Any, ended: Future) -> Motion:
        """Begin the motion of a goal; sets the future when it is over."""

    @abstractmethod
    def _refused(self, error: Exception) -> Any:
        """Make the result of a goal whose motion did not begin; logs a RobomechError."""

    @abstractmethod
    def _ended(self, outcome: Any) -> tuple[Any, bool, bool]:
        """Return the result of an outcome, and whether it is success, or a cancellation."""

    @abstractmethod
    def _stop(self, motion: Motion) -> bool:
        """Stop a motion that a client cancels; returns whether it was under way."""

    @abstractmethod
    def publish_feedback(self) -> None:
        """Tell the clients how far their goals have come; the joints' lock is to be held."""

    async def _execute(self, handle: ServerGoalHandle) -> Any:
        """Serve a goal to its end; meanwhile the client may cancel it and see how far it is."""
        key, ended = _key(handle), Future()
        try:
            motion = self._start(handle.request, ended)
        except Exception as error:
            if not isinstance(error, RobomechError):
                self._log.error(f"{self._what} failed, please report:\n{traceback.format_exc()}")
            handle.abort()
            return self._refused(error)
        with self._lock:
            self._served[key] = handle, motion
        if handle.is_cancel_requested:
            self._cancel(handle)
        outcome = await ended
        with self._lock:
            del self._served[key]
        result, reached, cancelled = self._ended(outcome)
        if reached:
            handle.succeed()
        elif cancelled and handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()
        if not self._served and not self._idle.done():
            self._idle.set_result(None)
        return result

    def _cancel(self, handle: ServerGoalHandle) -> CancelResponse:
        served = self._served.get(_key(handle))
        if served is None:
            # It has not begun yet: it is cancelled as soon as it begins.
            return CancelResponse.ACCEPT
        with self._lock:
            stopped = self._stop(served[1])
        return CancelResponse.ACCEPT if stopped else CancelResponse.REJECT

    def destroy(self) -> None:
        """Destroy the action server, once."""
        if not self._destroyed:
            self._destroyed = True
            self._server.destroy()

    def all_ended(self) -> Future:
        """Return a future that is done when the results of all goals have been handed over."""
        self._idle = Future()
        if not self._served:
            self._idle.set_result(None)
        return self._idle


def _key(handle: ServerGoalHandle) -> bytes:
    return bytes(handle.goal_id.uuid)
