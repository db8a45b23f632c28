"""``robomech warmup``: compile all kernels, or load them from the cache."""

import argparse
import sys
import time
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

__all__ = ["add_arguments", "kernel_modules", "run", "warm"]

PACKAGE = "robomech_ros._kernels"

# Seconds.
_NOTICEABLE = 1.5
_QUICK = 5.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--quiet", action="store_true", help="say nothing unless it fails")


def kernel_modules() -> tuple[str, ...]:
    """List the modules with kernels; importing one compiles it or loads it from the cache."""
    folder = Path(__file__).resolve().parents[2] / "_kernels"
    return tuple(sorted(module.name for module in iter_modules([str(folder)])))


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
    start = time.perf_counter()
    modules = kernel_modules()
    progress = _bar if sys.stdout.isatty() and not silent else _plain
    for name in progress(modules, silent):
        import_module(f"{PACKAGE}.{name}")
    seconds = time.perf_counter() - start
    if not silent and not (silent_if_quick and seconds < _QUICK):
        from robomech_ros._kernels._jit import cache_directory

        place = cache_directory() or "nowhere: no place to keep them is writable"
        print(f"{len(modules)} kernel modules in {seconds:.1f} s, kept in {place}")


def _plain(modules: tuple[str, ...], silent: bool) -> Iterator[str]:
    """Say a line for every module that took a noticeable time."""
    for index, name in enumerate(modules, start=1):
        before = time.perf_counter()
        yield name
        seconds = time.perf_counter() - before
        if seconds > _NOTICEABLE and not silent:
            print(f"[{index}/{len(modules)}] {name}: {seconds:.1f} s", flush=True)


def _bar(modules: tuple[str, ...], silent: bool) -> Iterator[str]:
    """Show a bar that names the module being compiled."""
    columns = (
        TextColumn("compiling kernels"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.description}"),
    )
    with Progress(*columns, console=Console(), transient=True) as progress:
        task = progress.add_task("", total=len(modules))
        for name in modules:
            progress.update(task, description=name)
            yield name
            progress.advance(task)
