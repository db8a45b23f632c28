"""``robomech warmup``: compile all kernels, or load them from the cache."""

import argparse
import gc
import logging
import os
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from contextlib import ExitStack
from functools import partial
from graphlib import TopologicalSorter
from importlib import import_module
from multiprocessing import get_context
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from robomech_ros._kernels.compiling.sources import PACKAGE, sources
from robomech_ros.cli.kernel_cache import compiled, prune
from robomech_ros.errors import RobomechError
from robomech_ros.robots import load_robot
from robomech_ros.robots.robot_kinds import ARM, KINDS, check_name, kind_of

_INSTALLATION = Path(__file__).resolve().parents[1]

_REDUNDANT = tuple(
    f"inverse.redundant.{name}"
    for name in ("arm_angle", "crossings", "nearest", "samples", "settling", "solutions", "tracing")
)
_ANALYSIS = (
    *("chain.jacobian_rates", "dynamics.controlled_chain", "dynamics.dry_friction"),
    *(f"kinetostatics.{name}" for name in ("indices", "posture_factors", "posture_report")),
)
# Demonstrations of an arm beside the usual one.
OBSTACLES, FLOATING = "obstacles", "floating"
# Kernels that only some demonstrations use, by the kind of robot: folders and modules.
_USED_BY = {
    OBSTACLES: ("collision",),
    FLOATING: ("dynamics.floating",),
    "parallel": ("parallel", "loops", *_ANALYSIS),
    "rolling": ("rolling", *_ANALYSIS),
    "walking": ("walking", "loops", "dynamics.floating", *_ANALYSIS),
    "hand": ("hands", "kinetostatics.rates", *_ANALYSIS),
    "calibration": ("calibration", *_ANALYSIS),
}
_SPECIAL = {
    *("servo", "dynamics.derivatives", "dynamics.regressor", "inverse.cheapest_moves"),
    *("spatial.points", *_REDUNDANT),
}.union(*_USED_BY.values())

# Seconds.
_NOTICEABLE = 1.5
_QUICK = 5.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--quiet", action="store_true", help="print only failures")
    parser.add_argument(
        "--robot", help="compile only the kernels for the demonstration of this robot"
    )


def kernel_modules() -> tuple[str, ...]:
    """List the modules with kernels; importing one compiles it or loads it from the cache."""
    return sources().modules()


def demonstration_modules(robot: str, kind: str) -> tuple[str, ...]:
    """List the modules with kernels that the demonstration of a robot uses."""
    used = {*_USED_BY.get(kind, ()), *(_REDUNDANT if _is_redundant(robot) else ())}
    unused = tuple(f"{name}." for name in _SPECIAL - used)
    return tuple(name for name in kernel_modules() if not f"{name}.".startswith(unused))


def _is_redundant(robot: str) -> bool:
    """Return whether a robot is an arm of more than six joints."""
    try:
        return load_robot(robot).n > 6
    except RobomechError:
        # No arm, or one that the demonstration refuses.
        return False


def run(args: argparse.Namespace) -> int:
    """Import kernel modules with progress; returns 0."""
    chosen = None
    if args.robot is not None:
        check_name(args.robot, (ARM, *KINDS))
        chosen = demonstration_modules(args.robot, kind_of(args.robot))
    warm(chosen, silent=args.quiet)
    return 0


def warm(
    modules: Iterable[str] | None = None, *, silent: bool = False, silent_if_quick: bool = False
) -> None:
    """Compile kernels, or load them from the cache.

    - ``modules``: modules with kernels; default all.
    - ``silent``: say nothing.
    - ``silent_if_quick``: say nothing where hardly anything had to be compiled.
    """
    # Numba is slow to load, and most commands do not need it.
    from robomech_ros._kernels.compiling.cache import cache_directory

    start = time.perf_counter()
    digests = {name: sources().digest(name) for name in modules or kernel_modules()}
    place = cache_directory()
    known = compiled(place) if place else set(digests.values())
    stale = [name for name, digest in digests.items() if digest not in known]
    progress = _bar if sys.stdout.isatty() and not silent else _plain
    if stale:
        progress(_compiled_in_parallel(stale), len(stale), silent)
    else:
        progress(((name, _import(name)) for name in digests), len(digests), silent)
    if place is not None and any(place.glob("*.nbi")):
        prune(place, _INSTALLATION, digests.values())
    seconds = time.perf_counter() - start
    if not silent and not (silent_if_quick and seconds < _QUICK):
        kept = place or "nowhere: there is no place that you alone can write"
        print(f"{len(digests)} kernel modules in {seconds:.1f} s, kept in {kept}")


