"""A plot of a simulated motion: joints, energy and drive torques over time."""

from __future__ import annotations

from pathlib import Path

from robomech_ros.dynamics import Simulation
from robomech_ros.errors import WrongSizeError
from robomech_ros.plotting.joint_motions import draw_curves
from robomech_ros.plotting.pictures import new_figure, save
from robomech_ros.robots import PRISMATIC, SerialChain
from robomech_ros.typing import Array

_WIDTH, _HEIGHT, _REST = 10.0, 2.45, 0.65


def plot_simulation(
    path: str | Path, chain: SerialChain, run: Simulation, torques: Array, *, title: str = ""
) -> Path:
    """Write a picture of positions, velocities, energies and drive torques over time.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints; its limits are drawn dashed.
    run : Simulation
        Of this chain, at m times.
    torques : ndarray, shape (m, n)
        Torques of the drives (N m or N).

    Raises
    ------
    WrongSizeError
        Motion or torques are not those of n joints at m times.
    """
    shape = (len(run.t), chain.n)
    for what, curve in (("positions", run.q), ("torques", torques)):
        if curve.shape != shape:
            raise WrongSizeError(what, curve.shape, shape)
    slides = [kind == PRISMATIC for kind in chain.types]
    rad, newton = "rad or m" if any(slides) else "rad", "N m or N" if any(slides) else "N m"
    figure = new_figure(_WIDTH, _REST + 4 * _HEIGHT)
    position, velocity, energy, drives = figure.subplots(4, 1, sharex=True)
    limits = [(chain.lower, chain.upper), (-chain.velocity, chain.velocity)]
    limits.append((-chain.effort, chain.effort))
    for ax, label, curve, bounds in zip(
        (position, velocity, drives),
        (f"position ({rad})", f"velocity ({rad} per s)", f"torque ({newton})"),
        (run.q, run.qd, torques),
        limits,
        strict=True,
    ):
        draw_curves(ax, chain.joint_names, run.t, curve, slides, bounds)
        ax.set_ylabel(label)
    balance = run.kinetic + run.potential + run.heat - run.work
    for name, curve in (
        ("kinetic", run.kinetic),
        ("potential", run.potential),
        ("work of the drives", run.work),
        ("heat of friction", run.heat),
        ("balance", balance),
    ):
        style = {"color": "black", "linestyle": ":"} if name == "balance" else {}
        energy.plot(run.t, curve, linewidth=1.4, label=name, **style)
    energy.set_ylabel("energy (J)")
    energy.grid(visible=True, color="0.9")
    energy.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize=8)
    drives.set_xlabel("time (s)")
    handles, labels = position.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right upper", frameon=False)
    return save(figure, path, title=title)
