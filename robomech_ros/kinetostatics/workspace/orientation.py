"""Orientations that the tip can take at a point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.inverse.solutions import MAX_SOLUTIONS
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import inverse_kinematics_batch
from robomech_ros.kinematics.inverse.closed_form import solve_many
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.kinematics.inverse.request.request import as_request
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.kinetostatics.rotation_sets import uniform_rotations
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import as_single
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array, ArrayLike, BoolArray, IntArray


@dataclass(frozen=True, eq=False)
class OrientationWorkspace:
    """Orientations evenly all over, and which of them the tip can take at a point.

    Parameters
    ----------
    position : ndarray, shape (3,)
        The point, in the base (m).
    rotations : ndarray, shape (m, 3, 3)
        ``R_base_tip`` of the samples.
    solution_count : ndarray of int, shape (m,)
        How many postures take each.
    share : float
        Of all orientations those that can be taken, 0 to 1: 1 in the dexterous workspace.
    """

    position: Array
    rotations: Array
    solution_count: IntArray
    share: float

    @property
    def reachable(self) -> BoolArray:
        """Mask (m,) of the samples that can be taken."""
        return self.solution_count > 0

    @property
    def approach_directions(self) -> Array:
        """The z axes of the tip in the samples that can be taken, shape (k, 3), in the base.

        They cover the service sphere of the point as far as it can be approached.
        """
        return self.rotations[self.reachable][:, :, 2]


def orientation_workspace(
    chain: SerialChain, position: ArrayLike, *, samples: int = 4096, respect_limits: bool = True
) -> OrientationWorkspace:
    """Find which orientations the tip can take at a point.

    The samples are those of :func:`uniform_rotations`, the same every time; the error of the share
    falls about as ``samples ** (-2 / 3)``.

    Parameters
    ----------
    chain : SerialChain
        Chain of six joints or more, as those of fewer take single orientations.
    position : array_like, shape (3,)
        Position of the tip in the base (m).
    samples : int, optional
        From 1 to 1,000,000.
    respect_limits : bool, optional
        Whether solutions outside the joint limits count.
    """
    check_chain(chain)
    if chain.n < 6:
        raise BadValueError("number of joints", chain.n, "6 or more")
    point = as_single("position", position, (3,))
    rotations = uniform_rotations(samples)
    T = assembled(rotations, point)
    family = family_of(chain)
    if family.lists_all:
        request = as_request(chain, None, respect_limits)
        count = np.maximum(solve_many(chain, T, family, request, MAX_SOLUTIONS)[1], 0)
    else:
        _, count, _ = inverse_kinematics_batch(chain, T, respect_limits=respect_limits)
    return OrientationWorkspace(point, rotations, count, float((count > 0).mean()))
