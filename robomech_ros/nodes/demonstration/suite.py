"""The suite as child processes, in a ROS domain of their own on this machine only."""

import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.process.free_domain import free_domain
from robomech_ros.nodes.process.process_group import ProcessGroup

_LOG_LINES = 30


class DemoFailedError(RobomechError):
    """A step of the demonstration went wrong; the text says which and why."""


@dataclass(frozen=True)
class Suite:
    """The running nodes and what they have said."""

    group: ProcessGroup
    domain: int
    log: Path

    @property
    def says(self) -> str:
        """Its processes and their domain, in words."""
        names = self.group.processes
        each = "each a process" if len(names) > 1 else "a process"
        return f"{each} of its own in ROS domain {self.domain}: {', '.join(names)}"

    def check(self) -> None:
        """Raise where a node has ended."""
        for name, code in self.group.dead().items():
            raise DemoFailedError(f"node {name} ended by itself with exit code {code}")

    def last_words(self) -> str:
        """Return the last lines of what the nodes have logged."""
        lines = self.log.read_text(encoding="utf-8", errors="replace").splitlines()
        return "\n".join(lines[-_LOG_LINES:])


@contextmanager
def running_suite(commands: Mapping[str, Sequence[str]]) -> Iterator[Suite]:
    """Start the nodes, and stop them at the end whatever happens.

    The variables that choose domain and discovery range are set in this process, too, so that
    processes that it starts next discover these nodes only.
    """
    with (
        free_domain() as domain,
        tempfile.NamedTemporaryFile(prefix="robomech-demo-", suffix=".log") as log,
    ):
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
        group = ProcessGroup(commands, log=log)
        suite = Suite(group, domain, Path(log.name))
        try:
            yield suite
        except BaseException:
            group.stop()
            raise
        failed = {name: code for name, code in group.stop().items() if code}
        if failed:
            name, code = failed.popitem()
            text = f"node {name} ended with exit code {code} when asked to stop"
            raise DemoFailedError(f"{text}; last words of the nodes:\n{suite.last_words()}")
