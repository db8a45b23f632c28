"""Measure the running nodes from outside, with the Python that has ROS; print the figures as JSON.

`bench_nodes.py` starts this script in the environment of the suite, whose packages the peers of the
other benchmarks could disturb.
"""

from __future__ import annotations

import array
import contextlib
import json
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import controller_cycles
import numpy as np
import rclpy
import servo_latency
from rclpy.client import Client
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

from robomech_interfaces.srv import PlanJoint, SolveIK, SolveIKBatch
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import load_robot
from robomech_ros.spatial import position_quaternion_from_pose

ROBOT = "puma560"
TARGET = (0.4, 0.2, 0.3)
SOLUTIONS = 8
STARTS = 5
CALLS = 1000
PLAN_CALLS = 400
WARM_CALLS = 50
BATCH_POSES = 100_000
CHUNK = 10_000  # the most that a node takes in one request unless told otherwise
BATCHES = 5
SETTLE_SECONDS = 3.0
IDLE_SECONDS = 10.0
PATIENCE = 120.0
LOOK_SECONDS = 0.005
PAUSE_SECONDS = 0.005
# A node is up when its last service is there.
SERVICES = {
    "kinematics": "get_jacobian",
    "trajectory_planner": "plan_joint",
    "trajectory_publisher": "execute",
    "joint_trajectory_controller": "reset",
    "servo": "pause_servo",
}
EXECUTABLES = {name: f"{name}_node" for name in SERVICES} | {
    "joint_trajectory_controller": "joint_state_simulator_node"
}


@dataclass(frozen=True)
class Load:
    """Resident memory in MB, and share of one core, of a process that nobody calls."""

    megabytes: float
    core: float


@contextlib.contextmanager
def running(*command: str) -> Iterator[subprocess.Popen[bytes]]:
    """Run `command` for the time of the block, then stop it as Ctrl-C would."""
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    try:
        yield process
        if process.poll() is not None:
            raise SystemExit(f"{command[0]} ended by itself with exit code {process.returncode}")
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def node_command(name: str) -> tuple[str, ...]:
    """Return the command line of the suite's node `name` for ROBOT."""
    executable = Path(sys.executable).with_name(EXECUTABLES[name])
    robot = f"robot_description:={ROBOT}"
    return (str(executable), "--ros-args", "--log-level", "warn", "-p", robot)


def request() -> SolveIK.Request:
    """Return a request for all solutions at a pose where the arm has SOLUTIONS of them."""
    message = SolveIK.Request()
    position, orientation = message.target.pose.position, message.target.pose.orientation
    position.x, position.y, position.z = TARGET
    orientation.x, orientation.y, orientation.z, orientation.w = 0.0, 1.0, 0.0, 0.0
    message.ignore_limits = True
    return message


class Caller:
    """A node that calls services of inverse kinematics and waits for each answer."""

    def __init__(self) -> None:
        self.node: Node = rclpy.create_node("benchmark")
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.request = request()

    def client(self, service: str) -> Client:
        """Return a client of the SolveIK service `service`."""
        return self.node.create_client(SolveIK, service)

    def wait(self, client: Client, process: subprocess.Popen[bytes]) -> None:
        """Wait until the service of `client` is there, which `process` should bring up."""
        deadline = time.monotonic() + PATIENCE
        # wait_for_service() looks four times a second, which is a tenth of a node's start.
        while not client.service_is_ready():
            time.sleep(LOOK_SECONDS)
            if process.poll() is not None:
                raise SystemExit(f"{process.args[0]} ended with exit code {process.returncode}")
            if time.monotonic() > deadline:
                raise SystemExit(f"no service {client.srv_name} after {PATIENCE:g} s")

    def call(self, client: Client, request: Any = None) -> Any:
        """Return the answer of `client` to a request, unless given the one for SolveIK."""
        future = client.call_async(request or self.request)
        self.executor.spin_until_future_complete(future, timeout_sec=PATIENCE)
        response = future.result()
        if response is None:
            raise SystemExit(f"no answer from {client.srv_name} within {PATIENCE:g} s")
        return response


def start_seconds(caller: Caller) -> list[float]:
    """Return the seconds from starting the kinematics node to its first answer, several times."""
    seconds = []
    for _ in range(1 + STARTS):
        client = caller.client("kinematics/solve_ik")
        begin = time.perf_counter()
        with running(*node_command("kinematics")) as process:
            caller.wait(client, process)
            check(caller.call(client))
            seconds.append(time.perf_counter() - begin)
        caller.node.destroy_client(client)
    return seconds[1:]  # the first start may have had to fill a cache


