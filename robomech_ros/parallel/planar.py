"""Planar platforms on three limbs: 3-RPR with legs that extend, 3-RRR with links that turn."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np

from robomech_ros._kernels.parallel.planar import planar_modes
from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError
from robomech_ros.parallel.argument_checks import (
    actuated,
    angle_limits,
    planar_pose,
    pose_about_z,
    positive,
)
from robomech_ros.parallel.limbs import planar_limb, postures
from robomech_ros.parallel.mechanism.closed_form_limbs import folding_limbs, sliding_limbs
from robomech_ros.parallel.mechanism.home_poses import planar_homes
from robomech_ros.parallel.mechanism.limb import checked_drive_limits
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.parallel.mechanism.parts import LinkBodies
from robomech_ros.parallel.mode_order import modes_found, nearest_first
from robomech_ros.parallel.platform_geometry import checked_points, checked_strokes
from robomech_ros.parallel.result import DirectKinematicsResult, LimbPostures
from robomech_ros.spatial.arrays import real_array
from robomech_ros.typing import Array, ArrayLike


class _Planar:
    """A triangle whose corners are at given distances from three points."""

    family = "planar"

    # Bodies and what drives add to them: to be set before the mechanism is asked for.
    parts = LinkBodies()

    def __init__(self, base_points: ArrayLike, platform_points: ArrayLike, name: str) -> None:
        self.name = name
        self.base_points = checked_points("base_points", base_points, 3, 2)
        self.platform_points = checked_points("platform_points", platform_points, 3, 2)

    def _modes(
        self, anchors: Array, distances: Array, seed: ArrayLike | None
    ) -> DirectKinematicsResult:
        near = None if seed is None else pose_about_z(planar_pose(seed)[None])[0]
        centre = anchors.mean(axis=0)
        middle = self.platform_points.mean(axis=0)
        a, b = anchors - centre, self.platform_points - middle
        size = float(max(np.abs(a).max(), np.abs(b).max(), distances.max()))
        poses, errors = np.empty((13, 3)), np.empty(13)
        multiplicity = np.empty(13, np.int64)
        count = planar_modes(a / size, b / size, distances / size, poses, errors, multiplicity)
        kept = poses[: max(count, 0)]
        T = pose_about_z(kept)
        T[:, :2, 3] = centre + size * kept[:, :2] - T[:, :2, :2] @ middle
        found = modes_found(T, multiplicity, size * errors, count, self.family)
        return found if near is None else nearest_first(found, near, size)

    def _corners(self, T: ArrayLike) -> Array:
        """Return the platform's points in the base (3, 2)."""
        x, y, angle = planar_pose(T).tolist()
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        return np.array([x, y]) + self.platform_points @ turn.T


class Planar3RPR(_Planar):
    """A planar platform on three legs that extend.

    Parameters
    ----------
    base_points, platform_points : array_like, shape (3, 2)
        Anchors in the frames of base and platform (m).
    strokes : array_like, shape (2,) or (3, 2), optional
        Least and greatest length of all legs or of each (m).
    drive_limits : mapping, optional
        Of ``velocity``, ``acceleration``, ``jerk`` and ``effort`` of all drives or of each (rad or
        m, and s; N m or N).
    name : str, optional
        What it is called.

    References
    ----------
    Gosselin and Merlet, The direct kinematics of planar parallel manipulators, Mechanism and
    Machine Theory 29 (1994), pp. 1083-1097.

    Examples
    --------
    >>> from robomech_ros.parallel import load_parallel
    >>> found = load_parallel("planar_3rpr").direct([14.98, 15.38, 12.0])
    >>> len(found), found.complete
    (6, True)
    """

    family = "planar 3-RPR"

    def __init__(
        self,
        base_points: ArrayLike,
        platform_points: ArrayLike,
        *,
        strokes: ArrayLike | None = None,
        drive_limits: Mapping[str, ArrayLike] | None = None,
        name: str = "planar_3rpr",
    ) -> None:
        super().__init__(base_points, platform_points, name)
        self.strokes = checked_strokes(strokes, 3)
        self.drive_limits = checked_drive_limits(drive_limits, 3)

    @cached_property
    def mechanism(self) -> Mechanism:
        """All joints of the robot, passive ones included, in one model: three limbs R P R."""
        a, b = self.base_points, self.platform_points
        limbs = sliding_limbs(self.name, a, b, self.strokes)
        return Mechanism.of(self, limbs, planar_homes(a, b))

    def inverse(self, T: ArrayLike) -> Array:
        """Find the leg lengths (3,) for a pose (m), also where they are outside the strokes.

        Parameters
        ----------
        T : array_like, shape (4, 4) or (3,)
            ``T_base_platform`` in the plane z = 0, or x, y (m) and the angle (rad).
        """
        return np.asarray(np.linalg.norm(self._corners(T) - self.base_points, axis=1))

    def direct(self, lengths: ArrayLike, seed: ArrayLike | None = None) -> DirectKinematicsResult:
        """Find all poses that leg lengths allow: up to six.

        Parameters
        ----------
        lengths : array_like, shape (3,)
            In m, within the strokes.
        seed : array_like, shape (4, 4) or (3,), optional
            A pose: the nearest one comes first.
        """
        given = actuated("lengths", lengths, 3)
        for leg, length in enumerate(given.tolist()):
            low, high = (
                (0.0, LARGEST_LENGTH) if self.strokes is None else self.strokes[leg].tolist()
            )
            if not low <= length <= high or length <= 0.0:
                what = f"length of leg {leg + 1}"
                off = max(low - length, length - high)
                why = f"{low:g} to {high:g} m: {off:.3g} m outside"
                raise BadValueError(what, length, why if off > 0.0 else "more than 0 m")
        return self._modes(self.base_points, given, seed)


