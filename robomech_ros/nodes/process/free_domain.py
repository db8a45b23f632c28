"""ROS domains that no other test or demonstration on this machine uses at the same time."""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from robomech_ros.errors import RobomechError
from robomech_ros.fastdds_shared_memory import FOLDER, dead_ports, ports_of_domain

# High enough to be nobody's choice by hand, low enough to be a valid domain everywhere.
_DOMAINS = range(70, 100)


class NoFreeDomainError(RobomechError):
    """Every domain of ours is in use."""

    def __init__(self) -> None:
        super().__init__(f"all ROS domains from {_DOMAINS[0]} to {_DOMAINS[-1]} are in use here")


@contextmanager
def free_domain() -> Iterator[int]:
    """Reserve a ROS domain, among all users of this machine.

    What is reserved is the name of a socket without a file: nobody can plant a link in its place,
    and the operating system frees it however the process ends.  Ports of Fast DDS that killed
    processes left in the domain are removed.

    Raises NoFreeDomainError: no domain is free.
    """
    first = os.getpid() % len(_DOMAINS)
    for number in (*_DOMAINS[first:], *_DOMAINS[:first]):
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as reservation:
            try:
                reservation.bind(f"\0robomech-domain-{number}")
            except OSError:
                continue
            for port in dead_ports(ports_of_domain(number)):
                for file in FOLDER.glob(f"*fastdds_port{port}*"):
                    with suppress(OSError):
                        file.unlink()
            yield number
            return
    raise NoFreeDomainError
