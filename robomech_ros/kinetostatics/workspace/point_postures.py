"""All values of three joints that bring a point somewhere, for many points.

A spherical wrist of right angles and without limits is put at the point: the closed form of arms
with such a wrist then lists the postures of any three joints, in one compiled loop.
"""

from dataclasses import replace

import numpy as np

from robomech_ros._kernels.inverse.solutions import MAX_SOLUTIONS
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.inverse.closed_form import solve_many
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.kinematics.inverse.families.six_joints import chain_of
from robomech_ros.kinematics.inverse.request.request import as_request
from robomech_ros.kinetostatics.workspace.section import WorkspaceSection
from robomech_ros.robots.chain_layout import PRISMATIC, REVOLUTE
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array, BoolArray, IntArray

# The orientation asked for: none that symmetry would make singular for the wrist.
_ORIENTATION = np.array((
    (0.36, 0.48, -0.8),
    (-0.8, 0.6, 0.0),
    (0.48, 0.64, 0.6),
))  # fmt: skip
_QUARTER = np.array(((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)))
_PORTION = 4096


class PointPostures:
    """Solver for the postures of a section's three joints, the first perhaps without limits."""

    def __init__(self, section: WorkspaceSection, *, first_free: bool) -> None:
        # In units of the arm's size, as tolerances suit arms of some metres.
        self._unit = section.size
        section = section.over(self._unit)
        types = np.array([*(PRISMATIC if s else REVOLUTE for s in section.slides), 0, 0, 0])
        bounds = np.stack((section.lower, section.upper))
        bounds[:, section.round] = ((-np.inf,), (np.inf,))
        if first_free:
            bounds[:, 0] = -np.inf, np.inf
        transforms = np.tile(np.eye(4), (7, 1, 1))
        transforms[0], transforms[1], transforms[2] = section.base, section.first, section.second
        transforms[3, :3, 3] = section.point
        transforms[4, :3, :3], transforms[5, :3, :3] = _QUARTER, _QUARTER.T
        lower, upper = np.hstack((bounds, np.full((2, 3), ((-np.inf,), (np.inf,)))))
        chain = replace(chain_of(transforms, types.tolist()), lower=lower, upper=upper)
        self._chain, self._family = chain, family_of(chain)
        if not self._family.lists_all:
            raise BadValueError("positioning part", "singular", "three joints that move a point")
        self._request = as_request(chain)

    def count(self, points: Array) -> IntArray:
        """Count the postures at points (m, 3) of the base (m)."""
        counts = np.empty(len(points), np.int64)
        for first in range(0, len(points), _PORTION):
            part = slice(first, first + _PORTION)
            counts[part] = self._unflipped(points[part])[1].sum(axis=1)
        return counts

    def _unflipped(self, points: Array) -> tuple[Array, BoolArray]:
        """Solve for points (m, 3) of the base (m); give solutions (m, 16, 6) in units of the size.

        Also which of them, (m, 16), stand for one posture each.
        """
        T = assembled(_ORIENTATION, points / self._unit)
        q, counts, _ = solve_many(self._chain, T, self._family, self._request, MAX_SOLUTIONS)
        within = np.arange(MAX_SOLUTIONS) < counts[:, None]
        # The wrist branch that bends to the positive side.
        return q, within & (q[:, :, 4] >= 0.0)
