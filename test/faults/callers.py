"""Those who have the robot moved, each by another way, and wait to hear what came of it."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any, Protocol

from action_msgs.msg import GoalStatus, GoalStatusArray
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.msg import ServoStatus
from robomech_interfaces.srv import Execute
from robomech_ros.nodes.middleware.queue_depth import ask, ask_action
from robomech_ros.outcomes import name_of

__all__ = ["ByAction", "ByExecute", "ByRequests", "ByServo", "ByTopic", "Caller"]

# So many requests are sent at once, and a client that has no answer for so long gives up, s.
_REQUESTS, _GIVES_UP = 20, 8.0
# How often a servo is commanded, s, and how long its status may be silent.
_PERIOD, _SILENT = 0.02, 1.5
# After this time (s) without a sign of life a server of an action counts as dead.
_LEASE = 0.5
_STATUS = QoSProfile(
    depth=1,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
    liveliness=LivelinessPolicy.AUTOMATIC,
    liveliness_lease_duration=Duration(seconds=_LEASE),
)
_NO_ANSWER = "no answer"
_NAMES = {
    GoalStatus.STATUS_UNKNOWN: "unknown goal",
    GoalStatus.STATUS_SUCCEEDED: "succeeded",
    GoalStatus.STATUS_CANCELED: "cancelled",
    GoalStatus.STATUS_ABORTED: "aborted",
}


class Caller(Protocol):
    """Somebody who has something done and waits to hear what came of it.

    Attributes
    ----------
    name : str
        How it asks.
    endless : bool
        Whether what it asks for goes on until `end`.
    """

    name: str
    endless: bool

    def begin(self, what: Any) -> None:
        """Ask for it."""

    def heard(self) -> str:
        """Return what came of it, as far as that was heard; empty until then."""

    def over(self) -> str:
        """Return how it ended; empty until then."""

    def restarted(self) -> None:
        """Do what a caller can do once a node was started again."""

    def end(self) -> None:
        """Ask for nothing more."""


def _named(code: int, text: str) -> str:
    return f"{code} {name_of(code)}: {text}" if text else f"{code} {name_of(code)}"


class _Diagnoses:
    """Diagnostics that a node publishes about itself, by key."""

    def __init__(self, node: Node, of: str) -> None:
        self._of = of
        self.values: dict[str, str] = {}
        self.count = 0
        node.create_subscription(DiagnosticArray, "/diagnostics", self._take, 100)

    def _take(self, array: DiagnosticArray) -> None:
        for status in array.status:
            if status.name == self._of:
                self.values = {entry.key: entry.value for entry in status.values}
                self.count += 1


class ByExecute:
    """Calls the service execute of the publisher, which sends a goal of an action."""

    name, endless = "execute", False

    def __init__(self, node: Node) -> None:
        self._client = ask(node, Execute, "trajectory_publisher/execute")
        self._text = ""

    def begin(self, what: JointTrajectory) -> None:
        """Send a request."""
        self._text = ""
        self._client.call_async(Execute.Request(trajectory=what)).add_done_callback(self._take)

    def _take(self, future: Any) -> None:
        answer = future.result()
        self._text = _named(answer.error_code, answer.error_msg)

    def heard(self) -> str:
        """Return the answer, or that none can come."""
        return self._text

    def over(self) -> str:
        """Return the same."""
        return self.heard()

    def restarted(self) -> None:
        """Give up waiting: the next publisher knows nothing of the call."""
        self._text = self._text or _NO_ANSWER

    def end(self) -> None:
        """Nothing: one call is one motion."""


class ByTopic:
    """Publishes a plan; the publisher sends it to the controller's topic, and tells of its end."""

    name, endless = "topic", False

    def __init__(self, node: Node) -> None:
        self._publisher = node.create_publisher(JointTrajectory, "planned_trajectory", 10)
        self._diagnoses = _Diagnoses(node, "trajectory_publisher: execution")
        self._before: tuple[int, ...] = ()
        self._lost = ""

    def begin(self, what: JointTrajectory) -> None:
        """Publish a plan, once the publisher has told of all motions before it."""
        known = self._diagnoses.count
        while self._diagnoses.count == known:
            time.sleep(_PERIOD)
        self._before, self._lost = self._ended(), ""
        self._publisher.publish(what)

    def _ended(self) -> tuple[int, ...]:
        return tuple(int(self._diagnoses.values.get(key, 0)) for key in ("arrived", "failed"))

    def heard(self) -> str:
        """Return what the publisher says on /diagnostics."""
        arrived, failed = (
            now - then for now, then in zip(self._ended(), self._before, strict=True)
        )
        if failed > 0:
            return self._diagnoses.values["last failure"]
        if arrived > 0:
            return "arrived"
        return self._lost

    def over(self) -> str:
        """Return the same."""
        return self.heard()

    def restarted(self) -> None:
        """Give up waiting: the next publisher knows nothing of the plan."""
        self._lost = _NO_ANSWER

    def end(self) -> None:
        """Nothing: one plan is one motion."""


