"""A plot of curves of equal condition number over two joints."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from robomech_ros.kinetostatics import ConditionLoci
from robomech_ros.plotting.pictures import new_figure, save
from robomech_ros.robots import PRISMATIC

_SIZE = 6.5
# Condition numbers at least this great have one colour.
_DARKEST = 20.0


def plot_condition_loci(path: str | Path, loci: ConditionLoci, *, title: str | None = None) -> Path:
    """Plot the curves over both joints, with the condition number as the background.

    Parameters
    ----------
    loci : ConditionLoci
    title : str, optional
        Title; default robot and part.

    Returns
    -------
    Path
        The picture.
    """
    figure = new_figure(_SIZE + 1.5, _SIZE)
    ax = figure.subplots()
    shown = np.log10(np.minimum(loci.grid, _DARKEST))
    mesh = ax.pcolormesh(*loci.axes, shown.T, shading="nearest", cmap="Greys", rasterized=True)
    ticks = np.array([1.0, 2.0, 5.0, 10.0, _DARKEST])
    bar = figure.colorbar(mesh, ax=ax, ticks=np.log10(ticks), shrink=0.7)
    bar.ax.set_yticklabels([f"{tick:g}" for tick in ticks])
    bar.set_label("condition number (Frobenius norm)")
    pair = list(loci.joints)
    for number, (level, pieces) in enumerate(zip(loci.levels, loci.curves, strict=True)):
        for k, curve in enumerate(pieces):
            label = f"{level:g}" if k == 0 else None
            ax.plot(*curve[:, pair].T, color=f"C{number % 10}", linewidth=1.4, label=label)
    chain = loci.chain
    units = ["m" if kind == PRISMATIC else "rad" for kind in chain.types]
    first, second = (f"{chain.joint_names[joint]} ({units[joint]})" for joint in pair)
    ax.set_xlabel(first)
    ax.set_ylabel(second)
    if any(loci.curves):
        figure.legend(loc="outside lower center", ncols=6, frameon=False, fontsize=8)
    known = f"{chain.name}, {loci.part}" if title is None else title
    return save(figure, path, title=known)
