"""Plots of ways on the ground."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from robomech_ros.errors import WrongSizeError
from robomech_ros.plotting.pictures import new_figure, save
from robomech_ros.typing import Array

_WIDTH, _HEIGHT, _REST = 5.2, 4.6, 0.6
# Headings that are drawn on a way, and their length in its size.
_HEADINGS, _LENGTH = 24, 0.06


def plot_paths(
    path: str | Path,
    names: Sequence[str],
    wanted: Sequence[Array],
    driven: Sequence[Array],
    *,
    title: str = "",
) -> Path:
    """Write a picture of ways on the ground, each with the one that was wanted.

    Parameters
    ----------
    names : sequence of str
        k ways.
    wanted : sequence of ndarray, shape (m, 2)
        Where each was to go: x, y (m).
    driven : sequence of ndarray, shape (n, 3)
        Where it went: x, y (m) and heading (rad), which lines show.

    Raises
    ------
    WrongSizeError
        Not as many ways as names, or one that has another shape.
    """
    for what, ways, columns in (("wanted", wanted, 2), ("driven", driven, 3)):
        if len(ways) != len(names):
            raise WrongSizeError(what, len(ways), f"{len(names)}, one for each name")
        for way in ways:
            if way.ndim != 2 or way.shape[1] != columns or not len(way):
                raise WrongSizeError(what, way.shape, f"(n, {columns})")
    figure = new_figure(_WIDTH * len(names), _REST + _HEIGHT)
    axes = np.atleast_1d(figure.subplots(1, len(names)))
    for ax, name, aim, way in zip(axes, names, wanted, driven, strict=True):
        ax.plot(*aim.T, color="0.75", linewidth=5.0, label="wanted")
        ax.plot(way[:, 0], way[:, 1], color="tab:blue", linewidth=1.4, label="driven")
        at = way[np.linspace(0, len(way) - 1, _HEADINGS).astype(int)]
        far = _LENGTH * float(np.ptp(aim, axis=0).max())
        for x, y, heading in at:
            ends = far * np.array([np.cos(heading), np.sin(heading)])
            ax.plot([x, x + ends[0]], [y, y + ends[1]], color="tab:orange", linewidth=1.2)
        ax.plot(*way[0, :2], "o", color="black", markersize=5, label="begin and end")
        ax.set_title(name, fontsize=10)
        ax.set_xlabel("x (m)")
        ax.set_aspect("equal")
        ax.grid(visible=True, color="0.9")
    axes[0].set_ylabel("y (m)")
    axes[0].plot([], [], color="tab:orange", linewidth=1.2, label="heading")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False, fontsize=8)
    return save(figure, path, title=title)