class ByAction:
    """A client of an action of the controller, and of its signs of life.

    Parameters
    ----------
    node : Node
        Owner of the client.
    kind : type
        The action.
    action : str
        Its name.
    goal : callable
        Makes the goal from what is to be done.
    told : callable
        Puts a result into words.
    """

    endless = False

    def __init__(
        self,
        node: Node,
        kind: Any,
        action: str,
        goal: Callable[[Any], Any],
        told: Callable[[Any], str],
    ) -> None:
        self.name = action.rsplit("/", 1)[-1]
        self._node, self._goal, self._told = node, goal, told
        self._client = ask_action(node, kind, action)
        self._handle: Any = None
        self._text = self._lost = ""
        node.create_subscription(
            GoalStatusArray,
            f"{action}/_action/status",
            lambda status: None,
            _STATUS,
            event_callbacks=SubscriptionEventCallbacks(liveliness=self._look),
        )

    def _look(self, change: Any) -> None:
        if change.alive_count_change < 0:
            self._lost = "no sign of life from the server"

    def begin(self, what: Any) -> None:
        """Send a goal, in the thread that spins the node."""
        self._text, self._lost, self._handle = "", "", None

        def send() -> None:
            sent = self._client.send_goal_async(self._goal(what))
            sent.add_done_callback(self._accepted)

        self._node.executor.create_task(send)

    def _accepted(self, future: Any) -> None:
        self._handle = future.result()
        if self._handle.accepted:
            self._ask_result()
        else:
            self._text = "rejected"

    def _ask_result(self) -> None:
        self._handle.get_result_async().add_done_callback(self._take)

    def _take(self, future: Any) -> None:
        answer = future.result()
        text = self._told(answer.result)
        status = _NAMES[answer.status]
        self._text = f"{status}: {text}" if text and answer.status else status

    def heard(self) -> str:
        """Return the result, or that there are no signs of life any more."""
        return self._text or self._lost

    def restarted(self) -> None:
        """Ask for the result again, where none came."""
        if not self._text and self._handle is not None:
            self._node.executor.create_task(self._ask_result)

    def over(self) -> str:
        """Return the result."""
        return self._text

    def end(self) -> None:
        """Nothing: one goal is one motion."""


class ByServo:
    """Commands the servo again and again, and hears its status.

    Parameters
    ----------
    node : Node
        Owner of the publisher.
    moves : callable
        Says whether the robot moves as commanded.
    """

    name, endless = "servo", True

    def __init__(self, node: Node, moves: Callable[[], bool]) -> None:
        self._publisher = node.create_publisher(JointState, "servo/joint_velocity_cmds", 10)
        self._moves = moves
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None
        self._heard_at, self._fault = 0.0, ""
        node.create_subscription(ServoStatus, "servo/status", self._take, 1000)

    def _take(self, status: ServoStatus) -> None:
        self._heard_at = time.monotonic()
        if status.code == ServoStatus.NO_STATE:
            self._fault = status.message

    def begin(self, what: JointState) -> None:
        """Begin to repeat a command of joint velocities."""
        self._stop.clear()
        self._fault, self._heard_at = "", time.monotonic()
        self._thread = threading.Thread(target=self._repeat, args=(what,), daemon=True)
        self._thread.start()

    def _repeat(self, command: JointState) -> None:
        while not self._stop.wait(_PERIOD):
            self._publisher.publish(command)

    def heard(self) -> str:
        """Return a fault that the servo has said, or that it is silent, or that the robot moves."""
        if self._fault:
            return self._fault
        silent = time.monotonic() - self._heard_at > _SILENT
        return "no status from the servo" if silent else ""

    def over(self) -> str:
        """Say that the robot moves as commanded."""
        return "moves as commanded" if self._moves() else ""

    def restarted(self) -> None:
        """Nothing: the commands go on."""

    def end(self) -> None:
        """Command no more."""
        self._stop.set()
        if self._thread is not None:
            self._thread.join()


class ByRequests:
    """A client that sends many requests to a service at once.

    Parameters
    ----------
    node : Node
        Owner of the client.
    kind : type
        The service.
    service : str
        Its name.
    """

    endless = False

    def __init__(self, node: Node, kind: Any, service: str) -> None:
        self.name = service.rsplit("/", 1)[-1]
        self._client = ask(node, kind, service)
        self._request: Any = None
        self._waiting: list[Any] = []
        self._answers: list[Any] = []
        self._heard_at = 0.0

    def begin(self, what: Any) -> None:
        """Send all requests."""
        self._request = what
        self.restarted()

    def restarted(self) -> None:
        """Send those again that were not answered, or all."""
        self._answers.clear()
        self._heard_at = time.monotonic()
        self._waiting = [self._client.call_async(self._request) for _ in range(_REQUESTS)]
        for future in self._waiting:
            future.add_done_callback(self._take)

    def _take(self, future: Any) -> None:
        if future in self._waiting:
            self._heard_at = time.monotonic()
            self._answers.append(future.result())

    def on_the_way(self) -> bool:
        """Whether some requests are answered, and not all."""
        return 0 < len(self._answers) < _REQUESTS

    def heard(self) -> str:
        """Say how many were answered, once these are all that are."""
        count, codes = len(self._answers), sorted({each.error_code for each in self._answers})
        if count == _REQUESTS:
            return f"all answered, {', '.join(f'{code} {name_of(code)}' for code in codes)}"
        if not self._client.service_is_ready():
            return f"{count} of {_REQUESTS} answered, the service has gone"
        if time.monotonic() - self._heard_at > _GIVES_UP:
            return f"{count} of {_REQUESTS} answered, none for {_GIVES_UP:g} s"
        return ""

    def over(self) -> str:
        """Say so when all are answered."""
        return self.heard() if len(self._answers) == _REQUESTS else ""

    def end(self) -> None:
        """Nothing: the requests are over."""
