"""Plots of several quantities over time, one panel each."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robomech_ros.errors import WrongSizeError
from robomech_ros.plotting.pictures import new_figure, save
from robomech_ros.typing import Array

_WIDTH, _HEIGHT, _REST = 10.0, 2.2, 0.65


class Panel(NamedTuple):
    """One quantity over time.

    Parameters
    ----------
    label : str
        Label of the axis, with the unit.
    names : sequence of str
        Names of the k curves.
    values : ndarray, shape (m, k)
        Values of the curves at the m times; NaN leaves a gap.
    """

    label: str
    names: Sequence[str]
    values: Array


def plot_panels(
    path: str | Path,
    times: Array,
    panels: Sequence[Panel],
    *,
    title: str = "",
    marks: Sequence[tuple[float, str]] = (),
) -> Path:
    """Write a picture of panels, one below the other.

    Parameters
    ----------
    path : str or Path
        The picture; its ending (png, svg, pdf) gives the format.
    times : ndarray, shape (m,)
        Times of the values (s).
    panels : sequence of Panel
    title : str, optional
        Title above the picture.
    marks : sequence of (float, str), optional
        Instants (s) to be marked, each with its label.

    Returns
    -------
    Path
        Path of the picture.

    Raises
    ------
    PlottingUnavailableError
        matplotlib is not installed.
    WrongSizeError
        The values of a panel do not fit times and names.
    """
    for panel in panels:
        wanted = (len(times), len(panel.names))
        if panel.values.shape != wanted:
            raise WrongSizeError(panel.label, panel.values.shape, wanted)
    figure = new_figure(_WIDTH, _REST + _HEIGHT * len(panels))
    axes = np.atleast_1d(figure.subplots(len(panels), 1, sharex=True))
    for ax, panel in zip(axes, panels, strict=True):
        for name, curve in zip(panel.names, panel.values.T, strict=True):
            ax.plot(times, curve, linewidth=1.4, label=name)
        ax.set_ylabel(panel.label)
        ax.grid(visible=True, color="0.9")
        ax.margins(x=0.01)
        ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=8)
    draw_marks(axes, marks)
    axes[-1].set_xlabel("time (s)")
    return save(figure, path, title=title)


def draw_marks(axes: NDArray, marks: Sequence[tuple[float, str]]) -> None:
    """Draw a line at each instant in all diagrams, and its label in the first."""
    for instant, label in marks:
        for ax in axes:
            ax.axvline(instant, color="0.6", linewidth=0.8, linestyle=":")
        axes[0].annotate(
            label, (instant, 1.0), xycoords=("data", "axes fraction"), xytext=(3, -11),
            textcoords="offset points", fontsize=8, color="0.4",
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0},
        )  # fmt: skip
