"""Positions of the bodies of a chain, and the axes that they turn about or slide along."""

from dataclasses import dataclass

import numpy as np

from robomech_ros.kinematics.forward_uncompiled import link_transforms
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import REVOLUTE
from robomech_ros.typing import Array, BoolArray


@dataclass(frozen=True, eq=False)
class PosedBodies:
    """Axes and bodies of m joints at given joint values, all in the axes of the base.

    The axes (..., m, 3) are unit vectors, through origins (..., m, 3) fixed to link i (m). The
    bodies have masses (m,), mass centres (..., m, 3) in m, and inertias (..., m, 3, 3) about them
    (kg m^2). The tip (..., 3) is its origin (m).
    """

    revolute: BoolArray
    axes: Array
    origins: Array
    centres: Array
    masses: Array
    inertias: Array
    tip: Array


def body_moments(chain: SerialChain) -> tuple[Array, Array, Array]:
    """Return masses (m,), mass centres (m, 3) and inertias about them (m, 3, 3) in link frames."""
    rows = chain.packed_bodies
    inertias = rows[:, [4, 5, 6, 5, 7, 8, 6, 8, 9]].reshape(-1, 3, 3)
    return rows[:, 0], rows[:, 1:4], inertias


def reflected_inertias(chain: SerialChain) -> Array:
    """Return what the rotors add to the diagonal of the mass matrix (kg m^2 or kg), shape (n,)."""
    return np.array([drive.reflected_inertia for drive in chain.drives])


def posed_bodies(
    chain: SerialChain, q: Array, moments: tuple[Array, Array, Array] | None = None
) -> PosedBodies:
    """Compute the positions of axes and bodies at q (..., n).

    The moments, as of :func:`body_moments`, stand for the bodies of the chain.
    """
    masses, centres, inertias = moments or body_moments(chain)
    T = link_transforms(chain, q)
    R, o = T[..., :-1, :3, :3], T[..., :-1, :3, 3]
    return PosedBodies(
        revolute=chain.uncoupled.types == REVOLUTE,
        axes=R[..., 2],
        origins=o,
        centres=o + np.einsum("...nij,nj->...ni", R, centres),
        masses=masses,
        inertias=R @ inertias @ np.swapaxes(R, -1, -2),
        tip=T[..., -1, :3, 3],
    )
