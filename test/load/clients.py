"""Client processes that call the same service at the same time."""

from __future__ import annotations

import multiprocessing
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection

from caller import Burst, Task, serve_tasks

__all__ = ["Clients", "client_processes"]

CLIENTS = 4


class Clients:
    """Some processes, each with a node of its own.

    Parameters
    ----------
    pipes : list of Connection
        One to each.
    """

    def __init__(self, pipes: list[Connection]) -> None:
        self._pipes = pipes

    def call(self, name: str, kind: str, count: int) -> Burst:
        """Have all of them call at the same time, so many calls altogether."""
        share, rest = divmod(count, len(self._pipes))
        for number, pipe in enumerate(self._pipes):
            pipe.send(Task(name, kind, share + (number < rest)))
        for pipe in self._pipes:
            pipe.recv()
        for pipe in self._pipes:
            pipe.send("begin")
        burst = Burst()
        for pipe in self._pipes:
            burst.add(pipe.recv())
        return burst


@contextmanager
def client_processes(robot: str) -> Iterator[Clients]:
    """Start the clients of a robot's suite, in the domain of this process, and end them."""
    start = multiprocessing.get_context("spawn")
    pipes, processes = [], []
    for seed in range(CLIENTS):
        here, there = start.Pipe()
        process = start.Process(target=serve_tasks, args=(there, robot, seed), daemon=True)
        process.start()
        there.close()
        pipes.append(here)
        processes.append(process)
    try:
        yield Clients(pipes)
        for pipe in pipes:
            pipe.send(None)
        for process in processes:
            process.join()
    finally:
        for process in processes:
            process.kill()
