"""``robomech warmup``: compile all kernels, or load them from the cache."""

import argparse
import ast
import logging
import os
import sys
import time
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from graphlib import TopologicalSorter
from importlib import import_module
from multiprocessing import get_context
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from robomech_ros.cli.kernel_cache import prune

__all__ = ["add_arguments", "kernel_modules", "run", "warm"]

PACKAGE = "robomech_ros._kernels"
_FOLDER = Path(__file__).resolve().parents[1] / "_kernels"

# Seconds.
_NOTICEABLE = 1.5
_QUICK = 5.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--quiet", action="store_true", help="say nothing unless it fails")


def kernel_modules() -> tuple[str, ...]:
    """List the modules with kernels; importing one compiles it or loads it from the cache."""
    return tuple(
        sorted(
            ".".join(file.relative_to(_FOLDER).with_suffix("").parts)
            for file in _FOLDER.rglob("*.py")
            if file.name != "__init__.py"
        )
    )


def run(args: argparse.Namespace) -> int:
    """Import every kernel module with progress; returns 0."""
    warm(silent=args.quiet)
    return 0


def warm(silent: bool = False, silent_if_quick: bool = False) -> None:
    """Compile all kernels, or load them from the cache.

    Parameters
    ----------
    silent : bool, optional
        Say nothing.
    silent_if_quick : bool, optional
        Say nothing where hardly anything had to be compiled.
    """
    # Numba is slow to load, and most commands do not need it.
    from robomech_ros._kernels.compiling.cache import cache_directory

    start = time.perf_counter()
    modules, place = kernel_modules(), cache_directory()
    cold = place is not None and not any(place.glob("*.nbi"))
    compiled = _compiled_in_parallel(modules) if cold else _imported(modules)
    progress = _bar if sys.stdout.isatty() and not silent else _plain
    progress(compiled, len(modules), silent)
    if place is not None and any(place.glob("*.nbi")):
        prune(place, _FOLDER)
    seconds = time.perf_counter() - start
    if not silent and not (silent_if_quick and seconds < _QUICK):
        kept = place or "nowhere: no place to keep them is writable"
        print(f"{len(modules)} kernel modules in {seconds:.1f} s, kept in {kept}")


def _imported(modules: tuple[str, ...]) -> Iterator[tuple[str, float]]:
    """Import the modules here; gives each with the seconds that it took."""
    for name in modules:
        yield name, _import(name)


def _compiled_in_parallel(modules: tuple[str, ...]) -> Iterator[tuple[str, float]]:
    """Fill the cache from as many processes as there are cores, each module after what it needs."""
    order = TopologicalSorter({name: _needs(name, modules) for name in modules})
    order.prepare()
    running: dict[Future[float], str] = {}
    with ProcessPoolExecutor(
        os.cpu_count(),
        get_context("spawn"),
        # What a process says of a cache that it finds empty was said here.
        initializer=logging.disable,
        initargs=(logging.WARNING,),
    ) as pool:
        while order.is_active():
            running.update((pool.submit(_import, name), name) for name in order.get_ready())
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                name = running.pop(future)
                order.done(name)
                yield name, future.result()


def _needs(name: str, modules: tuple[str, ...]) -> set[str]:
    """List the kernel modules that a kernel module imports."""
    tree = ast.parse((_FOLDER / f"{name.replace('.', '/')}.py").read_text(encoding="utf-8"))
    needed = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            needed.update([node.module, *(f"{node.module}.{entry.name}" for entry in node.names)])
    return {other for other in modules if f"{PACKAGE}.{other}" in needed}


def _import(name: str) -> float:
    """Import a kernel module; gives the seconds that it took."""
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