class Planar3RRR(_Planar):
    """A planar platform on three limbs of two links, driven at the base.

    Parameters
    ----------
    base_points, platform_points : array_like, shape (3, 2)
        Joints on base and platform, in their frames (m).
    proximal, distal : float or array_like, shape (3,)
        Lengths of the driven links and of those behind them (m).
    limits : array_like, shape (2,) or (3, 2), optional
        Limits of the driven joints, from the x axis (rad).
    drive_limits : mapping, optional
        Of ``velocity``, ``acceleration``, ``jerk`` and ``effort`` of all drives or of each (rad or
        m, and s; N m or N).
    name : str, optional
        What it is called.

    References
    ----------
    Gosselin and Angeles, The optimum kinematic design of a planar three-degree-of-freedom parallel
    manipulator, J. Mechanisms, Transmissions, and Automation in Design 110 (1988), pp. 35-41.
    """

    family = "planar 3-RRR"

    def __init__(
        self,
        base_points: ArrayLike,
        platform_points: ArrayLike,
        proximal: ArrayLike,
        distal: ArrayLike,
        *,
        limits: ArrayLike | None = None,
        drive_limits: Mapping[str, ArrayLike] | None = None,
        name: str = "planar_3rrr",
    ) -> None:
        super().__init__(base_points, platform_points, name)
        self.proximal = _link_lengths("proximal", proximal)
        self.distal = _link_lengths("distal", distal)
        self.limits = angle_limits(limits)
        self.drive_limits = checked_drive_limits(drive_limits, 3)

    @cached_property
    def mechanism(self) -> Mechanism:
        """All joints of the robot, passive ones included, in one model: three limbs R R R."""
        a, b = self.base_points, self.platform_points
        limbs = folding_limbs(self.name, a, b, self.proximal, self.distal, self.limits)
        return Mechanism.of(self, limbs, planar_homes(a, b))

    def inverse(self, T: ArrayLike, *, seed: ArrayLike | None = None) -> LimbPostures:
        """Find all angles of the driven joints that hold a pose: up to eight.

        Parameters
        ----------
        T : array_like, shape (4, 4) or (3,)
            ``T_base_platform`` in the plane z = 0, or x, y (m) and the angle (rad).
        seed : array_like, shape (3,), optional
            Angles (rad): the nearest posture comes first.
        """
        to_corners = (self._corners(T) - self.base_points).tolist()
        limbs = [
            planar_limb(x, y, float(self.proximal[i]), float(self.distal[i]))
            for i, (x, y) in enumerate(to_corners)
        ]
        return postures(limbs, self.limits, seed)

    def direct(self, q: ArrayLike, seed: ArrayLike | None = None) -> DirectKinematicsResult:
        """Find all poses for angles of the driven joints: up to six.

        Parameters
        ----------
        q : array_like, shape (3,)
            In rad.
        seed : array_like, shape (4, 4) or (3,), optional
            A pose: the nearest one comes first.
        """
        given = actuated("q", q, 3)
        arms = self.proximal[:, None] * np.stack((np.cos(given), np.sin(given)), axis=1)
        return self._modes(self.base_points + arms, self.distal, seed)


def _link_lengths(what: str, value: ArrayLike) -> Array:
    if real_array(what, value).ndim == 0:
        return np.full(3, positive(what, value))
    return np.array([positive(what, one) for one in actuated(what, value, 3).tolist()])
