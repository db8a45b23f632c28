"""Printed report of the demonstration."""

import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn
from rich.table import Table

from robomech_ros.nodes.demonstration.suite import DemoFailedError, Suite
from robomech_ros.robots import RobotDescription
from robomech_ros.rvs import Choice, Motion, ViewUnavailableError, write_motion
from robomech_ros.typing import Array

Shown = Callable[[float, Array], None]

_PIPE_WIDTH = 150
# Narrower terminals get two lines a solution.
_TABLE_WIDTH = 130


def listed_numbers(values: Array) -> str:
    """Return numbers with three decimals, separated by spaces."""
    return " ".join(f"{value:.3f}" for value in values)


def _joints(q: Array) -> str:
    return " ".join(f"{value:+.3f}" for value in q)


class TipPath(NamedTuple):
    """A path of the tip."""

    #: Name of the motion.
    name: str
    #: A kind of PlanCartesian, such as ``"STRAIGHT"``.
    path_kind: str
    #: Poses of the tip in the base (m), shape (m, 4, 4).
    waypoints: Array


@dataclass
class Leg:
    """One motion of the demonstration, for the summary."""

    name: str
    profile: str
    duration: float
    peak: float
    position_error: float = math.nan
    orientation_error: float = math.nan


def write_page(path: Path, write: Callable[[Path], object]) -> str:
    """Write a page, and return where it is; or why there is none."""
    try:
        write(path)
    except ViewUnavailableError as error:
        return f"no page: {error}"
    return f"page: {path}"


def write_motion_page(
    output: Path,
    name: str,
    task: str,
    description: RobotDescription,
    motion: Motion,
    trail: str = "",
) -> str:
    """Write the motion of a robot as a page, and return where it is; or why there is none."""
    return write_page(
        output / f"{name}.html",
        lambda path: write_motion(path, description, motion, title=f"{name}: {task}", trail=trail),
    )


def whole_motion(
    robot: RobotDescription,
    times: Array,
    columns: Mapping[str, Array],
    marks: Sequence[tuple[float, str]] = (),
) -> Motion:
    """Return the motion of a whole robot.

    - ``times``: s, shape (m,).
    - ``columns``: joint values (rad or m), shape (m,); joints without any rest.
    - ``marks``: times (s), and what begins there.
    """
    at_rest = robot.joint_positions()
    rows = [columns.get(name, np.full(len(times), at_rest[name])) for name in robot.joint_names]
    choices = tuple(Choice(time, name, "", ()) for time, name in marks)
    return Motion(robot, times, np.column_stack(rows), choices)


class Reporter:
    """Prints to the terminal, or plain lines where there is none; knows when it was made."""

    def __init__(self) -> None:
        self._start = time.perf_counter()
        self._console = Console(highlight=False)
        if not self._console.is_terminal:
            self._console = Console(highlight=False, width=_PIPE_WIDTH)

    def say(self, text: str) -> None:
        """Print a line."""
        self._console.print(text, markup=False)

    def check(self, passed: bool, text: str) -> None:
        """Print the result of a check, or fail with it."""
        if not passed:
            raise DemoFailedError(text)
        self.say(text)

    def up(self, suite: Suite) -> None:
        """Print how long the start took, and of what."""
        self.say(f"up after {time.perf_counter() - self._start:.1f} s, {suite.says}")

    def finish(self, *files: str) -> None:
        """Print which files there are, and how long all of it took."""
        for text in files:
            self.say(text)
        self.say(f"everything worked, in {time.perf_counter() - self._start:.1f} s")

    def heading(self, text: str) -> None:
        """Print a line that begins a part."""
        self._console.print()
        self._console.print(text, style="bold", markup=False)

    def solutions(self, response: Any, chosen: int, shown: Sequence[int]) -> None:
        """Print all solutions of a SolveIK response, the chosen one marked; joints by number."""
        if self._console.width >= _TABLE_WIDTH:
            self._solution_table(response, chosen, shown)
            return
        for i, row in enumerate(_rows(response, shown)):
            style = None if row.inside else "dim"
            mark = "->" if i == chosen else "  "
            self._console.print(
                f" {mark} {' '.join(row.joints)}  distance {row.distance}\n"
                f"    {row.posture}, to limit {row.margin}, condition {row.condition}",
                style=style,
            )

    def _solution_table(self, response: Any, chosen: int, shown: Sequence[int]) -> None:
        table = Table(box=None, padding=(0, 1), header_style="bold")
        # A rich table breaks at spaces, and joints have long names.
        joints = [response.joint_names[k].replace("_", " ") for k in shown]
        for title in ("", "posture", *joints, "to limit", "distance", "condition"):
            words = title in ("", "posture")
            table.add_column(title, justify="left" if words else "right", no_wrap=words)
        for i, row in enumerate(_rows(response, shown)):
            table.add_row(
                "->" if i == chosen else "",
                row.posture,
                *row.joints,
                row.margin,
                row.distance,
                row.condition,
                style=None if row.inside else "dim",
            )
        self._console.print(table)

    def summary(self, legs: list[Leg]) -> None:
        """Print the motions in a table."""
        table = Table(box=None, padding=(0, 1), header_style="bold")
        for title in ("motion", "profile", "duration", "peak velocity", "tip off by", "and by"):
            table.add_column(title, justify="left" if title in ("motion", "profile") else "right")
        for leg in legs:
            table.add_row(
                leg.name,
                leg.profile,
                f"{leg.duration:.2f} s",
                "" if np.isnan(leg.peak) else f"{leg.peak:.0%} of limit",
                f"{leg.position_error * 1e3:.1e} mm",
                f"{leg.orientation_error:.1e} rad",
            )
        self._console.print(table)

    @contextmanager
    def progress(self, name: str, words: Callable[[Array], str] = _joints) -> Iterator[Shown]:
        """Show how far a motion is: a live bar, or a line each quarter.

        - ``name``: name of the motion.
        - ``words``: writes where the robot is; by default joint positions (rad, m).

        Yields a callable that takes how much of the motion is done, 0 to 1, and where the robot is,
        as for ``words``.
        """
        if not self._console.is_terminal:
            yield self._quarters(name, words)
            return
        columns = (
            TextColumn("{task.description}"),
            BarColumn(40),
            TaskProgressColumn(),
            TextColumn("{task.fields[joints]}"),
        )
        with Progress(*columns, console=self._console) as bar:
            task = bar.add_task(name, total=1.0, joints="")

            def show(done: float, q: Array) -> None:
                bar.update(task, completed=done, joints=words(q))

            yield show

    def _quarters(self, name: str, words: Callable[[Array], str]) -> Shown:
        shown = [0]

        def show(done: float, q: Array) -> None:
            # The last of it may be short of 1 by rounding.
            quarter = int(4.0 * done + 1e-3)
            if quarter > shown[0]:
                shown[0] = quarter
                self.say(f"{name} {quarter * 25:3d} %  {words(q)}")

        return show


class _Row(NamedTuple):
    inside: bool
    posture: str
    joints: list[str]
    margin: str
    distance: str
    condition: str


def _rows(response: Any, shown: Sequence[int]) -> Iterator[_Row]:
    for i, point in enumerate(response.solutions):
        margin = response.limit_margins[i]
        yield _Row(
            inside=margin >= 0.0,
            posture=response.branches[i] or f"solution {i + 1}",
            joints=[f"{point.positions[k]:+.3f}" for k in shown],
            margin=f"{margin:.3f}" if margin >= 0.0 else f"{-margin:.3f} outside",
            distance=f"{response.seed_distances[i]:.3f}",
            condition=f"{response.condition_numbers[i]:.1f}",
        )
