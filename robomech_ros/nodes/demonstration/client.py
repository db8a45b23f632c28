"""The demonstration's own node: calls services and records the joints."""

import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
import rclpy
from geometry_msgs.msg import TwistStamped
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.srv import Execute, PlanJoint
from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.message_fields import NANO, seconds_from_duration
from robomech_ros.nodes.demonstration.suite import DemoFailedError, Suite, running_suite
from robomech_ros.nodes.middleware.queue_depth import ask
from robomech_ros.nodes.middleware.retrying_client import RetriedRequest
from robomech_ros.nodes.process.run import Spinner
from robomech_ros.outcomes import name_of
from robomech_ros.typing import Array

_START_SECONDS = 60.0
_CALL_SECONDS = 20.0
_LOOK = 0.02
# Beyond the duration of a motion.
_GRACE_SECONDS = 30.0
EXECUTE, PLAN_JOINT = "trajectory_publisher/execute", "trajectory_planner/plan_joint"


class DemoClient:
    """Talks to the suite, and notices at once when a node of it is gone.

    - ``suite``: the running nodes.
    - ``names``, ``units``: the joints that are to be recorded, and ``"rad"`` or ``"m"`` for each.
    - ``node``: for more publishers and timers; it spins.
    """

    def __init__(self, suite: Suite, names: Sequence[str], units: Sequence[str]) -> None:
        self._suite, self._names, self._units = suite, names, units
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        self.node = Node("robomech_demo", start_parameter_services=False)
        self._clients: dict[str, Any] = {}
        self._kinds: dict[str, Any] = {}
        self._rows: list[tuple[float, Array, Array]] = []
        self.node.create_subscription(JointState, "joint_states", self._record, 100)
        self._spinner = Spinner([self.node])
        self._spinner.start()

    def close(self) -> None:
        """End the node."""
        self._spinner.stop()
        self.node.destroy_node()
        rclpy.try_shutdown()

    def _record(self, message: JointState) -> None:
        index = {name: i for i, name in enumerate(message.name)}
        order = [index[name] for name in self._names]
        stamp = seconds_of(message)
        velocity = np.array(message.velocity) if message.velocity else np.zeros(len(index))
        self._rows.append((stamp, np.array(message.position)[order], velocity[order]))

    @property
    def latest(self) -> tuple[float, Array] | None:
        """The last joint state: ROS time (s) and positions, shape (n,); None before the first."""
        return self._rows[-1][:2] if self._rows else None

    @property
    def present(self) -> Array:
        """The last received joint positions, shape (n,) (rad or m)."""
        return self._rows[-1][1]

    @property
    def state(self) -> JointState:
        """Joint state with the last received positions."""
        return joint_state(self._names, self.present)

    def recording(self) -> tuple[Array, Array, Array]:
        """Return times from the first message (s), positions and velocities, (m,) and (m, n)."""
        rows = list(self._rows)
        times = np.array([row[0] for row in rows])
        keep = np.flatnonzero(np.diff(times, prepend=-np.inf) > 0.0)
        positions, velocities = (np.array([row[i] for row in rows])[keep] for i in (1, 2))
        return times[keep] - times[keep[0]], positions, velocities

    @property
    def began(self) -> float:
        """ROS time (s) of the first received joint state, at which the recording starts."""
        return self._rows[0][0]

    def now(self) -> float:
        """Return the time of the recording, s: that of the last received joint state."""
        return self._rows[-1][0] - self._rows[0][0] if self._rows else 0.0

    def wait_until_up(self, services: dict[str, Any]) -> None:
        """Wait for services, name to type, and for the first joint state."""
        for name, kind in services.items():
            self._clients[name], self._kinds[name] = ask(self.node, kind, name), kind
        if not self.wait(lambda: not self._missing(), _START_SECONDS):
            missing = ", ".join(self._missing())
            raise DemoFailedError(f"not up after {_START_SECONDS:g} s: {missing}")

    def _missing(self) -> list[str]:
        missing = [n for n, client in self._clients.items() if not client.service_is_ready()]
        return missing if self._rows else [*missing, "joint_states"]

    def call(self, service: str, request: Any) -> Any:
        """Call a service of the suite and return its answer."""
        response = self.ask(service, request)
        _refuse_error(service, response)
        return response

    def plan_joint(self, goal: Array | JointState, **options: Any) -> Any:
        """Request a plan from the present joint positions.

        - ``goal``: joint positions of the goal (rad or m), shape (n,).
        - ``**options``: other fields of a PlanJoint request.

        Returns a PlanJoint.Response.
        """
        if not isinstance(goal, JointState):
            goal = joint_state(self._names, goal)
        request = PlanJoint.Request(start=self.state, goal=goal, **options)
        return self.call(PLAN_JOINT, request)

    def ask(self, service: str, request: Any) -> Any:
        """Call any service and return its answer."""
        question = RetriedRequest(self._clients[service], self._kinds[service], request)
        if self.wait(question.answered.done, _CALL_SECONDS, question.repeat_if_due):
            return question.answer()
        question.give_up()
        raise DemoFailedError(f"{service} did not answer within {_CALL_SECONDS:g} s")

    def wait_until_at(
        self, goal: Array, tolerance: float, seconds: float, look: Callable[[], None] = lambda: None
    ) -> None:
        """Wait until the joints rest at a position.

        - ``goal``: joint positions of the goal (rad or m), shape (n,).
        - ``tolerance``: largest deviation of a joint (rad or m), and largest speed (per s).
        - ``seconds``: how long to wait.
        - ``look``: called again and again meanwhile.
        """

        def arrived() -> bool:
            _, q, qd = self._rows[-1]
            return bool(np.abs(q - goal).max() <= tolerance and np.abs(qd).max() <= tolerance)

        if not self.wait(arrived, seconds, look):
            off = np.abs(self._rows[-1][1] - goal)
            worst = int(np.argmax(off))
            amount = f"{off[worst]:.3g} {self._units[worst]}"
            text = f"after {seconds:.1f} s joint '{self._names[worst]}' is {amount} from its goal"
            raise DemoFailedError(f"the motion did not arrive: {text}")

    def follow(
        self,
        trajectory: JointTrajectory,
        goal: Array,
        tolerance: float,
        show: Callable[[float, Array], None] = lambda done, q: None,
    ) -> None:
        """Execute a trajectory, and wait until the joints rest at its goal.

        - ``goal``: joint positions of the goal (rad or m), shape (n,).
        - ``tolerance``: largest deviation of a joint (rad or m), and largest speed (per s).
        - ``show``: called with the part of the duration that is over, 0 to 1, and the joint
          positions.
        """
        execution = RetriedRequest(
            self._clients[EXECUTE], Execute, Execute.Request(trajectory=trajectory)
        )
        seconds = seconds_from_duration(trajectory.points[-1].time_from_start, "time_from_start")
        begun = self.now()

        def look() -> None:
            if execution.answered.done():
                _refuse_error(EXECUTE, execution.answer())
            show(min((self.now() - begun) / seconds, 1.0) if seconds else 1.0, self.present)

        self.wait_until_at(goal, tolerance, seconds + _GRACE_SECONDS, look)
        show(1.0, self.present)

    def wait(
        self, condition: Callable[[], bool], seconds: float, look: Callable[[], None] = lambda: None
    ) -> bool:
        """Wait for a condition while all nodes live; False if the time (s) is over before.

        - ``condition``: whether it holds.
        - ``seconds``: how long to wait.
        - ``look``: called again and again meanwhile.
        """
        deadline = time.monotonic() + seconds
        while not condition():
            look()
            self._suite.check()
            if time.monotonic() > deadline:
                return False
            time.sleep(_LOOK)
        return True


