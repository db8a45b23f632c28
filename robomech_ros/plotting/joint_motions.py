"""Plots of joint motions over time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.plotting.panels import draw_marks
from robomech_ros.plotting.pictures import new_figure, save
from robomech_ros.typing import Array

# Width of a picture, and height of one diagram and of the rest, in inches.
_WIDTH, _HEIGHT, _REST = 10.0, 2.45, 0.65
_LABELS = ("position", "velocity", "acceleration", "jerk")
_UNITS = {False: ("rad", "rad/s", "rad/s²", "rad/s³"), True: ("m", "m/s", "m/s²", "m/s³")}


def plot_motion(
    path: str | Path,
    joint_names: Sequence[str],
    times: Array,
    curves: Sequence[Array],
    *,
    title: str = "",
    prismatic: Sequence[bool] | None = None,
    marks: Sequence[tuple[float, str]] = (),
    limits: Sequence[tuple[Array, Array]] = (),
) -> Path:
    """Write a picture of positions, velocities, accelerations and jerks of joints over time.

    Parameters
    ----------
    joint_names : sequence of str
        n joints, one curve each.
    times : ndarray, shape (m,)
        s.
    curves : sequence of ndarray, shape (m, n)
        Positions, velocities, accelerations, jerks (rad or m, and per s, s^2 and s^3); later ones
        may be left out.
    prismatic : sequence of bool, optional
        Which joints slide; they are marked in the legend.
    marks : sequence of (float, str), optional
        Instants (s) to be marked, each with its label.
    limits : sequence of (ndarray, ndarray), optional
        For each of the curves the least and the largest value allowed, shape (n,); drawn dashed in
        the colour of the joint where they are finite.

    Raises
    ------
    BadValueError, WrongSizeError
        No curve or more than four, or one or its limits whose shape does not fit.
    """
    slides = list(prismatic) if prismatic is not None else [False] * len(joint_names)
    _check(joint_names, times, curves, limits)
    figure = new_figure(_WIDTH, _REST + _HEIGHT * len(curves))
    axes = np.atleast_1d(figure.subplots(len(curves), 1, sharex=True))
    for i, (ax, curve) in enumerate(zip(axes, curves, strict=True)):
        draw_curves(ax, joint_names, times, curve, slides, limits[i] if limits else ())
        units = " or ".join(_UNITS[kind][i] for kind in sorted(set(slides)))
        ax.set_ylabel(f"{_LABELS[i]} ({units})")
    draw_marks(axes, marks)
    axes[-1].set_xlabel("time (s)")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right upper", frameon=False)
    return save(figure, path, title=title)


def draw_curves(
    ax: Any,
    joint_names: Sequence[str],
    times: Array,
    curve: Array,
    slides: Sequence[bool],
    limits: Sequence[Array],
) -> None:
    """Draw one quantity of all joints, with its limits in the joints' colours."""
    for joint, name in enumerate(joint_names):
        label = f"{name} (m)" if slides[joint] and not all(slides) else name
        (line,) = ax.plot(times, curve[:, joint], linewidth=1.4, label=label)
        for bound in (side[joint] for side in limits):
            if np.isfinite(bound):
                ax.axhline(bound, color=line.get_color(), linewidth=0.9, linestyle="--")
    ax.grid(visible=True, color="0.9")
    ax.margins(x=0.01)


def _check(
    joint_names: Sequence[str],
    times: Array,
    curves: Sequence[Array],
    limits: Sequence[tuple[Array, Array]],
) -> None:
    if not 1 <= len(curves) <= len(_LABELS):
        raise BadValueError("number of curves", len(curves), f"1 to {len(_LABELS)}")
    wanted = (len(times), len(joint_names))
    for label, curve in zip(_LABELS, curves, strict=False):
        if curve.shape != wanted:
            raise WrongSizeError(label, curve.shape, wanted)
    if limits and len(limits) != len(curves):
        raise WrongSizeError("limits", len(limits), f"{len(curves)}, a pair for each curve")
    for label, pair in zip(_LABELS, limits, strict=False):
        for bound in pair:
            if bound.shape != (len(joint_names),):
                raise WrongSizeError(f"{label} limits", bound.shape, (len(joint_names),))
