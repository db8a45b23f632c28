"""ROS domains that no other test or demonstration on this machine uses at the same time."""

import fcntl
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from robomech_ros.errors import RobomechError
from robomech_ros.regular_files import open_regular

__all__ = ["NoFreeDomainError", "free_domain"]

# High enough to be nobody's choice by hand, low enough to be a valid domain everywhere.
_DOMAINS = range(70, 100)
# The first port of domain 0, and how many a domain has (DDSI-RTPS 2.5, section 9.6.2).
_FIRST_PORT, _PORTS = 7400, 250
_SHARED_MEMORY = Path("/dev/shm")


class NoFreeDomainError(RobomechError):
    """Every domain of ours is in use."""

    def __init__(self) -> None:
        super().__init__(f"all ROS domains from {_DOMAINS[0]} to {_DOMAINS[-1]} are in use here")


@contextmanager
def free_domain() -> Iterator[int]:
    """Reserve a ROS domain, among all users of this machine.

    What is reserved is the name of a socket without a file: nobody can plant a link in its place,
    and the operating system frees it however the process ends.  What killed processes have left of
    the domain in shared memory is removed.

    Raises
    ------
    NoFreeDomainError
        There is none left.
    """
    first = os.getpid() % len(_DOMAINS)
    for number in (*_DOMAINS[first:], *_DOMAINS[:first]):
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as reservation:
            try:
                reservation.bind(f"\0robomech-domain-{number}")
            except OSError:
                continue
            _clear_shared_memory(number)
            yield number
            return
    raise NoFreeDomainError


def _clear_shared_memory(domain: int) -> None:
    """Remove ports of Fast DDS in shared memory that nobody uses.

    Who gets such a port next would lose messages: the process that was killed may have held its
    mutex.
    """
    first = _FIRST_PORT + _PORTS * domain
    for port in range(first, first + _PORTS):
        name = f"fastdds_port{port}"
        if (_SHARED_MEMORY / name).exists() and not _is_held(_SHARED_MEMORY / f"{name}_el"):
            for left in (f"{name}_el", name, f"sem.{name}_mutex"):
                with suppress(OSError):
                    (_SHARED_MEMORY / left).unlink()


def _is_held(lock: Path) -> bool:
    """Whether a process holds a lock, as that of each port is by who listens there."""
    try:
        with open_regular(lock) as file:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False
    return False
