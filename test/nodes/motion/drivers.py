"""Somebody who drives the simulated robot and the trajectory publisher."""

import threading

import numpy as np
from builtin_interfaces.msg import Duration
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.action import ActionClient
from rclpy.event_handler import PublisherEventCallbacks
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robomech_interfaces.action import ExecuteTrajectory
from robomech_interfaces.srv import Execute
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.trajectory_publisher.node import TrajectoryPublisherNode
from robomech_ros.parallel import load_tree_description
from robomech_ros.robots import load_robot

TIMEOUT = 30.0
NAME = "joint_trajectory_controller"
ROBOT = "puma560"


def seconds(value):
    whole = int(value // 1)
    return Duration(sec=whole, nanosec=round((value - whole) * 1e9))


def ended(future):
    """Wait for a future that another thread completes."""
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    assert done.wait(TIMEOUT), "no answer"
    return future.result()


def asked(node, call):
    """Ask as `call` does; returns the future of the answer.

    It is called in the thread that spins the node: an action client of rclpy does not know the
    answer to what another thread asks if it comes at once.
    """
    return ended(node.executor.create_task(call))


class Watcher:
    """Sees the joint states."""

    def watch(self, graph, prefix):
        self.states = []
        self._news = threading.Condition()
        graph.client.create_subscription(JointState, f"{prefix}joint_states", self._take, 1000)

    def _take(self, message):
        with self._news:
            self.states.append(message)
            self._news.notify_all()

    def until(self, condition):
        """Wait, looking whenever there is a new state."""
        with self._news:
            assert self._news.wait_for(condition, TIMEOUT), "it never came"

    def path(self, since=0):
        """Return times (s, from the first), positions and velocities of the states until now."""
        states = self.states[since:]
        stamps = [state.header.stamp for state in states]
        times = np.array([s.sec - stamps[0].sec + 1e-9 * s.nanosec for s in stamps])
        positions, velocities = (
            np.array([getattr(state, rate) for state in states])
            for rate in ("position", "velocity")
        )
        return times, positions, velocities

    @property
    def position(self):
        return np.array(self.states[-1].position)

    @property
    def velocity(self):
        return np.array(self.states[-1].velocity)

    def until_moving(self):
        self.until(lambda: self.states and self.velocity.any())

    def until_at(self, goal):
        self.until(
            lambda: (
                self.states
                and np.abs(self.position - goal).max() < 1e-9
                and not self.velocity.any()
            )
        )


class Driver(Watcher):
    """Sends trajectories and watches what the robot does."""

    def __init__(self, graph, start, namespace="", **parameters):
        self.graph = graph
        parameters.setdefault("robot_description", ROBOT)
        self.load(parameters["robot_description"], parameters.get("tip_link"))
        self.prefix = f"{namespace}/" if namespace else ""
        client = graph.client
        self.watch(graph, self.prefix)
        self._topic = client.create_publisher(
            JointTrajectory, f"{self.prefix}{NAME}/joint_trajectory", 10
        )
        self._action = ActionClient(
            client, ExecuteTrajectory, f"{self.prefix}{NAME}/execute_trajectory"
        )
        start(JointTrajectoryControllerNode, namespace=namespace, **parameters)
        assert self._action.wait_for_server(TIMEOUT)
        self.until(lambda: self.states and self._topic.get_subscription_count())

    def load(self, robot, tip):
        """Know the robot, and the joints that trajectories move."""
        self.chain = load_robot(robot, tip=tip)
        self.names = list(self.chain.joint_names)

    def assert_smooth(self, since=0):
        """Between any two states no joint moved or changed its speed faster than it can."""
        times, positions, velocities = self.path(since)
        gaps = (np.diff(times) + 0.03)[:, None]
        assert (np.abs(np.diff(positions, axis=0)) <= self.chain.velocity * gaps).all()
        assert (np.abs(np.diff(velocities, axis=0)) <= 2.0 * self.chain.acceleration * gaps).all()

    def trajectory(self, *points, start=None, velocities=True, names=None):
        """From the present position (or `start`) by points of (time, change of position)."""
        start = self.position if start is None else start
        still = [0.0] * len(start) if velocities else []
        rows = [(0.0, 0.0), *points]
        message = JointTrajectory(joint_names=list(names or self.names))
        message.points = [
            JointTrajectoryPoint(
                positions=(start + np.asarray(change)).tolist(),
                velocities=still,
                accelerations=still,
                time_from_start=seconds(time),
            )
            for time, change in rows
        ]
        return message

    def publish(self, trajectory):
        self._topic.publish(trajectory)

    def send(self, trajectory, feedback=None, **tolerances):
        goal = ExecuteTrajectory.Goal(trajectory=trajectory, **tolerances)
        handle = ended(self.ask(lambda: self._action.send_goal_async(goal, feedback)))
        assert handle.accepted
        return handle

    def result(self, handle):
        answer = ended(self.ask(handle.get_result_async))
        return answer.status, answer.result

    def ask(self, call):
        """Ask something of an action; returns the future of the answer."""
        return asked(self.graph.client, call)

    def execute(self, trajectory, **tolerances):
        return self.result(self.send(trajectory, **tolerances))

    def diagnosis(self, accept):
        """Wait for a status of the controller that is accepted."""
        message = self.graph.receive(
            DiagnosticArray, "/diagnostics", 10, lambda array: accept(array.status[0])
        )
        return message.status[0]


class PlatformDriver(Driver):
    """Drives a parallel robot, whose states have all joints."""

    def load(self, robot, tip):
        self.mechanism = load_tree_description(robot).mechanism
        self.names = list(self.mechanism.actuated)

    @property
    def drives(self):
        return self.position[self.mechanism.drive_index]

    def move(self, *points, **options):
        """Make a trajectory from where the drives are by points of (time, change of position)."""
        return self.trajectory(*points, start=self.drives, **options)


class Suite(Watcher):
    """A publisher, perhaps a controller, somebody who plans, and the joint states."""

    def __init__(self, graph, with_controller=True, start=None, namespace="", **parameters):
        self.graph = graph
        self.chain = load_robot(ROBOT)
        self.home = self.chain.home()
        self.prefix = f"{namespace}/" if namespace else ""
        self.namespace = namespace
        client = graph.client
        self.watch(graph, self.prefix)
        heard = threading.Event()
        self._planned = client.create_publisher(
            JointTrajectory,
            f"{self.prefix}planned_trajectory",
            20,
            event_callbacks=PublisherEventCallbacks(matched=lambda info: heard.set()),
        )
        parameters.setdefault("auto_execute", True)
        start = start or graph.start
        self.node = start(TrajectoryPublisherNode, namespace=namespace, **parameters)
        if with_controller:
            self.start_controller()
        assert heard.wait(TIMEOUT), "the publisher does not listen"

    def start_controller(self, **parameters):
        parameters.setdefault("robot_description", ROBOT)
        self.graph.start(JointTrajectoryControllerNode, namespace=self.namespace, **parameters)

    def trajectory(self, start, goal, duration=0.2, names=None):
        """From rest to rest, rad from the initial position."""
        points = []
        for time, position in ((0.0, start), (duration, goal)):
            position = (self.home + position).tolist()
            still = [0.0] * len(position)
            point = JointTrajectoryPoint(positions=position, velocities=still, accelerations=still)
            point.time_from_start = seconds(time)
            points.append(point)
        return JointTrajectory(joint_names=list(names or self.chain.joint_names), points=points)

    def plan(self, *args, **options):
        self.send(self.trajectory(*args, **options))

    def send(self, trajectory):
        """Publish a trajectory as planned."""
        self._planned.publish(trajectory)

    def start_execute(self, trajectory=None):
        """Call the service execute without waiting for its answer."""
        name = f"{self.prefix}trajectory_publisher/execute"
        client = self.graph.client.create_client(Execute, name)
        assert client.wait_for_service(TIMEOUT)
        return client.call_async(Execute.Request(trajectory=trajectory or JointTrajectory()))

    def execute(self, trajectory=None):
        return ended(self.start_execute(trajectory))

    def condition(self, accept=lambda status: True):
        """Wait for a status of the publisher that is accepted."""

        return self._status("trajectory_publisher", accept)

    def controller_condition(self, accept):
        """Wait for a status of the controller that is accepted."""
        return self._status(NAME, accept)

    def _status(self, node, accept):
        def accepted(array):
            return node in array.status[0].name and accept(array.status[0])

        return self.graph.receive(DiagnosticArray, "/diagnostics", 10, accepted).status[0]

    def value(self, key, accept=lambda status: True):
        """Return one of the facts of such a status."""
        return {entry.key: entry.value for entry in self.condition(accept).values}[key]
