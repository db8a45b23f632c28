"""Ports of Fast DDS in shared memory that killed processes left: a new listener may lose messages.

``fastdds shm clean`` of Fast DDS removes them.
"""

import fcntl
import os
from collections.abc import Container
from pathlib import Path

# The first port of domain 0, and how many a domain has (DDSI-RTPS 2.5, section 9.6.2).
_FIRST_PORT, _PORTS = 7400, 250
# Ports from which Fast DDS takes those for data, in every domain.
PORTS_OF_ALL_DOMAINS = range(7000, _FIRST_PORT)
FOLDER = Path("/dev/shm")
_NAME = "fastdds_port"
# Locks of exclusive and of shared listeners; the system frees them however a process ends.
_LOCKS = ("_el", "_sl")


def ports_of_domain(domain: int) -> range:
    """Return the ports of discovery that belong to a ROS domain."""
    return range(_FIRST_PORT + _PORTS * domain, _FIRST_PORT + _PORTS * (domain + 1))


def dead_ports(ports: Container[int] = range(65536)) -> list[int]:
    """Return those of the ports that exist in shared memory and that no process listens to."""
    files = {file.name.removeprefix(_NAME): file for file in FOLDER.glob(f"{_NAME}*")}
    found = {int(number): file for number, file in files.items() if number.isdecimal()}
    return sorted(port for port in found if port in ports and not _has_listener(found[port]))


def _has_listener(file: Path) -> bool:
    for end in _LOCKS:
        try:
            lock = os.open(f"{file}{end}", os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK)
        except FileNotFoundError:
            continue
        except OSError:
            # Another user's.
            return True
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return True
        finally:
            os.close(lock)
    return False
