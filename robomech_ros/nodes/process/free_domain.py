"""ROS domains that no other test or demonstration on this machine uses at the same time."""

import fcntl
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from robomech_ros.errors import RobomechError

__all__ = ["NoFreeDomainError", "free_domain"]

# High enough to be nobody's choice by hand, low enough to be a valid domain everywhere.
_DOMAINS = range(70, 100)


class NoFreeDomainError(RobomechError):
    """Every domain of ours is in use."""

    def __init__(self) -> None:
        super().__init__(f"all ROS domains from {_DOMAINS[0]} to {_DOMAINS[-1]} are in use here")


@contextmanager
def free_domain() -> Iterator[int]:
    """Reserve a ROS domain; a lock of the operating system frees it whatever happens.

    Raises
    ------
    NoFreeDomainError
        There is none left.
    """
    first = os.getpid() % len(_DOMAINS)
    for number in (*_DOMAINS[first:], *_DOMAINS[:first]):
        path = Path(tempfile.gettempdir()) / f"robomech-domain-{os.getuid()}-{number}"
        with path.open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                continue
            yield number
            return
    raise NoFreeDomainError
