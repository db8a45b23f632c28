"""Plans received by topic."""

import time
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.task import Future
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.errors import RobomechError
from robomech_ros.execution.client.execution_request import ExecutionRequest, Transport
from robomech_ros.nodes.common.cooperative_wait import ended_within
from robomech_ros.nodes.common.messages.error_codes import code_of
from robomech_ros.nodes.common.parameters import NodeParameters
from robomech_ros.nodes.middleware.reliable_topics import subscribe_reliably
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.nodes.trajectory_publisher.dispatch_loop import DispatchLoop
from robomech_ros.nodes.trajectory_publisher.messages import ExecutionReader
from robomech_ros.nodes.trajectory_publisher.settings import PublisherSettings
from robomech_ros.outcomes import name_of

TOPIC = "planned_trajectory"
# Plans may come faster than they are taken.
_DEPTH = 100
# A request for the latest plan overtakes the plan itself by no more than this, s: they come by
# different ways.
_ARRIVAL_WAIT = 0.1


class ReceivedPlans:
    """Keeps the latest plan, and has every new one executed if that is wanted.

    - ``table``: parameters: the topic of the plans, and whether they are executed at once.
    - ``reader``: turns plans into execution requests.
    - ``loop``: executes the requests.
    """

    def __init__(
        self,
        node: Node,
        table: NodeParameters[PublisherSettings],
        reader: ExecutionReader,
        loop: DispatchLoop,
    ) -> None:
        self._node, self._log = node, ThrottledLog(node.get_logger())
        self._started = time.time_ns()
        self._table, self.reader, self.loop = table, reader, loop
        self._next: Future | None = None
        self._waiting = self._given_up = 0
        self.latest: ExecutionRequest | None = None  #: The latest received plan.
        self.asked: ExecutionRequest | None = None  #: The trajectory of the latest request.
        self.refusal = ""  #: Why the latest plan was refused; empty if it was accepted.
        #: The topics of plans, as text for messages.
        self.topics = self._listen(table.settings.planner_topic)

    def executes(self, trajectory: JointTrajectory) -> bool:
        """Return whether a trajectory is the latest plan, executed without a request."""
        latest = self.latest
        automatic = self._table.settings.auto_execute
        return automatic and latest is not None and bool(latest.trajectory == trajectory)

    async def wait_for_plan(self) -> bool:
        """Wait a moment for a plan that precedes a request; False if that is given up."""
        if self._next is None or self._next.done():
            self._next = Future()
        before = self._given_up
        self._waiting += 1
        await ended_within(self._node, self._next, _ARRIVAL_WAIT)
        self._waiting -= 1
        return self._given_up == before

    def give_up(self) -> int:
        """Drop the requests that wait for a plan; return their number."""
        self._given_up += 1
        if self._next is not None and not self._next.done():
            self._next.set_result(None)
        return self._waiting

    def _listen(self, planner_topic: str) -> str:
        """Subscribe to plans, to none twice; returns the topics in words."""
        node = self._node
        plain = subscribe_reliably(node, JointTrajectory, TOPIC, self._take, _DEPTH)
        if not planner_topic or node.resolve_topic_name(planner_topic) == plain.topic_name:
            return f"'{plain.topic_name}'"
        latched = QoSProfile(depth=_DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        planner = subscribe_reliably(
            node, JointTrajectory, planner_topic, self._take_latched, latched
        )
        return f"'{plain.topic_name}' or '{planner.topic_name}'"

    def _take_latched(self, plan: JointTrajectory, info: dict[str, Any]) -> None:
        """Take a plan from a latched topic, unless it is from before this node's time."""
        made = info["source_timestamp"]
        if made and made < self._started:
            age = (self._started - made) * 1e-9
            self._log.info(f"a plan made {age:.1f} s before this node started is ignored")
            return
        self._take(plan)

    def _take(self, plan: JointTrajectory) -> None:
        settings = self._table.settings
        arrived, self._next = self._next, None
        if arrived is not None and not arrived.done():
            arrived.set_result(None)
        try:
            asked = self.asked
            if asked is not None and asked.report is None and asked.trajectory == plan:
                # The request for it was faster.
                self.latest = asked
            else:
                self.latest = self.reader.read(plan, Transport(settings.transport))
                if settings.auto_execute:
                    self.loop.offer(self.latest)
            self.refusal = ""
        except RobomechError as error:
            self.refusal = str(error)
            code = code_of(error)
            self._log.error(f"plan refused ({code} {name_of(code)}): {error}")
