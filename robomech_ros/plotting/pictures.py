"""Basis of all plots: matplotlib, if it is installed, and a new figure."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from robomech_ros.errors import RobomechError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DPI = 110


class PlottingUnavailableError(RobomechError):
    """matplotlib is not installed."""

    def __init__(self) -> None:
        super().__init__("plots need matplotlib: pip install matplotlib")


def new_figure(width: float, height: float, **options: Any) -> "Figure":
    """Make a figure that belongs to no window.

    Parameters
    ----------
    width, height : float
        In inches.
    **options
        Of matplotlib's figure.

    Raises
    ------
    PlottingUnavailableError
        matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise PlottingUnavailableError from None
    settings: dict[str, Any] = {"dpi": _DPI, "layout": "constrained"} | options
    return Figure(figsize=(width, height), **settings)


def save(figure: "Figure", path: str | Path, *, title: str = "") -> Path:
    """Write a figure with its title to a file; gives the file."""
    figure.suptitle(title)
    figure.savefig(path)
    return Path(path)
