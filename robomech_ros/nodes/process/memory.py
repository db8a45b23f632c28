"""The memory of a process that talks ROS: bounded, and given back when nobody uses it any more."""

import ctypes
import os
import resource
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress

# Largest size of a process's data, bytes; all nodes in one process have 1 GB.
LARGEST_DATA = 3_000_000_000
# Memory reserved by NumPy and SciPy for each processor without use, bytes.
_EACH_PROCESSOR = 90_000_000
# The most heaps of all threads, and the sizes (bytes) from which on a block has no place in a heap,
# and the free end of a heap goes back to the system.
_HEAPS, _LARGE_BLOCK, _FREE_END = 2, 1_000_000, 4_000_000
# Numbers of the parameters of mallopt of the GNU C library.
_TRIM_THRESHOLD, _MMAP_THRESHOLD, _ARENA_MAX = -1, -3, -8
# How often memory is given back, s.  It takes about 1 ms of processor time, without the
# interpreter's lock.
PERIOD = 15.0


def bound_memory(largest: int = LARGEST_DATA) -> None:
    """Limit the memory of this process, unless the user has set a lower limit.

    Fast CDR believes the length of a list in a request or an answer: a few corrupt bytes announce
    93 million poses, for which a node took all memory of the machine, silent for minutes.  Such a
    list is refused by the bound, and the bytes are passed over.

    - ``largest``: largest size of the data of the process (bytes), without the memory that
      libraries reserve for each processor.
    """
    largest += _EACH_PROCESSOR * (os.cpu_count() or 1)
    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    if soft == resource.RLIM_INFINITY or soft > largest:
        with suppress(OSError, ValueError):
            resource.setrlimit(resource.RLIMIT_DATA, (largest, hard))


def bound_heaps() -> None:
    """Share two heaps among all threads of this process, without large blocks.

    The GNU C library gives each thread of the middleware a heap of its own.  Messages of long
    trajectories, made by one thread and freed by another, leave holes in all of them: 50 MB in
    move_group with ten clients.  Call it before threads begin.  Other C libraries are left alone.
    """
    try:
        adjust = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError):
        return
    for parameter, value in (
        (_ARENA_MAX, _HEAPS),
        (_MMAP_THRESHOLD, _LARGE_BLOCK),
        (_TRIM_THRESHOLD, _FREE_END),
    ):
        adjust(parameter, value)


@contextmanager
def bounded_memory(largest: int = LARGEST_DATA) -> Iterator[None]:
    """Bound the memory of this process as `bound_memory` does, while the body runs."""
    before = resource.getrlimit(resource.RLIMIT_DATA)
    bound_memory(largest)
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, before)


def give_back_regularly(period: float = PERIOD) -> threading.Event:
    """Trim all heaps of this process every period (s), until the returned event is set.

    Every thread that allocates has a heap, and a burst of large requests leaves holes in several;
    the GNU C library returns none of them by itself.  Other C libraries are left alone.
    """
    over = threading.Event()
    try:
        trim = ctypes.CDLL(None).malloc_trim
    except (OSError, AttributeError):
        return over
    trim.argtypes = (ctypes.c_size_t,)

    def work() -> None:
        while not over.wait(period):
            trim(0)

    threading.Thread(target=work, name="trim", daemon=True).start()
    return over
