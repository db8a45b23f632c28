"""The libraries that compute distances and sample paths: optional, and loaded on first use."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from typing import Any

from robomech_ros.errors import RobomechError

# Planners of OMPL that need only a check of motions.  PRM and PRMstar would wait for ever: their
# own thread asks Python whether time is up.
PLANNERS = (
    "RRTConnect",
    "RRT",
    "RRTstar",
    "InformedRRTstar",
    "BITstar",
    "FMT",
    "BFMT",
    "KPIECE1",
    "BKPIECE1",
    "LBKPIECE1",
)
# All plans of a process share the random numbers of OMPL.
_lock = threading.Lock()


class MissingLibraryError(RobomechError):
    """A library that collisions need is not installed."""


@cache
def coal() -> Any:
    """Return the module of coal."""
    return _loaded("coal")


@cache
def ompl() -> Any:
    """Return the module of OMPL, its log lowered to errors."""
    module = _loaded("ompl")
    for part in ("base", "geometric", "util"):
        import_module(f"ompl.{part}")
    module.util.setLogLevel(module.util.LogLevel.LOG_NONE)
    return module


def _loaded(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError:
        why = f"collisions need {name}: pip install 'robomech_ros[collision]'"
        raise MissingLibraryError(why) from None


@contextmanager
def seeded(seed: int) -> Iterator[None]:
    """Seed OMPL for one plan; other users in the process get different numbers afterwards."""
    generator = ompl().util.RNG
    with _lock:
        later = generator().getLocalSeed()
        generator.setSeed(seed)
        try:
            yield
        finally:
            generator.setSeed(later)