def check(response: SolveIK.Response) -> SolveIK.Response:
    """Return `response` if it holds what the comparison rests on, else stop."""
    if response.error_code or len(response.solutions) != SOLUTIONS:
        raise SystemExit(
            f"expected {SOLUTIONS} solutions and code 0, got {len(response.solutions)} "
            f"and code {response.error_code}: {response.error_msg}"
        )
    return response


def plan_request() -> PlanJoint.Request:
    """Return a request for the fastest motion between two postures."""
    names = list(load_robot(ROBOT).joint_names)
    message = PlanJoint.Request()
    message.start = JointState(name=names, position=[0.0, 0.3, -0.3, 0.0, 0.3, 0.0])
    message.goal = JointState(name=names, position=[0.5, 0.8, -0.6, 0.4, 0.5, 0.3])
    return message


def check_plan(response: PlanJoint.Response) -> PlanJoint.Response:
    """Return `response` if it holds a trajectory, else stop."""
    if response.error_code or len(response.trajectory.points) < 2:
        raise SystemExit(f"no plan, code {response.error_code}: {response.error_msg}")
    return response


@dataclass(frozen=True)
class Trip:
    """A service whose round trip is measured, and how often it is called."""

    node: str
    kind: Any
    service: str
    request: Any
    check: Callable[[Any], Any]
    calls: int


def round_trips(caller: Caller, trip: Trip) -> dict[str, list[float]]:
    """Return the microseconds of calls to our node and to the bare server, taken in turn."""
    microseconds: dict[str, list[float]] = {"ours": [], "bare": []}
    with running(*node_command(trip.node)) as process, tempfile.NamedTemporaryFile() as canned:
        clients = {"ours": caller.node.create_client(trip.kind, f"{trip.node}/{trip.service}")}
        caller.wait(clients["ours"], process)
        canned.write(serialize_message(trip.check(caller.call(clients["ours"], trip.request))))
        canned.flush()
        server = str(Path(__file__).with_name("bare_server.py"))
        kind = trip.kind.__name__
        with running(sys.executable, server, kind, canned.name) as process:
            clients["bare"] = caller.node.create_client(trip.kind, f"bare/{kind}")
            caller.wait(clients["bare"], process)
            for index in range(WARM_CALLS + trip.calls):
                for name, client in clients.items():
                    begin = time.perf_counter_ns()
                    caller.call(client, trip.request)
                    elapsed = (time.perf_counter_ns() - begin) / 1e3
                    # What one does after its answer must not slow the other.
                    time.sleep(PAUSE_SECONDS)
                    if index >= WARM_CALLS:
                        microseconds[name].append(elapsed)
    return microseconds


def all_round_trips(caller: Caller) -> dict[str, dict[str, list[float]]]:
    """Return the quartiles of the round trips of both services, in microseconds."""
    trips = (
        Trip("kinematics", SolveIK, "solve_ik", request(), check, CALLS),
        Trip("trajectory_planner", PlanJoint, "plan_joint", plan_request(), check_plan, PLAN_CALLS),
    )
    return {
        trip.kind.__name__: {
            name: statistics.quantiles(values, n=4)
            for name, values in round_trips(caller, trip).items()
        }
        for trip in trips
    }


def cycles(caller: Caller) -> dict[str, dict[str, float]]:
    """Return how regular cycles are on one core: of the moving controller, and of bare timers."""
    rate = f"publish_rate:={controller_cycles.RATE}"
    bare = (sys.executable, str(Path(__file__).with_name("bare_timer.py")))
    commands = {
        "ours": (*node_command(controller_cycles.CONTROLLER), "-p", rate),
        "single": (*bare, "single"),
        "events": (*bare, "events"),
    }
    rounds: dict[str, list[Any]] = {name: [] for name in commands}
    cores: dict[str, list[float]] = {name: [] for name in commands}
    names = list(commands)
    for turn in range(controller_cycles.ROUNDS):
        for name in names[turn % len(names) :] + names[: turn % len(names)]:
            with running(*controller_cycles.on_one_core(commands[name])) as process:
                watcher = controller_cycles.Watcher(caller.node, caller.executor, load_robot(ROBOT))
                stamps, core = watched(watcher, process)
                watcher.close()
            rounds[name].append(stamps)
            cores[name].append(core)
    return {
        name: asdict(controller_cycles.regularity(rounds[name], statistics.mean(cores[name])))
        for name in commands
    }


