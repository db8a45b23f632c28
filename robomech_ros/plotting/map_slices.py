"""Slices through maps of reach and dexterity."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.kinetostatics import ReachMap
from robomech_ros.numerics.arrays import real_number
from robomech_ros.plotting.pictures import new_figure, save
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.typing import Array

# Drawable measures, and labels of the scale.
QUANTITIES = {
    "dexterity": "share of the orientations reached",
    "solutions": "postures in all orientations",
    "condition": "1 / least condition number",
    "conditioning": "mean of 1 / condition number",
}
_AXES = "xyz"
# Width of each picture and height of all, in inches.
_WIDTH, _HEIGHT = 4.6, 4.4


def plot_map(
    path: str | Path,
    reach: ReachMap,
    *,
    quantity: str = "dexterity",
    axis: str | None = None,
    at: float | None = None,
    title: str | None = None,
) -> Path:
    """Write a picture of slices through a map.

    Parameters
    ----------
    reach : ReachMap
        What is not computed yet stays white.
    quantity : {"dexterity", "solutions", "condition", "conditioning"}, optional
        What is drawn.
    axis : {"x", "y", "z"}, optional
        Which axis of the base the slice is perpendicular to; default each in turn.
    at : float, optional
        Where on that axis (m), the nearest layer of the grid; default the middle layer.
    title : str, optional
        Above the picture; default robot and tip.

    Raises
    ------
    BadValueError
        An unknown quantity or axis, a place without an axis, or one that is outside the grid.
    """
    label = QUANTITIES[as_choice("quantity", quantity, tuple(QUANTITIES))]
    if at is not None and axis is None:
        raise BadValueError("at", at, "an axis as well: x, y or z")
    chosen = tuple(_AXES) if axis is None else (as_choice("axis", axis, tuple(_AXES)),)
    layers = [(_AXES.index(name), _layer(reach, _AXES.index(name), at)) for name in chosen]
    values = _values(reach, quantity)
    figure = new_figure(_WIDTH * len(layers) + 1.0, _HEIGHT)
    pictures = np.atleast_1d(figure.subplots(1, len(layers)))
    for picture, (normal, layer) in zip(pictures, layers, strict=True):
        image = _draw_slice(picture, reach, values, normal, layer)
    figure.colorbar(image, ax=pictures, label=label)
    known = f"{reach.robot.name}, {reach.robot.tip}" if title is None else title
    return save(figure, path, title=known)


def _draw_slice(picture: Any, reach: ReachMap, values: Array, normal: int, layer: int) -> Any:
    """Draw the layer of this number perpendicular to an axis; gives the image."""
    largest = float(np.nanmax(values)) if np.isfinite(values).any() else 1.0
    across, up = (i for i in range(3) if i != normal)
    picture.set_xlabel(f"{_AXES[across]} (m)")
    picture.set_ylabel(f"{_AXES[up]} (m)")
    picture.set_title(f"{_AXES[normal]} = {reach.grid.axes[normal][layer]:.4g} m")
    return picture.imshow(
        np.take(values, layer, axis=normal).T,
        origin="lower",
        extent=(*_span(reach.grid.axes[across]), *_span(reach.grid.axes[up])),
        vmin=0.0,
        vmax=largest if largest > 0.0 else 1.0,
        interpolation="nearest",
    )


def _layer(reach: ReachMap, normal: int, at: float | None) -> int:
    places = reach.grid.axes[normal]
    if at is None:
        return len(places) // 2
    low, high = _span(places)
    expected = f"a place in the grid: {_AXES[normal]} from {places[0]:g} to {places[-1]:g} m"
    place = real_number("at", at, expected)
    if not low <= place <= high:
        raise BadValueError("at", at, expected)
    return int(np.abs(places - place).argmin())


def _values(reach: ReachMap, quantity: str) -> Array:
    """Return what is drawn, (nx, ny, nz), NaN where there is nothing to draw."""
    if quantity == "dexterity":
        return reach.dexterity
    if quantity == "solutions":
        return np.where(reach.reached < 0, np.nan, reach.solutions)
    return 1.0 / reach.condition_number if quantity == "condition" else reach.conditioning


def _span(places: Array) -> tuple[float, float]:
    """Return from where to where the cells around these points go (m)."""
    half = 0.5 * (places[1] - places[0]) if len(places) > 1 else 0.05
    return float(places[0] - half), float(places[-1] + half)