def _compiled_in_parallel(modules: Sequence[str]) -> Iterator[tuple[str, float]]:
    """Fill the cache from as many processes as there are cores, each module after what it needs.

    What kernels have inline is compiled once in each process, so that a process goes on with
    modules that need what it has, and others do not.  Among these the one is next that most
    remains to be done after.
    """
    cores = min(os.cpu_count() or 1, len(modules))
    needs = {name: sources().imported(name).intersection(modules) for name in modules}
    remaining = _remaining(needs)
    order = TopologicalSorter(needs)
    order.prepare()
    ready: set[str] = set()
    running: dict[Future[float], tuple[str, int]] = {}
    has: list[set[str]] = [set() for _ in range(cores)]

    def choice(process: int, name: str) -> tuple[int, int]:
        """Return how many more of its modules this process has than the others, and the rest."""
        known = [len(sources().closure(name) & own) for own in has]
        return (cores * known[process] - sum(known), remaining[name])

    with ExitStack() as stack:
        make = partial(ProcessPoolExecutor, 1, get_context("spawn"), initializer=_start_worker)
        pools = [stack.enter_context(make()) for _ in range(cores)]
        free = set(range(cores))
        while order.is_active():
            ready.update(order.get_ready())
            while ready and free:
                process = free.pop()
                name = max(ready, key=partial(choice, process))
                ready.remove(name)
                has[process] |= sources().closure(name)
                running[pools[process].submit(_import, name)] = name, process
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                name, process = running.pop(future)
                free.add(process)
                order.done(name)
                yield name, future.result()


def _remaining(needs: dict[str, frozenset[str]]) -> dict[str, int]:
    """Return the length of all that has to wait for each module, one after the other, with its own.

    The length of its source says well enough how long a module takes.
    """
    remaining: dict[str, int] = {}
    for name in reversed(tuple(TopologicalSorter(needs).static_order())):
        waiting = (remaining[other] for other in remaining if name in needs[other])
        remaining[name] = sources().path(name).stat().st_size + max(waiting, default=0)
    return remaining


def _start_worker() -> None:
    """Prepare a process that compiles and does nothing else."""
    # Its message on kernels to be compiled was printed here.
    logging.disable(logging.WARNING)
    gc.set_threshold(50_000, 20, 100)
    _hash_options_faster()


def _hash_options_faster() -> None:
    """Make numba look up the options of a compilation directly, instead of through properties.

    It hashes all of them for every call whose types it infers, a sixth of the whole time.
    """
    from numba.core.targetconfig import TargetConfig

    def values(self: TargetConfig) -> dict[str, object]:
        chosen = self._values
        return {name: chosen.get(name, option.default) for name, option in self.options.items()}

    if all(hasattr(TargetConfig(), name) for name in ("values", "options", "_values")):
        TargetConfig.values = values


def _import(name: str) -> float:
    before = time.perf_counter()
    import_module(f"{PACKAGE}.{name}")
    return time.perf_counter() - before


def _plain(compiled: Iterator[tuple[str, float]], total: int, silent: bool) -> None:
    """Say a line for every module that took a noticeable time."""
    for index, (name, seconds) in enumerate(compiled, start=1):
        if seconds > _NOTICEABLE and not silent:
            print(f"[{index}/{total}] {name}: {seconds:.1f} s", flush=True)


def _bar(compiled: Iterator[tuple[str, float]], total: int, silent: bool) -> None:
    """Show a bar that names the module that was compiled last."""
    columns = (
        TextColumn("compiling kernels"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.description}"),
    )
    with Progress(*columns, console=Console(), transient=True) as progress:
        task = progress.add_task("", total=total)
        for name, _ in compiled:
            progress.update(task, description=name)
            progress.advance(task)
