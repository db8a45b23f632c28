"""Results of the kinematics of an arm or a parallel robot, as the services need them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from robomech_ros.typing import Array


@dataclass(frozen=True, eq=False)
class PostureReport:
    """Singularity report on a posture, with the fields of an AnalyzeSingularity response.

    - ``lost_directions``: twists that the point cannot do, shape (r, 6).
    - ``free_directions``: twists of the point that locked drives allow, shape (r, 6).

    Twists have the angular part first, in the axes of the base.
    """

    position: Array  #: Position of the point in the base (m), shape (3,).
    #: Jacobian (6, m) of the point in the axes of the base, angular rows first; None if the drives
    #: of a parallel robot do not determine its motion.
    jacobian: Array | None
    singular_values: Array
    rank: int
    manipulability: float
    condition_number: float
    characteristic_length: float
    normalised_condition_number: float
    lost_directions: Array
    singularity_types: Sequence[str]
    summary: str
    free_directions: Array = field(default_factory=lambda: np.empty((0, 6)))


def distances_between(T: Array, reached: Array) -> tuple[Array, Array]:
    """Return the distances (m) and angles (rad) between poses, shape (..., 4, 4)."""
    apart = T - reached
    turned = _lengths(apart[..., :3, :3].reshape(*apart.shape[:-2], 9))
    # The matrices of two rotations that differ by an angle differ by 2 sqrt(2) sin(angle / 2).
    chord = np.minimum(turned / math.sqrt(8.0), 1.0)
    return _lengths(apart[..., :3, 3]), 2.0 * np.arcsin(chord)


def _lengths(rows: Array) -> Array:
    """Lengths along the last axis, without the copies that a norm makes."""
    lengths: Array = np.sqrt(np.einsum("...i,...i->...", rows, rows))
    return lengths
