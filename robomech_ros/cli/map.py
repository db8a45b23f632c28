"""``robomech map``: which orientations an arm can take where, and how well."""

import argparse
import math
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from robomech_ros.errors import BadValueError, MapFileError
from robomech_ros.kinematics.posture_samples import reach_bound
from robomech_ros.kinetostatics import (
    ReachMap,
    load_reach_map,
    reach_map,
    uniform_rotations,
    uniform_turns,
)
from robomech_ros.robots import SerialChain, load_description
from robomech_ros.robots.documents.numbers_in_text import integer, number
from robomech_ros.spatial import matrix_from_quaternion
from robomech_ros.typing import Array

_POINTS = 21
_ORIENTATIONS = 64


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--robot", required=True, help="name, or path of a URDF or YAML file")
    parser.add_argument("--base-link", default="", help="first link of the chain")
    parser.add_argument("--tip-link", default="", help="last link of the chain")
    xyz: dict[str, Any] = {"nargs": 3, "type": float, "metavar": ("X", "Y", "Z")}
    parser.add_argument(
        "--lower", **xyz, help="box corner in the base, m; default: the cube that holds all reach"
    )
    parser.add_argument("--upper", **xyz, help="opposite corner, m")
    points = parser.add_mutually_exclusive_group()
    points.add_argument("--spacing", type=number, help="distance between points, m")
    points.add_argument(
        "--shape", nargs=3, type=integer, metavar=("NX", "NY", "NZ"),
        help=f"number of points along each axis ({_POINTS})",
    )  # fmt: skip
    parser.add_argument(
        "--orientations", type=integer, default=_ORIENTATIONS, metavar="N",
        help=f"evenly distributed orientations per point ({_ORIENTATIONS})",
    )  # fmt: skip
    parser.add_argument(
        "--about", **xyz, help="distribute orientations over rotations about this axis of the base"
    )
    parser.add_argument(
        "--orientation", nargs=4, type=number, metavar=("QX", "QY", "QZ", "QW"),
        help="orientation of the tip in the base: the only one, or the first with --about",
    )  # fmt: skip
    parser.add_argument("--ignore-limits", action="store_true", help="also beyond joint limits")
    parser.add_argument(
        "--part", default="pose", help="what to map: pose, position or orientation (pose)"
    )
    parser.add_argument(
        "--length", type=number,
        help="length that scales orientation errors to metres (the characteristic length)",
    )  # fmt: skip
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--workers", type=integer, help="number of threads (one per processor)")
    where.add_argument(
        "--scheduler", help="address of a Dask scheduler, to compute on many machines"
    )
    parser.add_argument("--output", type=Path, default=Path("map.npz"), help="npz (map.npz)")


def run(args: argparse.Namespace) -> int:
    """Compute the map, or the rest of it; returns 0."""
    chain = load_description(args.robot).chain(args.base_link or None, args.tip_link or None)
    lower, upper = _box(chain, args)
    shape = args.shape if args.shape or args.spacing is not None else _POINTS
    same: dict[str, Any] = {
        name: getattr(args, name) for name in ("spacing", "length", "part", "workers", "scheduler")
    }
    started, busy = time.perf_counter(), time.process_time()
    try:
        with _bar() as progress:
            found = reach_map(
                chain,
                lower,
                upper,
                shape=shape,
                orientations=_orientations(args),
                respect_limits=not args.ignore_limits,
                file=args.output,
                progress=progress,
                **same,
            )
    except KeyboardInterrupt:
        print(f"robomech map: {_kept(args.output, chain)}", file=sys.stderr)
        raise
    seconds = f"{time.perf_counter() - started:.1f} s, {time.process_time() - busy:.1f} s of CPU"
    print(_summary(found, seconds, args.output))
    return 0


def _box(chain: SerialChain, args: argparse.Namespace) -> tuple[list[float], list[float]]:
    """Return the corners of the box: the given ones, or the cube that holds the whole reach."""
    if (args.lower is None) != (args.upper is None):
        lacking = "--lower" if args.lower is None else "--upper"
        raise BadValueError(lacking, None, "both corners of the box, or neither")
    if args.lower is not None:
        return args.lower, args.upper
    reach = reach_bound(chain)
    return [-reach] * 3, [reach] * 3


def _orientations(args: argparse.Namespace) -> Array:
    """Return the orientations (k, 3, 3) that are tried at each point."""
    one = None if args.orientation is None else matrix_from_quaternion(args.orientation)
    if args.about is not None:
        return uniform_turns(args.orientations, args.about, one)
    return uniform_rotations(args.orientations) if one is None else one[None]


@contextmanager
def _bar() -> Iterator[Callable[[int, int], None]]:
    """Show a progress bar on a terminal while the map grows."""
    columns = (
        TextColumn("points"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    console = Console(stderr=True)
    hidden = not console.is_terminal
    with Progress(*columns, console=console, transient=True, disable=hidden) as bar:
        task = bar.add_task("", total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def _kept(path: Path, chain: SerialChain) -> str:
    try:
        found = load_reach_map(path, chain)
    except MapFileError:
        return "interrupted; nothing was finished"
    return (
        f"interrupted; {found.finished:,} of {found.grid.cells:,} points are in {path}: "
        "the same command goes on from there"
    )


def _summary(found: ReachMap, seconds: str, path: Path) -> str:
    """Say in some lines what the map tells."""
    request, grid = found.request, found.grid
    count = len(request.orientations)
    reached, all_round = (found.reached > 0).sum(), (found.reached == count).sum()
    shape = " x ".join(map(str, grid.shape))
    noun = "orientation" if count == 1 else "orientations"
    corner = [", ".join(f"{x:g}" for x in one) for one in (grid.lower, grid.upper)]
    lines = [
        f"{found.robot.name}, {found.robot.base} to {found.robot.tip}: "
        f"{shape} points, {count:,} {noun}, {request.poses:,} poses",
        f"  box               ({corner[0]}) to ({corner[1]}) m",
        f"  points reached    {reached:,} ({reached / grid.cells:.1%}), "
        f"{all_round:,} in all orientations",
        f"  poses reached     {found.share_reached:.1%}",
    ]
    if not math.isnan(found.mean_conditioning):
        lines += [
            f"  condition number  {found.best_condition_number:.4g} at best; "
            f"mean of its reciprocal {found.mean_conditioning:.4g}",
            f"                    of the {request.part}, length {request.length:.4g} m",
        ]
    return "\n".join([*lines, f"  time              {seconds}", f"  file              {path}"])