def watched(
    watcher: controller_cycles.Watcher, process: subprocess.Popen[bytes]
) -> tuple[Any, float]:
    """Return the stamps of a process's cycles, and the share of a core that it took meanwhile."""
    watcher.wait(lambda: process.poll() is None)
    before, begin = cpu_seconds(process.pid), time.monotonic()
    stamps = watcher.measure()
    return stamps, (cpu_seconds(process.pid) - before) / (time.monotonic() - begin)


def servo(caller: Caller) -> dict[str, float]:
    """Return how fast the servo follows commands, with the simulated robot beside it."""
    controller = node_command(controller_cycles.CONTROLLER)
    with running(*controller), running(*node_command("servo")) as process:
        operator = servo_latency.Operator(caller.node, caller.executor)
        return asdict(operator.measure(lambda: process.poll() is None))


def batch_chunks() -> list[SolveIKBatch.Request]:
    """Return requests for all solutions of BATCH_POSES poses, CHUNK in each."""
    chain = load_robot(ROBOT)
    q = np.random.default_rng(6).uniform(-np.pi, np.pi, (BATCH_POSES, chain.n))
    positions, quaternions = position_quaternion_from_pose(forward_kinematics(chain, q))
    rows = np.concatenate((positions, quaternions), axis=1)
    return [
        SolveIKBatch.Request(poses=array.array("d", part.tobytes()), ignore_limits=True)
        for part in np.split(rows, BATCH_POSES // CHUNK)
    ]


def batches(caller: Caller) -> dict[str, Any]:
    """Return the seconds that all solutions of BATCH_POSES poses take, and the node's memory."""
    chunks, seconds, solutions = batch_chunks(), [], 0
    with running(*node_command("kinematics")) as process:
        client = caller.node.create_client(SolveIKBatch, "kinematics/solve_ik_batch")
        caller.wait(client, process)
        for _ in range(BATCHES):
            begin = time.perf_counter()
            answers = [caller.call(client, chunk) for chunk in chunks]
            seconds.append(time.perf_counter() - begin)
            solutions = sum(len(answer.position_errors) for answer in answers)
        if any(answer.error_code for answer in answers) or solutions < BATCH_POSES:
            raise SystemExit(f"the batches were answered with {solutions} solutions")
        return {
            "seconds": seconds,
            "solutions": solutions,
            "megabytes": most_megabytes(process.pid),
        }


def most_megabytes(pid: int) -> float:
    """Return the most memory that process `pid` ever had resident, in units of 10^6 bytes."""
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    most = next(line for line in lines if line.startswith("VmHWM:"))
    return int(most.split()[1]) * 1024 / 1e6


def wait_for_all(caller: Caller) -> None:
    """Wait until every node of the suite has brought its services up."""
    deadline = time.monotonic() + PATIENCE
    wanted = {f"/{node}/{service}" for node, service in SERVICES.items()}
    while missing := wanted - {name for name, _ in caller.node.get_service_names_and_types()}:
        if time.monotonic() > deadline:
            raise SystemExit(f"no service {', '.join(sorted(missing))} after {PATIENCE:g} s")
        time.sleep(0.1)


def idle_loads(caller: Caller) -> dict[str, Load]:
    """Return what each node of the suite costs while nobody calls it."""
    with contextlib.ExitStack() as stack:
        processes = {name: stack.enter_context(running(*node_command(name))) for name in SERVICES}
        wait_for_all(caller)
        time.sleep(SETTLE_SECONDS)
        before = {name: cpu_seconds(process.pid) for name, process in processes.items()}
        begin = time.perf_counter()
        time.sleep(IDLE_SECONDS)
        elapsed = time.perf_counter() - begin
        return {
            name: Load(
                resident_megabytes(process.pid), (cpu_seconds(process.pid) - before[name]) / elapsed
            )
            for name, process in processes.items()
        }


def cpu_seconds(pid: int) -> float:
    """Return the processor time, user and system, that process `pid` has used."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def resident_megabytes(pid: int) -> float:
    """Return the resident memory of process `pid`, in units of 10^6 bytes."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def main() -> None:
    """Measure everything and print one JSON object."""
    rclpy.init()
    caller = Caller()
    try:
        starts = start_seconds(caller)
        trips = all_round_trips(caller)
        regularity = cycles(caller)
        latency = servo(caller)
        batch = batches(caller)
        loads = idle_loads(caller)
    finally:
        caller.node.destroy_node()
        rclpy.try_shutdown()
    print(
        json.dumps(
            {
                "start_seconds": starts,
                "round_trips": trips,
                "cycles": regularity,
                "servo": latency,
                "batch": batch,
                "idle": {name: asdict(load) for name, load in loads.items()},
            }
        )
    )


if __name__ == "__main__":
    main()