def seconds_of(message: Any) -> float:
    """Return the time stamp of a message (s)."""
    stamp = message.header.stamp
    return float(stamp.sec + stamp.nanosec / NANO)


def twist_message(twist: Array) -> TwistStamped:
    """Make the command of a twist ``[omega, v_x, v_y]`` (rad/s, m/s), of stamp 0."""
    message = TwistStamped()
    message.twist.angular.z, message.twist.linear.x, message.twist.linear.y = twist.tolist()
    return message


def _refuse_error(service: str, response: Any) -> None:
    if response.error_code:
        code = f"{response.error_code} {name_of(response.error_code)}"
        raise DemoFailedError(f"{service} answers {code}: {response.error_msg}")


@contextmanager
def running_client(
    commands: Mapping[str, Sequence[str]], names: Sequence[str], units: Sequence[str]
) -> Iterator[tuple[Suite, DemoClient]]:
    """Run nodes and a client of theirs; if something fails, print what the nodes said last.

    - ``commands``: command line of each node, by name.
    - ``names``, ``units``: the joints that the client records, and ``"rad"`` or ``"m"`` for each.
    """
    with running_suite(commands) as suite:
        client = DemoClient(suite, names, units)
        try:
            yield suite, client
        except RobomechError:
            print(f"last words of the nodes:\n{suite.last_words()}", file=sys.stderr)
            raise
        finally:
            client.close()
