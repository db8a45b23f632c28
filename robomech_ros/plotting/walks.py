"""Pictures of walks: the way over the ground with all footholds, and the stability margin."""

from collections.abc import Sequence
from pathlib import Path

from robomech_ros.errors import WrongSizeError
from robomech_ros.plotting.pictures import new_figure, save
from robomech_ros.typing import Array

_WIDTH, _HEIGHT = 12.0, 5.4
_TRUNK, _PLANNED, _BOUND = "black", "0.55", "tab:red"


def plot_walk(
    path: str | Path,
    legs: Sequence[str],
    times: Array,
    way: Array,
    footholds: Sequence[Array],
    margins: Array,
    *,
    bound: float,
    planned: Array,
    title: str = "",
) -> Path:
    """Write a picture of a walk.

    Parameters
    ----------
    legs : sequence of str
        Their names.
    times : ndarray, shape (m,)
        s.
    way : ndarray, shape (m, 2)
        Of the trunk over the ground (m).
    footholds : sequence of ndarray, shape (n, 2)
        Where the foot of each leg has stood (m).
    margins : ndarray, shape (m,)
        Stability margins (m).
    bound : float
        That is kept by them (m).
    planned : ndarray, shape (p, 2)
        The way that was wanted (m).
    """
    m = len(times)
    if way.shape != (m, 2) or margins.shape != (m,) or not m:
        raise WrongSizeError("way and margins", (way.shape, margins.shape), f"({m}, 2) and ({m},)")
    if len(footholds) != len(legs):
        raise WrongSizeError("footholds", (len(footholds),), (len(legs),))
    figure = new_figure(_WIDTH, _HEIGHT)
    ground, over_time = figure.subplots(1, 2, width_ratios=(1.0, 1.1))
    for leg, places in zip(legs, footholds, strict=True):
        ground.plot(*places.T, "o", ms=3.5, alpha=0.75, label=f"foot {leg}")
    ground.plot(*planned.T, "--", color=_PLANNED, linewidth=2.6, label="planned")
    ground.plot(*way.T, color=_TRUNK, linewidth=1.2, label="trunk")
    ground.set_aspect("equal", adjustable="datalim")
    ground.set_xlabel("x (m)")
    ground.set_ylabel("y (m)")
    ground.grid(visible=True, color="0.92")
    ground.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=8)
    over_time.plot(times, 1e3 * margins, linewidth=1.0, label="stability margin")
    over_time.axhline(1e3 * bound, color=_BOUND, linewidth=1.0, linestyle="--", label="its bound")
    over_time.set_xlabel("time (s)")
    over_time.set_ylabel("margin (mm)")
    over_time.margins(x=0.01)
    over_time.grid(visible=True, color="0.92")
    over_time.legend(frameon=False, fontsize=8)
    return save(figure, path, title=title)
