"""Pictures of hand-eye calibrations: how the error falls with the samples, and where it lies."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from robomech_ros.errors import WrongSizeError
from robomech_ros.plotting.pictures import new_figure, save
from robomech_ros.typing import Array, BoolArray

_WIDTH, _HEIGHT = 11.0, 6.6
# Radius of the ellipse of 95 % of two normal numbers, in deviations.
_RADIUS_95 = 2.4477
_AXES = "xyz"
_ERROR, _STATED, _WRONG = "tab:blue", "tab:orange", "tab:red"


def plot_calibration(
    path: str | Path,
    counts: Sequence[int],
    errors: Array,
    covariances: Array,
    *,
    residuals: Array,
    inlier: BoolArray,
    title: str = "",
) -> Path:
    """Write a picture of how a calibration gets better with every sample.

    Parameters
    ----------
    counts : sequence of int
        Numbers of samples, m of them.
    errors : ndarray, shape (m, 6)
        Of the sensor's pose with so many samples, as ``spatial.pose_error`` of result and truth
        has it: rotation vector (rad), then position (m).
    covariances : ndarray, shape (m, 6, 6)
        As stated with so many samples, in the same order.
    residuals : ndarray, shape (n, 2)
        Residuals of the samples at the end: rad and m.
    inlier : ndarray of bool, shape (n,)
        False for those that were left out.
    """
    m = len(counts)
    if errors.shape != (m, 6) or covariances.shape != (m, 6, 6) or not m:
        got = (errors.shape, covariances.shape)
        raise WrongSizeError("errors and covariances", got, f"({m}, 6) and ({m}, 6, 6), m > 0")
    if residuals.shape != (len(inlier), 2):
        raise WrongSizeError("residuals", residuals.shape, f"({len(inlier)}, 2)")
    figure = new_figure(_WIDTH, _HEIGHT)
    axes = figure.subplots(2, 3)
    for ax, part, what in (
        (axes[0, 0], slice(3, 6), "position (m)"),
        (axes[0, 1], slice(3), "rotation (rad)"),
    ):
        _draw_progress(ax, counts, errors[:, part], covariances[:, part, part], what)
    _draw_residuals(axes[0, 2], residuals, inlier)
    for ax, (i, k) in zip(axes[1], ((0, 1), (0, 2), (1, 2)), strict=True):
        _draw_ellipse(ax, errors[-1, 3:], covariances[-1, 3:, 3:], (i, k))
    axes[1, 0].legend(
        loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, frameon=False, fontsize=8
    )
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    return save(figure, path, title=title)


def _draw_progress(
    ax: Any, counts: Sequence[int], errors: Array, covariances: Array, what: str
) -> None:
    stated = np.sqrt(np.trace(covariances, axis1=1, axis2=2))
    ax.semilogy(counts, np.linalg.norm(errors, axis=1), "o-", color=_ERROR, label="error")
    ax.semilogy(counts, stated, "s--", color=_STATED, label="as stated (one deviation)")
    ax.set_xlabel("samples")
    ax.set_ylabel(what)
    ax.xaxis.get_major_locator().set_params(integer=True)
    ax.grid(visible=True, which="both", color="0.92")
    ax.legend(frameon=False, fontsize=8)


def _draw_residuals(ax: Any, residuals: Array, inlier: BoolArray) -> None:
    numbers = np.arange(len(residuals))
    for column, marker, label in ((1, "o", "position (m)"), (0, "^", "rotation (rad)")):
        ax.semilogy(numbers[inlier], residuals[inlier, column], marker, ms=5, label=label)
    if not inlier.all():
        both = residuals[~inlier].max(axis=1)
        ax.semilogy(numbers[~inlier], both, "x", ms=9, mew=2, color=_WRONG, label="left out")
    ax.set_xlabel("sample")
    ax.xaxis.get_major_locator().set_params(integer=True)
    ax.set_ylabel("residual")
    ax.grid(visible=True, which="both", color="0.92")
    ax.legend(frameon=False, fontsize=8)


def _draw_ellipse(ax: Any, error: Array, covariance: Array, pair: tuple[int, int]) -> None:
    """Draw the result with its ellipse of 95 % in the plane of two axes, around the truth."""
    values, vectors = np.linalg.eigh(covariance[np.ix_(pair, pair)])
    angles = np.linspace(0.0, 2.0 * np.pi, 100)
    circle = np.stack((np.cos(angles), np.sin(angles)))
    ring = (vectors * np.sqrt(values)) @ circle * _RADIUS_95 + error[list(pair), None]
    ax.plot(*(1e3 * ring), color=_STATED, label="95 %")
    ax.plot(*(1e3 * error[list(pair)]), "o", color=_ERROR, label="result")
    ax.plot(0.0, 0.0, "+", ms=12, mew=2, color="black", label="truth")
    ax.set_xlabel(f"{_AXES[pair[0]]} (mm)")
    ax.set_ylabel(f"{_AXES[pair[1]]} (mm)")
    ax.set_aspect("equal", adjustable="datalim")
    ax.grid(visible=True, color="0.92")
