"""Files of parallel robots by name, found without compiling anything."""

from __future__ import annotations

from pathlib import Path

from robomech_ros.robots.robot_kinds import documents_of, names_of


def list_parallel() -> tuple[str, ...]:
    """List the names of the parallel robots in all folders, sorted.

    Examples
    --------
    >>> from robomech_ros.parallel import list_parallel
    >>> "delta" in list_parallel()
    True
    """
    return names_of("parallel")


def parallel_files() -> dict[str, Path]:
    """Find the file of each parallel robot, by name."""
    return documents_of("parallel")
