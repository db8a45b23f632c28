"""Resources of processes: memory, open files, threads."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Usage"]

_LINE = re.compile(r"^(Rss|Pss|Anonymous):\s+(\d+) kB", re.MULTILINE)
_KILOBYTE = 1024.0
_MEGABYTE = 1e6


@dataclass(frozen=True)
class Usage:
    """Resources of a process at one moment.

    Attributes
    ----------
    own : float
        Memory that belongs to no file (MB): what the process has allocated.  Code that is read
        again from its file, and dropped again, is not in it.
    shared : float
        The proportional set size (MB): shared pages count by the number of processes.
    resident : float
        All that is resident (MB).
    files, threads : int
        Open file descriptors, and threads.
    """

    own: float
    shared: float
    resident: float
    files: int
    threads: int

    @classmethod
    def of(cls, process: int) -> Usage:
        """Look at a process."""
        place = Path(f"/proc/{process}")
        sizes = {
            name: int(kilobytes) * _KILOBYTE / _MEGABYTE
            for name, kilobytes in _LINE.findall((place / "smaps_rollup").read_text())
        }
        return cls(
            sizes["Anonymous"],
            sizes["Pss"],
            sizes["Rss"],
            len(list((place / "fd").iterdir())),
            len(list((place / "task").iterdir())),
        )

    def __str__(self) -> str:
        return (
            f"own {self.own:6.1f} MB, PSS {self.shared:6.1f} MB, RSS {self.resident:6.1f} MB, "
            f"{self.files:3d} files, {self.threads:2d} threads"
        )
