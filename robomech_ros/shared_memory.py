"""Fast DDS shared memory files of killed processes: ports, and segments of messages.

A port is a queue by which a participant hears.  Who listens holds a lock, which the operating
system frees however the process ends; the files stay where it was killed.  Who gets such a port
next may lose messages: the killed process may have held its mutex.
"""

import fcntl
import os
import re
import stat
from collections.abc import Container, Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import NamedTuple

# The first port of domain 0, and how many a domain has (DDSI-RTPS 2.5, section 9.6.2).
_FIRST_PORT, _PORTS = 7400, 250
# Where Fast DDS takes the ports for data from, in whatever domain.
PORTS_OF_ALL_DOMAINS = range(7000, _FIRST_PORT)
_FOLDER = Path("/dev/shm")
_PROCESSES = Path("/proc")
# Ports, and segments by their numbers.
_NAME = re.compile(r"fastdds_(?:port(\d{1,5})|[0-9a-f]{16})")
# Locks of who alone listens, and of those who share.
_LOCKS = ("_el", "_sl")


class Leftover(NamedTuple):
    """A port or a segment that no process uses.

    Parameters
    ----------
    name : str
        Of its file.
    port : int or None
        Its number; None for a segment.
    size : int
        Of its file, bytes.
    """

    name: str
    port: int | None
    size: int


def ports_of_domain(domain: int) -> range:
    """Return the ports of discovery that belong to a ROS domain."""
    return range(_FIRST_PORT + _PORTS * domain, _FIRST_PORT + _PORTS * (domain + 1))


def leftovers(ports: Container[int] | None = None) -> list[Leftover]:
    """List what is this user's, and neither listened to nor mapped by any process.

    Processes in containers with processes of their own are seen by their locks only.

    Parameters
    ----------
    ports : container of int, optional
        Ports to look at; by default all, and all segments.

    Returns
    -------
    list of Leftover
        Ports by number, then segments by name.
    """
    found = [one for one in _files() if ports is None or one.port in ports]
    mapped = _mapped() if found else set[tuple[str, int]]()
    free = [one for one in found if _is_free(_FOLDER / one.name, mapped)]
    return sorted(free, key=lambda one: (one.port is None, one.port or 0, one.name))


def remove_leftovers(ports: Container[int] | None = None) -> list[Leftover]:
    """Remove what :func:`leftovers` lists, and say what was removed.

    Nobody can begin to listen to a port while it is removed: we hold its lock meanwhile.  Who has
    begun to send to it keeps it.

    Parameters
    ----------
    ports : container of int, optional
        As for :func:`leftovers`.
    """
    return [one for one in leftovers(ports) if _removed(_FOLDER / one.name)]


def _files() -> Iterator[Leftover]:
    """Find the ports and segments of this user."""
    with suppress(OSError), os.scandir(_FOLDER) as entries:
        for entry in entries:
            if match := _NAME.fullmatch(entry.name):
                with suppress(OSError):
                    facts = entry.stat(follow_symlinks=False)
                    if stat.S_ISREG(facts.st_mode) and facts.st_uid == os.geteuid():
                        port = int(match[1]) if match[1] else None
                        yield Leftover(entry.name, port, facts.st_size)


def _is_free(file: Path, mapped: set[tuple[str, int]]) -> bool:
    """Whether nobody holds a lock of a file, or has mapped it or its mutex."""
    with ExitStack() as held:
        locked = all(_hold(held, _lock(file, end)) for end in _LOCKS)
        return locked and not mapped & {_identity(file), _identity(_mutex(file))}


def _removed(file: Path) -> bool:
    """Remove a file with its locks and its mutex, unless somebody uses it now."""
    aside = file.with_name(f"{file.name}.left")
    with ExitStack() as held:
        # Whoever wants to listen from now on finds the lock taken, and takes another port.
        if not _hold(held, _lock(file, "_sl")) or not _hold(held, _lock(file, "_el"), create=True):
            return False
        try:
            # Whoever opens the port from now on gets a new one; who has opened it is seen.
            file.rename(aside)
            used = bool(_mapped() & {_identity(aside), _identity(_mutex(file))})
            if used:
                with suppress(FileExistsError):
                    file.hardlink_to(aside)
            gone = [aside] if used else [aside, _mutex(file)]
            for left in gone:
                left.unlink(missing_ok=True)
        except OSError:
            return False
        finally:
            for end in _LOCKS:
                with suppress(OSError):
                    _lock(file, end).unlink()
    return not used


def _lock(file: Path, end: str) -> Path:
    return file.with_name(f"{file.name}{end}")


def _mutex(file: Path) -> Path:
    return file.with_name(f"sem.{file.name}_mutex")


def _hold(held: ExitStack, lock: Path, create: bool = False) -> bool:
    """Lock a file as its owner would; False where somebody else holds it, or it is none of ours."""
    flags = os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK | os.O_NOFOLLOW
    try:
        descriptor = os.open(lock, flags | (os.O_CREAT if create else 0), 0o644)
        held.callback(os.close, descriptor)
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        # Its owner may have removed it between the two.
        return os.path.samestat(os.fstat(descriptor), lock.stat(follow_symlinks=False))
    except FileNotFoundError:
        return not create
    except OSError:
        return False


def _identity(file: Path) -> tuple[str, int]:
    """Return device and number of a file as ``/proc`` shows them; of no file what nobody maps."""
    try:
        facts = file.stat(follow_symlinks=False)
    except OSError:
        return "", 0
    return f"{os.major(facts.st_dev):02x}:{os.minor(facts.st_dev):02x}", facts.st_ino


def _mapped() -> set[tuple[str, int]]:
    """Find the files in shared memory that processes have mapped, by device and number."""
    found = set[tuple[str, int]]()
    folder = os.fsencode(_FOLDER)
    for process in _PROCESSES.glob("[0-9]*"):
        with suppress(OSError):
            for line in (process / "maps").read_bytes().splitlines():
                if folder in line:
                    device, number = line.split(maxsplit=5)[3:5]
                    found.add((device.decode(), int(number)))
    return found
