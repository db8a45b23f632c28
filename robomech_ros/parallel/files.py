"""Where parallel robots are found by name; nothing is compiled for that."""

from __future__ import annotations

from pathlib import Path

from robomech_ros.robots import robot_folders
from robomech_ros.robots.source_files import SUFFIXES, documents_in

__all__ = ["SUFFIXES", "list_parallel", "parallel_files"]


def list_parallel() -> tuple[str, ...]:
    """List the names of the parallel robots in all folders, sorted.

    Examples
    --------
    >>> from robomech_ros.parallel import list_parallel
    >>> "delta" in list_parallel()
    True
    """
    return tuple(sorted(parallel_files()))


def parallel_files() -> dict[str, Path]:
    """Find the file of each parallel robot, by name."""
    return documents_in(folder / "parallel" for folder in robot_folders())
