"""Nodes as child processes: started together, watched together, ended together."""

import ctypes
import os
import queue
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping, Sequence
from typing import IO

from robomech_ros.stop_signals import STOP_SIGNALS

# Longer than a node takes at the most to hold its robot and say goodbye.
_STOP_SECONDS = 12.0
_PR_SET_PDEATHSIG = 1


def node_command(node: str, ros_args: Sequence[str] = ()) -> list[str]:
    """Return the command line of a node's process."""
    tail = ["--ros-args", *ros_args] if ros_args else []
    return [sys.executable, "-m", "robomech_ros.nodes.process.entry_points", node, *tail]


class ProcessGroup:
    """Child processes that end together, also when this process dies.

    They start with :data:`STOP_SIGNALS` blocked, and unblock them as soon as they can answer them:
    what comes before is not lost and does no harm.

    - ``commands``: name to command line.
    - ``environment``: variables to set on top of the present ones.
    - ``log``: file for both output streams of the children; default those of this process.
    """

    def __init__(
        self,
        commands: Mapping[str, Sequence[str]],
        environment: Mapping[str, str] | None = None,
        log: IO[bytes] | None = None,
    ) -> None:
        self._ended: queue.SimpleQueue[tuple[str, int]] = queue.SimpleQueue()
        self.processes: dict[str, subprocess.Popen[bytes]] = {}
        for name, command in commands.items():
            self.processes[name] = subprocess.Popen(
                command,
                env={**os.environ, **(environment or {})},
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT if log else None,
                # In a session of their own the children see a terminal's Ctrl-C only from here.
                start_new_session=True,
                preexec_fn=_prepare_child,
            )
        for name, process in self.processes.items():
            threading.Thread(target=self._watch, args=(name, process), daemon=True).start()

    def _watch(self, name: str, process: "subprocess.Popen[bytes]") -> None:
        self._ended.put((name, process.wait()))

    def interrupt_wait(self) -> None:
        """Make `wait_for_end` return None; may be called in a signal handler."""
        self._ended.put(("", 0))

    def wait_for_end(self) -> tuple[str, int] | None:
        """Wait until the next process ends; gives its name and exit code."""
        name, code = self._ended.get()
        return (name, code) if name else None

    def dead(self) -> dict[str, int]:
        """Return names and exit codes of the processes that have ended."""
        codes = {name: process.poll() for name, process in self.processes.items()}
        return {name: code for name, code in codes.items() if code is not None}

    def stop(self) -> dict[str, int]:
        """End all processes as Ctrl-C would, by force after a while; gives their exit codes.

        A node that has done all of its own, and that SIGALRM ended because its middleware did not,
        counts as a clean end; stderr mentions it.
        """
        for process in self.processes.values():
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
        for process in self.processes.values():
            try:
                process.wait(_STOP_SECONDS)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        codes = self.dead()
        for name in [name for name, code in codes.items() if code == -signal.SIGALRM]:
            print(f"{name}: the middleware did not let it go; it was ended", file=sys.stderr)
            codes[name] = 0
        return codes


def _prepare_child() -> None:
    """Hold back signals, and ask the kernel, where it can, to end this child with its parent."""
    signal.pthread_sigmask(signal.SIG_BLOCK, STOP_SIGNALS)
    try:
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
    except (OSError, AttributeError):
        return
