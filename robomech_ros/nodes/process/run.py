"""Start, spinning, hold and end of every node of this package.

Exit codes: 0 after SIGINT or SIGTERM, 2 when the node cannot start (with one line on stderr that
says why), 1 after an unexpected failure (with its traceback).  A node that is done but held by its
middleware is ended by SIGALRM.
"""

import gc
import inspect
import os
import queue
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.exceptions import ROSInterruptException
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.cooperative_wait import steady_timer
from robomech_ros.nodes.common.parameters import table_rows
from robomech_ros.nodes.process.entry_points import EXIT_CANNOT_START
from robomech_ros.nodes.process.memory import (
    bound_heaps,
    bound_memory,
    give_back_regularly,
    settle_pages,
)
from robomech_ros.nodes.process.simulated_clock import watch_for_simulated_time

EXIT_FAILED = 1

# How long the nodes may take to hold and to answer their clients.
_STOP_SECONDS = 3.0
_DELIVERY_SECONDS = 0.1
# Threads of Fast DDS may wait for each other when peers leave at the same time (its issue 6502).
_FAREWELL_SECONDS = 5.0
# How often to look after a node's start for others of its name, s, and how many times: discovery
# takes its time.
LOOK_PERIOD, _LOOKS = 1.0, 3
_SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Spinner:
    """Spins nodes in a thread of its own until stopped.

    An exception in a callback is logged, and the nodes go on serving.

    - ``nodes``: each may offer ``stop()``, plain or async, which runs in the spinning thread before
      the end: hold the robot, abort goals.
    - ``context``: default the global one.
    """

    def __init__(self, nodes: Iterable[Node], context: Context | None = None) -> None:
        self._nodes = tuple(nodes)
        # Not the experimental EventsExecutor: while a coroutine waits it polls without a pause (a
        # whole core, in Kilted and Jazzy), and Jazzy's does not await async services at all.
        self._executor = SingleThreadedExecutor(context=context)
        for node in self._nodes:
            self._executor.add_node(node)
        self._stopping = False
        self._thread = threading.Thread(target=self._spin, name="spin", daemon=True)
        self._on_end: Callable[[], Any] = lambda: None

    def start(self, on_end: Callable[[], Any] = lambda: None) -> None:
        """Start to spin; `on_end` is called when spinning ends for whatever reason."""
        self._on_end = on_end
        self._thread.start()

    def stop(self) -> None:
        """Stop every node, deliver its last messages, and end the thread."""
        if self._thread.is_alive():
            # A task also wakes the executor, which returns only when it had work to do.
            self._executor.create_task(self._stop_nodes)
            self._thread.join(_STOP_SECONDS)
        self._stopping = True
        self._executor.shutdown(timeout_sec=0)
        if self._thread.ident is not None:
            self._thread.join(_STOP_SECONDS)

    async def _stop_nodes(self) -> None:
        for node in self._nodes:
            try:
                result = node.stop() if hasattr(node, "stop") else None
                if inspect.isawaitable(result):
                    await result
            except Exception:
                node.get_logger().error(f"stop failed:\n{traceback.format_exc()}")
        self._stopping = True

    def _spin(self) -> None:
        try:
            while not self._stopping and self._executor.context.ok():
                self._spin_once()
            self._deliver()
        finally:
            self._on_end()

    def _deliver(self) -> None:
        """Wait until the results that stop() caused have been sent."""
        if not any(hasattr(node, "stop") for node in self._nodes):
            return
        deadline = time.monotonic() + _DELIVERY_SECONDS
        while self._executor.context.ok() and (left := deadline - time.monotonic()) > 0.0:
            self._spin_once(left)

    def _spin_once(self, timeout: float | None = None) -> None:
        try:
            self._executor.spin_once(timeout)
        except (ExternalShutdownException, ROSInterruptException):
            self._stopping = True
        except Exception as error:
            if isinstance(error, rclpy_implementation.RCLError) and not self._executor.context.ok():
                # The context ended while something was made in it.
                self._stopping = True
                return
            text = f"a callback failed, please report this:\n{traceback.format_exc()}"
            self._nodes[0].get_logger().error(text)


def _signal_events() -> "queue.SimpleQueue[None]":
    """Take SIGINT and SIGTERM at any time, and return the queue that gets an event for each."""
    # put() of a SimpleQueue is safe inside a signal handler.
    events: queue.SimpleQueue[None] = queue.SimpleQueue()
    for number in _SIGNALS:
        signal.signal(number, lambda *_: events.put(None))
    return events


