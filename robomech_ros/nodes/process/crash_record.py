"""Record of a process for its successor, in case it is killed."""

import fcntl
import hashlib
import os
import struct
import time
import zlib
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from rclpy.node import Node

from robomech_ros.nodes.process.runtime_folder import open_private, runtime_folder

# Most bytes that are written down.
LARGEST = 65_536
_MARK = b"robomech"
# The mark, whose it is, when it was written (ns since the machine started), its length, its sum.
_HEAD = struct.Struct("<8s32sQII")
_CLOCK = getattr(time, "CLOCK_BOOTTIME", time.CLOCK_MONOTONIC)
_NANO = 1e-9
# A file may be removed by the process before while it is opened.
_ATTEMPTS = 5


@dataclass(frozen=True)
class LeftBehind:
    """Record of a killed process.

    Attributes
    ----------
    data : bytes
        Its last words.
    age : float
        How long ago it wrote them, s.
    """

    data: bytes
    age: float


class CrashRecord:
    """A small file that outlives a process that is killed, and no other.

    The system keeps what was written, without waiting for a disk, and frees the lock on the file,
    whatever becomes of the process.

    Parameters
    ----------
    name : str
        What the file is called first.
    identity : sequence of str
        Who may read it: the record of another identity is another file.

    Attributes
    ----------
    left : LeftBehind or None
        What was found; None where the process before ended in good order.
    fault : str
        Why what was found is not used; empty where nothing is wrong.

    Raises
    ------
    OSError
        The file or its folder is not safe, or another process that lives has it.
    """

    def __init__(self, name: str, identity: tuple[str, ...]) -> None:
        self._key = hashlib.sha256("\0".join(identity).encode()).digest()
        self._path = runtime_folder() / f"{name}-{self._key.hex()[:32]}"
        self._descriptor = _locked(self._path)
        self.fault = ""
        self.left = self._read()

    def write(self, data: bytes) -> None:
        """Write down what the next process is to know, instead of what was there.

        Raises
        ------
        OSError
            There is no space left, or the like.
        ValueError
            It is longer than `LARGEST`, or the record is closed.
        """
        if len(data) > LARGEST or self._descriptor < 0:
            raise ValueError(f"{len(data)} bytes, allowed are {LARGEST} in an open record")
        now = time.clock_gettime_ns(_CLOCK)
        head = _HEAD.pack(_MARK, self._key, now, len(data), zlib.crc32(data))
        # A single call: a signal comes before or after it.
        os.pwrite(self._descriptor, head + data, 0)

    def close(self) -> None:
        """Remove the file: this process ends in good order.  Once is enough."""
        if self._descriptor >= 0:
            descriptor, self._descriptor = self._descriptor, -1
            with suppress(OSError):
                self._path.unlink()
            os.close(descriptor)

    def _read(self) -> LeftBehind | None:
        found = os.pread(self._descriptor, _HEAD.size + LARGEST, 0)
        if not found:
            return None
        self.fault = f"'{self._path}' has something else than a node writes there"
        if len(found) < _HEAD.size:
            return None
        mark, key, written, length, total = _HEAD.unpack_from(found)
        data = found[_HEAD.size : _HEAD.size + length]
        if (mark, key, length) != (_MARK, self._key, len(data)) or zlib.crc32(data) != total:
            return None
        self.fault = ""
        age = (time.clock_gettime_ns(_CLOCK) - written) * _NANO
        # What is from the future was written before the machine was started anew.
        return LeftBehind(data, age) if age >= 0.0 and data else None


def open_crash_record(node: Node, name: str, identity: tuple[str, ...]) -> CrashRecord | None:
    """Open the record of a node in its domain; log why there is none.

    Parameters
    ----------
    node : Node
        Whose record it is; its domain and its full name belong to the identity.
    name : str
        What the file is called first.
    identity : tuple of str
        What else has to be the same for the next process to read it.
    """
    domain = str(node.context.get_domain_id())
    whole = (domain, node.get_fully_qualified_name(), *identity)
    logger = node.get_logger()
    try:
        record = CrashRecord(name, whole)
    except BlockingIOError:
        logger.warning(f"another node of this name keeps its {name}: this one keeps none")
        return None
    except OSError as error:
        logger.warning(f"the {name} is not kept: '{error.filename}': {error.strerror or error}")
        return None
    if record.fault:
        logger.warning(f"the {name} that was kept is not used: {record.fault}")
    return record


def _locked(path: Path) -> int:
    """Open and lock the file that is at a place; returns its descriptor."""
    for _ in range(_ATTEMPTS):
        descriptor = open_private(path)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            with suppress(FileNotFoundError):
                if os.path.samestat(os.fstat(descriptor), path.lstat()):
                    return descriptor
        except BaseException:
            os.close(descriptor)
            raise
        os.close(descriptor)
    raise BlockingIOError(None, "it is removed again and again", str(path))
