"""Available memory, so that requests that would not fit are rejected at once."""

import os
import re
import sys
from pathlib import Path

from robomech_ros.errors import NotEnoughMemoryError

_MEMINFO = Path("/proc/meminfo")
# Memory limit and use of a container.
_ALLOWED = Path("/sys/fs/cgroup/memory.max")
_USED = Path("/sys/fs/cgroup/memory.current")


def available_memory() -> int:
    """Tell how many bytes can be taken without swapping, by this machine or container."""
    free = _free_on_machine()
    try:
        return max(0, min(free, int(_ALLOWED.read_text()) - int(_USED.read_text())))
    except (OSError, ValueError):  # no container, or one without a limit
        return free


def check_memory(what: str, needed: int) -> None:
    """Refuse what needs more bytes than there are; ``what`` names it in the message."""
    available = available_memory()
    if needed > available:
        raise NotEnoughMemoryError(what, needed, available)


def _free_on_machine() -> int:
    try:
        found = re.search(r"^MemAvailable:\s+(\d+) kB", _MEMINFO.read_text(), re.MULTILINE)
    except OSError:
        found = None
    if found:
        return 1024 * int(found[1])
    if not hasattr(os, "sysconf"):  # Windows
        return sys.maxsize
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
