"""The motion that a publisher which was killed has left under way, seen to its end by the next."""

import json
import math
from typing import Any

import numpy as np
from rclpy.node import Node

from robomech_ros.execution.client.arrival_watch import ArrivalWatch
from robomech_ros.execution.client.delivery import Delivery, Transport
from robomech_ros.execution.client.dispatch_settings import DispatchSettings
from robomech_ros.execution.client.dispatcher import Dispatcher
from robomech_ros.execution.client.gateway import Gateway
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.process.crash_record import LARGEST, CrashRecord, open_crash_record
from robomech_ros.trajectory.waypoints import Waypoints

_NAME = "motion_under_way"
# How often the joints are looked at, Hz, and how long they may take to be heard of, s.
_RATE, _PATIENCE = 10.0, 10.0
# Rests of motions (s) are at least so long.
_SHORTEST = 1e-3


class MotionLeft:
    """Writes down which motion is under way, and tells what became of the one before a crash.

    Parameters
    ----------
    node : Node
        Whose motions they are; its log tells what became of them.
    clock : MotionClock
        The time.
    gateway : Gateway
        Knows where the robot is.
    dispatcher : Dispatcher
        What executes; when it sends anything, the motion before is over.
    settings : DispatchSettings
        When a robot has arrived.

    Attributes
    ----------
    report : str
        What became of the motion that was left; empty where none was.
    open : bool
        Whether it did not reach its goal, or that is not known yet.
    """

    def __init__(
        self,
        node: Node,
        clock: MotionClock,
        gateway: Gateway,
        dispatcher: Dispatcher,
        settings: DispatchSettings,
    ) -> None:
        self._node, self._clock, self._gateway = node, clock, gateway
        self._dispatcher, self._settings = dispatcher, settings
        self._noted: object = None
        self.report, self.open = "", False
        self._watch: ArrivalWatch | None = None
        self._record: CrashRecord | None = open_crash_record(node, _NAME, ())
        left = None if self._record is None else self._record.left
        rest = None if left is None else _rest_of(left.data, left.age)
        if rest is None or left is None:
            return
        self._delivery, others = rest
        more = f"; {others} trajectories that waited are lost" if others else ""
        self._head = (
            f"this node's process was killed; {left.age:.1f} s ago it had a motion under way{more}"
        )
        self._tell("it is watched to its end", True)
        self._begun = clock.now()
        self._timer = node.create_timer(1.0 / _RATE, self._look, clock=clock.clock)

    def note(self) -> None:
        """Write down what is under way now."""
        active, record = self._dispatcher.current, self._record
        waiting = len(self._dispatcher.queue)
        state = (active, active and active.sent_at, waiting)
        if record is None or state == self._noted:
            return
        self._noted = state
        text = b"" if active is None else _written(active, self._clock.now(), waiting)
        try:
            record.write(text if len(text) <= LARGEST else b"")
        except OSError as error:
            self._node.get_logger().warning(f"motions are noted no longer: {error.strerror}")
            self.close()

    def close(self) -> None:
        """Leave nothing: this process ends in good order, or nothing can be written."""
        record, self._record = self._record, None
        if record is not None:
            record.close()

    def _look(self) -> None:
        delivery, now = self._delivery, self._clock.now()
        positions = self._gateway.positions(delivery.names)
        if self._dispatcher.current is not None:
            self._end("another one was sent before its end was seen", True)
        elif self._watch is not None:
            self._watch.look(now)
            verdict = self._watch.arrival()
            if verdict is not None:
                self._end(verdict.text or "it has reached its goal", bool(verdict.code))
        elif positions is not None:
            delivery.depart(now)
            self._watch = ArrivalWatch(delivery, self._gateway, self._settings, positions)
        elif now - self._begun > _PATIENCE:
            self._end(f"no joint states of {', '.join(delivery.names)} tell of its end", True)

    def _end(self, text: str, failed: bool) -> None:
        self._node.destroy_timer(self._timer)
        self._tell(text, failed)

    def _tell(self, text: str, failed: bool) -> None:
        self.report, self.open = f"{self._head}: {text}", failed
        logger = self._node.get_logger()
        if failed:
            logger.warning(self.report)
        else:
            logger.info(self.report)


def _written(delivery: Delivery, now: float, waiting: int) -> bytes:
    """Return what the next process needs of a motion under way."""
    motion = {
        "joints": list(delivery.names),
        "goal": delivery.goal.tolist(),
        "rest": delivery.sent_at + delivery.lasts - now,
        "waiting": waiting,
    }
    return json.dumps(motion).encode()


def _rest_of(data: bytes, age: float) -> tuple[Delivery, int] | None:
    """Read the rest of a motion that was noted some time (s) ago, and how many waited."""
    try:
        motion: dict[str, Any] = json.loads(data)
        names, goal = tuple(map(str, motion["joints"])), np.array(motion["goal"], dtype=np.float64)
        rest, waiting = float(motion["rest"]) - age, int(motion["waiting"])
    except (ValueError, TypeError, KeyError):
        return None
    if goal.shape != (len(names),) or not np.isfinite(goal).all() or not math.isfinite(rest):
        return None
    end = Waypoints(np.array([max(rest, _SHORTEST)]), goal[None])
    return Delivery(None, names, end, Transport.TOPIC), waiting
