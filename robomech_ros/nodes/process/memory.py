"""The memory of a process that talks ROS: bounded, arranged, and given back when it is not used."""

import ctypes
import mmap
import os
import re
import resource
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

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
_MAPPINGS = Path("/proc/self/smaps")
# Code and constants of a file, and what the kernel says of their pages.
_OF_FILE = re.compile(r"^([0-9a-f]+)-([0-9a-f]+) r-[x-]p \S+ \S+ \d+ +/.*\n((?:[A-Z].*\n)+)", re.M)
_UNCHANGED = (re.compile(r"^Anonymous: +0 kB$", re.M), re.compile(r"^Swap: +0 kB$", re.M))
_OF_HEAP = re.compile(r"^([0-9a-f]+)-([0-9a-f]+) rw-p \S+ \S+ \d+ *(?:\[heap\])?$", re.M)
# Linux 6.1 and later, https://docs.kernel.org/admin-guide/mm/transhuge.html; not in `mmap` yet.
_MADV_COLLAPSE = 25
_HUGE_PAGE = 2**21


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


def settle_pages() -> int:
    """Drop the unchanged pages of files, 70 MB of them, and gather the heap in huge pages.

    LLVM was needed to load the kernels, and many other libraries only to begin. The system reads
    again what is needed again, mostly from its page cache. After a pause, a request spends most of
    its time on looking up pages: in huge ones it is answered 15 % sooner, for 4 MB more.

    Returns the released address space (bytes); 0 on systems without such calls.
    """
    try:
        mappings = _MAPPINGS.read_text(encoding="utf-8", errors="replace")
        system = ctypes.CDLL(None)
        system.madvise.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
    except (OSError, AttributeError):
        return 0
    getattr(system, "malloc_trim", lambda padding: 0)(0)
    released = _release_files(mappings, system.madvise)
    _gather_heap(mappings, system.madvise)
    return released


def _release_files(mappings: str, madvise: Callable[[int, int, int], int]) -> int:
    """Drop the unchanged pages of files; return their address space (bytes)."""
    released = 0
    for first, last, facts in _OF_FILE.findall(mappings):
        # Pages with changes, such as relocated addresses, would be lost.
        if all(fact.search(facts) for fact in _UNCHANGED):
            start, end = int(first, 16), int(last, 16)
            if madvise(start, end - start, mmap.MADV_DONTNEED) == 0:
                released += end - start
    return released


def _gather_heap(mappings: str, madvise: Callable[[int, int, int], int]) -> None:
    """Gather the heap in huge pages; the kernel refuses those that are mostly empty."""
    for first, last in _OF_HEAP.findall(mappings):
        start = -(-int(first, 16) // _HUGE_PAGE) * _HUGE_PAGE
        for page in range(start, int(last, 16) - _HUGE_PAGE + 1, _HUGE_PAGE):
            madvise(page, _HUGE_PAGE, _MADV_COLLAPSE)
