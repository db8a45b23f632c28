"""Where parallel robots are found by name; nothing is compiled for that."""

from __future__ import annotations

from pathlib import Path

from robomech_ros.robots import robot_folders

__all__ = ["SUFFIXES", "list_parallel", "parallel_files"]

SUFFIXES = (".yaml", ".yml")


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
    found: dict[str, Path] = {}
    for folder in robot_folders():
        try:
            entries = sorted((folder / "parallel").iterdir())
        except OSError:
            continue
        for path in entries:
            if path.suffix in SUFFIXES and path.is_file():
                found.setdefault(path.stem, path)
    return found