def run_node(factory: Callable[[], Node], args: Sequence[str] | None = None) -> int:
    """Run one node until SIGINT or SIGTERM; returns the exit code of the process.

    - ``factory``: the node's class. Its attribute ``SETTINGS``, the table of parameters, serves
      ``--help``.
    - ``args``: command line with the program's name; default ``sys.argv``.
    """
    return run_nodes([factory], args)


def run_nodes(factories: Sequence[Callable[[], Node]], args: Sequence[str] | None = None) -> int:
    """Run several nodes in one process and one executor; see :func:`run_node`."""
    argv = list(sys.argv if args is None else args)
    program = os.path.basename(argv[0])
    try:
        rest = remove_ros_args(argv)[1:]
    except Exception as error:
        return _start_failed(program, error)
    if "-h" in rest or "--help" in rest:
        # Who has read enough of it may have gone.
        with suppress(BrokenPipeError):
            print("\n\n".join(_help(program, factory) for factory in factories))
        return 0
    if rest:
        return _refuse(program, f"unknown argument {rest[0]!r}; see --help")
    signals = _signal_events()
    bound_memory()
    bound_heaps()
    nodes: list[Node] = []
    try:
        rclpy.init(args=argv, signal_handler_options=SignalHandlerOptions.NO)
        for factory in factories:
            if not signals.empty():
                return _end(nodes, 0)
            nodes.append(factory())
    except Exception as error:
        return _end(nodes, _start_failed(program, error))
    watch_for_duplicate_nodes(nodes)
    watch_for_simulated_time(nodes)
    settle_pages()
    give_back_regularly()
    # Present objects stay, so garbage collection of them would only cause pauses.
    gc.freeze()
    spinner = Spinner(nodes)
    spinner.start(on_end=lambda: signals.put(None))
    signals.get()
    spinner.stop()
    return _end(nodes, 0)


def watch_for_duplicate_nodes(nodes: Sequence[Node]) -> None:
    """Log once, soon after the start, which nodes were in this domain and namespace already."""
    if not nodes:
        return
    said, first = set[str](), nodes[0]
    looks = iter(range(_LOOKS))

    def look() -> None:
        if next(looks) == _LOOKS - 1:
            timer.cancel()
        found = [
            f"{namespace.rstrip('/')}/{name}"
            for name, namespace in first.get_node_names_and_namespaces()
        ]
        for node in nodes:
            name = node.get_fully_qualified_name()
            if found.count(name) > 1 and name not in said:
                said.add(name)
                text = (
                    f"another node '{name}' is in this domain: both answer the same services and "
                    "move the same topics. End one of them, or set ROS_DOMAIN_ID, or a namespace "
                    "(robomech bringup --namespace). One that was killed is seen for up to 20 s"
                )
                node.get_logger().error(text)

    timer = steady_timer(first, LOOK_PERIOD, look)


def _start_failed(program: str, error: Exception) -> int:
    """Say why the nodes cannot start; returns the exit code."""
    # Errors of rclpy about arguments, names and remappings are for users.
    expected = isinstance(error, RobomechError | OSError)
    if expected or type(error).__module__.split(".")[0] in ("rclpy", "_rclpy_pybind11"):
        return _refuse(program, str(error))
    traceback.print_exception(error)
    return EXIT_FAILED


def _refuse(program: str, reason: str) -> int:
    print(f"{program}: {' '.join(reason.split())}", file=sys.stderr, flush=True)
    return EXIT_CANNOT_START


def _end(nodes: Iterable[Node], code: int) -> int:
    # From here on a second signal, such as a terminal's beside a parent's, must not disturb.
    for number in _SIGNALS:
        signal.signal(number, signal.SIG_IGN)
    gc.unfreeze()
    with _ended_by_alarm(_FAREWELL_SECONDS):
        for node in nodes:
            node.destroy_node()
        rclpy.try_shutdown()
    return code


@contextmanager
def _ended_by_alarm(seconds: float) -> Iterator[None]:
    """End this process where the body takes longer, even if it never lets go of the interpreter.

    Whoever uses the alarm in this process already keeps it.
    """
    free = signal.getsignal(signal.SIGALRM) == signal.SIG_DFL
    if free:
        signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        if free:
            signal.setitimer(signal.ITIMER_REAL, 0.0)


def _help(program: str, factory: Callable[[], Node]) -> str:
    lines = [
        f"usage: {program} [--ros-args [-p NAME:=VALUE] [-r FROM:=TO] [--params-file FILE] ...]",
        "",
        (factory.__doc__ or program).strip().splitlines()[0],
        "",
        "parameters:",
    ]
    for row in table_rows(getattr(factory, "SETTINGS", object)):
        fixed = "" if row.read_only else ", may change at run time"
        lines.append(f"  {row.name} (default {row.default!r}; {row.allowed}{fixed})")
        lines.append(f"      {row.description}")
    return "\n".join(lines)
