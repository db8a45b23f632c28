"""A plot of the section of a workspace."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from robomech_ros.kinetostatics import Workspace
from robomech_ros.plotting.pictures import new_figure, save
from robomech_ros.typing import Array

# Points of the grid on which postures are counted for the colours, per metre of the larger side.
_GRID = 220
_HEIGHT = 7.0
_COLOURS = ("#ffffff", "#e8f1fa", "#c6dcef", "#a3c6e3", "#7fb0d8")
_STYLES: dict[str, dict[str, Any]] = {
    "outer": {"color": "black", "linewidth": 1.8},
    "inner": {"color": "firebrick", "linewidth": 1.8},
    "interior": {"color": "tab:blue", "linewidth": 1.0},
}
_LABELS = {
    "outer": "boundary",
    "inner": "boundary of a void",
    "interior": "another number of postures",
}


def plot_workspace(path: str | Path, space: Workspace, *, title: str = "") -> Path:
    """Write a picture of a section with its curves, cusps, nodes and numbers of postures.

    Parameters
    ----------
    space : Workspace
    """
    low, high = _corners(space)
    spans = high - low
    width = float(np.clip(_HEIGHT * spans[0] / spans[1], 4.0, 14.0))
    figure = new_figure(width + 2.5, _HEIGHT)
    ax = figure.subplots()
    mesh = _draw_counts(ax, space, low, high)
    bar = figure.colorbar(mesh, ax=ax, ticks=range(len(_COLOURS)), shrink=0.5)
    bar.set_label("postures of the first joints")
    _draw_curves(ax, space)
    ax.set_aspect("equal")
    ax.set_xlabel(f"{space.coordinates[0]} (m)")
    ax.set_ylabel(f"{space.coordinates[1]} (m)")
    figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize=8)
    return save(figure, path, title=title)


def _corners(space: Workspace) -> tuple[Array, Array]:
    """Return the corners (2,) of the picture, with some room around all curves (m)."""
    points = np.concatenate([curve.points for curve in space.curves])
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.06 * (high - low).max()
    low, high = low - margin, high + margin
    if not space.section.slides[0]:
        low[0] = max(low[0], 0.0)
    return low, high


def _draw_counts(ax: Any, space: Workspace, low: Array, high: Array) -> Any:
    """Colour the section by the number of postures; gives the mesh."""
    from matplotlib.colors import BoundaryNorm, ListedColormap

    spans = high - low
    steps = np.maximum((_GRID * spans / spans.max()).astype(int), 2)
    axes = [np.linspace(low[k], high[k], steps[k]) for k in (0, 1)]
    x, y = np.meshgrid(*axes)
    counts = space.section_count(np.stack((x, y), axis=-1))
    levels = np.arange(len(_COLOURS) + 1) - 0.5
    return ax.pcolormesh(
        x, y, np.minimum(counts, len(_COLOURS) - 1), shading="nearest",
        cmap=ListedColormap(_COLOURS), norm=BoundaryNorm(levels, len(_COLOURS)), rasterized=True,
    )  # fmt: skip


def _draw_curves(ax: Any, space: Workspace) -> None:
    """Draw the curves, cusps and nodes; each kind is named once in the legend."""
    named = set()
    for curve in space.curves:
        label = _LABELS[curve.role] if curve.role not in named else None
        named.add(curve.role)
        ax.plot(*curve.points.T, label=label, **_STYLES[curve.role])
    for marked, marker, label in ((space.cusps, "^", "cusp"), (space.nodes, "o", "node")):
        if len(marked):
            ax.plot(*marked.T, marker, color="darkorange", markersize=5, label=label)
