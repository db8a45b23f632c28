"""The platform on six legs between points of base and platform: Stewart and Gough's."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np

from robomech_ros._kernels.parallel import following, newton
from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError
from robomech_ros.outcomes import Code
from robomech_ros.parallel.argument_checks import actuated, platform_poses, single_pose
from robomech_ros.parallel.assembly_modes import CONTINUUM, assembly_modes
from robomech_ros.parallel.joint_cones import checked_cones
from robomech_ros.parallel.mechanism.home_poses import platform_home
from robomech_ros.parallel.mechanism.legs import extending_legs
from robomech_ros.parallel.mechanism.limb import checked_drive_limits
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.parallel.mechanism.parts import LinkBodies
from robomech_ros.parallel.mode_order import nearest_first
from robomech_ros.parallel.platform_geometry import (
    SINGULAR_ARCHITECTURE,
    ScaledPlatform,
    best_conditioning,
    checked_points,
    checked_strokes,
    family_of,
)
from robomech_ros.parallel.result import DirectKinematicsResult, FollowedPose
from robomech_ros.parallel.start_system import StartSystem, start_system
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.typing import Array, ArrayLike

# Squared lengths that are typical where no strokes are given, of the size of the platform.
_TYPICAL = 2.0


class StewartGough:
    r"""A platform on six legs: :math:`|p + R b_i - a_i| = L_i`.

    Poses T of its methods are ``T_base_platform`` (m), shape (..., 4, 4).

    Parameters
    ----------
    base_points : array_like, shape (6, 3)
        Anchors :math:`a_i` in the frame of the base (m).
    platform_points : array_like, shape (6, 3)
        Anchors :math:`b_i` in the frame of the platform (m).
    strokes : array_like, shape (2,) or (6, 2), optional
        Least and greatest length of all legs or of each (m).
    drive_limits : mapping, optional
        Of ``velocity``, ``acceleration``, ``jerk`` and ``effort`` of all drives or of each (rad or
        m, and s; N m or N).
    base_cones, platform_cones : mapping, optional
        How far the joints at the ends of the legs may bend: ``axes`` (3,) or (6, 3), in the base or
        in the platform, from the anchors along the legs, and ``angles`` from them, one or six
        (rad, up to pi).  Without them the joints bend freely.
    name : str, optional
        What it is called.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.2.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.parallel import StewartGough
    >>> angles = np.radians([-10, 10, 110, 130, 230, 250])
    >>> base = np.stack((np.cos(angles), np.sin(angles), 0 * angles), axis=1)
    >>> corners = np.radians([0, 0, 120, 120, 240, 240])
    >>> top = 0.775 * np.stack((np.cos(corners), np.sin(corners), 0 * corners), axis=1)
    >>> robot = StewartGough(base, top)
    >>> found = robot.direct([1.538, 1.695, 2.658, 2.649, 1.653, 1.5])
    >>> len(found), found.complete, found.family
    (16, True, '6-3 planar')
    >>> np.round(robot.inverse(found.poses[0]), 6)
    array([1.538, 1.695, 2.658, 2.649, 1.653, 1.5  ])
    """

    # Bodies and what drives add to them: to be set before the mechanism is asked for.
    parts = LinkBodies()

    def __init__(
        self,
        base_points: ArrayLike,
        platform_points: ArrayLike,
        *,
        strokes: ArrayLike | None = None,
        base_cones: object = None,
        platform_cones: object = None,
        drive_limits: Mapping[str, ArrayLike] | None = None,
        name: str = "platform",
    ) -> None:
        self.name = name
        self.base_points = checked_points("base_points", base_points, 6, 3)
        self.platform_points = checked_points("platform_points", platform_points, 6, 3)
        self.strokes = checked_strokes(strokes, 6)
        self.drive_limits = checked_drive_limits(drive_limits, 6)
        self.base_cones = checked_cones("base_cones", base_cones)
        self.platform_cones = checked_cones("platform_cones", platform_cones)
        self._scaled = ScaledPlatform.of(self.base_points, self.platform_points)
        # Best ratio of least to greatest singular value of the Jacobian over many poses.
        self.conditioning = best_conditioning(self._scaled)
        kind = family_of(self.base_points, self.platform_points)
        self.family = f"{kind}, architecturally singular" if self.always_singular else kind

    @property
    def always_singular(self) -> bool:
        """True if the platform is singular in every pose: its legs never hold it."""
        return self.conditioning < SINGULAR_ARCHITECTURE

    @cached_property
    def _start(self) -> StartSystem:
        typical = np.full(6, _TYPICAL)
        if self.strokes is not None:
            typical = (self._scaled.scale * self.strokes.mean(axis=1)) ** 2
        return start_system(self._scaled.a, self._scaled.b, typical)

    @cached_property
    def mechanism(self) -> Mechanism:
        """All joints of the robot, passive ones included, in one model: six limbs U P S."""
        a, b = self.base_points, self.platform_points
        home = platform_home(
            a, b, self.strokes, lambda poses: self.cone_margins(poses).max(axis=(1, 2)) <= 0.0
        )
        cones = self.base_cones, self.platform_cones
        legs = extending_legs(self.name, a, b, self.strokes, home, cones)
        return Mechanism.of(self, legs, home[None])

    def inverse(self, T: ArrayLike) -> Array:
        r"""Find the leg lengths for a pose: :math:`L_i = |p + R b_i - a_i|`.

        Returns
        -------
        ndarray, shape (..., 6)
            Lengths (m), also where they are outside the strokes; see :meth:`excess`.
        """
        poses = platform_poses(T)
        flat = np.ascontiguousarray(poses.reshape(-1, 4, 4))
        out = np.empty((len(flat), 6))
        newton.leg_lengths(self.base_points, self.platform_points, flat, out)
        return out.reshape(*poses.shape[:-2], 6)

    def excess(self, lengths: ArrayLike) -> Array:
        """Say by how much leg lengths (..., 6) are outside the strokes (m).

        That is positive where a leg is too long, negative where it is too short, else 0.
        """
        given = as_finite("lengths", lengths, (6,))
        if self.strokes is None:
            return np.zeros_like(given)
        return np.asarray(given - np.clip(given, self.strokes[:, 0], self.strokes[:, 1]))

    def cone_excess(self, T: ArrayLike) -> Array:
        """Say by how much joints at the ends of the legs bend beyond their cones: 0 inside."""
        return np.maximum(self.cone_margins(T), 0.0)

    def cone_margins(self, T: ArrayLike) -> Array:
        """Say how far joints at the ends of the legs bend beyond their cones in poses.

        Returns
        -------
        ndarray, shape (..., 2, 6)
            Of those on the base and on the platform: rad, negative inside, -pi without a cone.
        """
        poses = platform_poses(T)
        R = poses[..., :3, :3]
        legs = poses[..., None, :3, 3] - self.base_points
        legs = legs + self.platform_points @ np.swapaxes(R, -1, -2)
        out = np.full((*poses.shape[:-2], 2, 6), -np.pi)
        if self.base_cones is not None:
            out[..., 0, :] = self.base_cones.excess(legs)
        if self.platform_cones is not None:
            out[..., 1, :] = self.platform_cones.excess(-legs @ R)
        return out

    def direct(self, lengths: ArrayLike, seed: ArrayLike | None = None) -> DirectKinematicsResult:
        """Find all poses that leg lengths allow, its assembly modes: up to forty.

        Poses for complex lengths, found once for each platform, are followed to those for the
        lengths given.  They are all where each path has a regular end of its own, and the ends
        are real or conjugate in pairs; paths that meet in a singular pose are counted there.

        Parameters
        ----------
        lengths : array_like, shape (6,)
            In m, within the strokes.
        seed : array_like, shape (4, 4), optional
            A pose: the nearest one comes first.

        Raises
        ------
        BadValueError, WrongSizeError
            Not six lengths, one that is not positive, or outside its stroke: the leg and the amount
            are named.
        """
        given = self._checked_lengths(lengths)
        near = None if seed is None else single_pose(seed, "seed")
        if self.always_singular:
            empty = np.empty((0, 4, 4)), np.empty(0, np.int64)
            reason = f"architecturally singular: in every pose {CONTINUUM}, or they do not fit"
            return DirectKinematicsResult(
                *empty, False, self.family, Code.SINGULAR_CONTINUUM, reason
            )
        found = assembly_modes(self._scaled, self._start, given, self.family)
        return found if near is None else nearest_first(found, near, 1.0 / self._scaled.scale)

    def follow(self, lengths: ArrayLike, T: ArrayLike) -> FollowedPose:
        """Find the pose into which a known one moves, and prove that the mode is the same.

        Each step satisfies Kantorovich's condition, which is exact here because second derivatives
        are constant.  The motion is divided into as many steps as that takes.

        Parameters
        ----------
        lengths : array_like, shape (6,)
            New leg lengths (m), within the strokes.
        T : array_like, shape (4, 4)
            The known pose ``T_base_platform``, of any lengths.

        References
        ----------
        Ortega, The Newton-Kantorovich theorem, American Mathematical Monthly 75 (1968).
        """
        given = self._checked_lengths(lengths)
        scaled = self._scaled
        pose, report = scaled.scaled_pose(single_pose(T)), np.empty(2)
        steps = following.follow(scaled.a, scaled.b, scaled.scale * given, pose, report)
        reached = scaled.poses(pose[None])[0]
        if steps > 0:
            return FollowedPose(reached, True, Code.NONE, 1.0, steps)
        part, regularity = report.tolist()
        code, why = Code.SINGULAR, "assembly modes meet there in a singular pose"
        if steps != following.SINGULAR:
            condition = 1.0 / regularity
            code = Code.NOT_CONVERGED
            why = f"the next step cannot be certified (condition number {condition:.3g})"
        reason = f"stopped after {100.0 * part:.3g} % of the motion: {why}"
        return FollowedPose(reached, False, code, part, 0, reason)

    def jacobian(self, T: ArrayLike) -> Array:
        r"""Find K of :math:`K t = \dot L`: rows :math:`[(R b_i \times n_i)^T, n_i^T]`.

        Returns
        -------
        ndarray, shape (..., 6, 6)
            For twists [angular velocity; velocity of the platform's origin] in the base, to the
            rates of the lengths; its transpose makes of leg forces the wrench on the platform.

        References
        ----------
        Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.2.1.
        """
        poses = platform_poses(T)
        out = np.empty((*poses.shape[:-2], 6, 6))
        flat = np.ascontiguousarray(poses.reshape(-1, 4, 4))
        a, b = self.base_points, self.platform_points
        if newton.jacobians(a, b, flat, out.reshape(-1, 6, 6)):
            raise BadValueError("pose", poses.tolist(), "legs that are longer than 0 m")
        return out

    def _checked_lengths(self, lengths: ArrayLike) -> Array:
        given = actuated("lengths", lengths, 6)
        for leg, length in enumerate(given.tolist()):
            if not 0.0 < length <= LARGEST_LENGTH:
                what = f"length of leg {leg + 1}"
                raise BadValueError(what, length, f"more than 0 m, up to {LARGEST_LENGTH:g} m")
        outside = self.excess(given)
        if self.strokes is not None and outside.any():
            leg = int(np.argmax(np.abs(outside)))
            low, high = self.strokes[leg].tolist()
            why = f"{low:g} to {high:g} m, the stroke: {abs(outside[leg]):.3g} m outside"
            raise BadValueError(f"length of leg {leg + 1}", float(given[leg]), why)
        return given
