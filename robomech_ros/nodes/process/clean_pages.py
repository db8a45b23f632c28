"""Give back pages of libraries that a node needs only while it starts, such as the compiler's."""

import ctypes
import mmap
import re
from pathlib import Path

_MAPPINGS = Path("/proc/self/smaps")
# Code and constants of a file, and what the kernel says of their pages.
_OF_FILE = re.compile(r"^([0-9a-f]+)-([0-9a-f]+) r-[x-]p \S+ \S+ \d+ +/.*\n((?:[A-Z].*\n)+)", re.M)
_UNCHANGED = (re.compile(r"^Anonymous: +0 kB$", re.M), re.compile(r"^Swap: +0 kB$", re.M))


def release_clean_pages() -> int:
    """Drop the unchanged pages of files from this process, 70 MB of them, and trim its heaps.

    LLVM was needed to load the kernels, and many other libraries only to begin.  The kernel reads
    again what is needed again, mostly from its page cache.  Return the released bytes of address
    space, 0 where there is no such thing.
    """
    try:
        mappings = _MAPPINGS.read_text(encoding="utf-8", errors="replace")
        system = ctypes.CDLL(None)
        system.madvise.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
    except (OSError, AttributeError):
        return 0
    getattr(system, "malloc_trim", lambda padding: 0)(0)
    released = 0
    for first, last, facts in _OF_FILE.findall(mappings):
        # What was changed, such as relocated addresses, would be lost.
        if all(fact.search(facts) for fact in _UNCHANGED):
            start, end = int(first, 16), int(last, 16)
            if system.madvise(start, end - start, mmap.MADV_DONTNEED) == 0:
                released += end - start
    return released
