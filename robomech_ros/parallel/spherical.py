"""The spherical platform on three limbs of two arcs each, all axes through one point."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np

from robomech_ros._kernels.parallel.spherical import spherical_modes
from robomech_ros.errors import BadValueError
from robomech_ros.parallel.argument_checks import actuated, angle_limits, rotation_only, unit_axes
from robomech_ros.parallel.limbs import postures, turning_limb
from robomech_ros.parallel.mechanism.closed_form_limbs import spherical_limbs
from robomech_ros.parallel.mechanism.home_poses import spherical_homes
from robomech_ros.parallel.mechanism.limb import checked_drive_limits
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.parallel.mechanism.parts import LinkBodies
from robomech_ros.parallel.mode_order import modes_found, nearest_first
from robomech_ros.parallel.result import DirectKinematicsResult, LimbPostures
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.poses import assembled
from robomech_ros.spatial.rotations.axis_angle import matrix_from_rotation_vector
from robomech_ros.typing import Array, ArrayLike

# Least sine of the angles of an arc: a limb with less would not turn its platform.
_LEAST_ARC = 1e-6


class Spherical3RRR:
    r"""A platform that turns about a point: :math:`w_i(q_i) \cdot R v_i = \cos \alpha_i`.

    Parameters
    ----------
    base_axes : array_like, shape (3, 3)
        Axes of the drives, in the base, one a row; only directions count.
    middle_axes : array_like, shape (3, 3)
        Axes between the arcs of each limb where its drive is at zero, in the base.
    platform_axes : array_like, shape (3, 3)
        Axes :math:`v_i` on the platform, in its frame.
    distal : float or array_like, shape (3,), optional
        Angle :math:`\alpha_i` between middle and platform axis (rad); right angles by default.
    limits : array_like, shape (2,) or (3, 2), optional
        Limits of the drives (rad).
    drive_limits : mapping, optional
        Of ``velocity``, ``acceleration``, ``jerk`` and ``effort`` of all drives or of each (rad or
        m, and s; N m or N).
    name : str, optional
        What it is called.

    References
    ----------
    Gosselin and Hamel, The agile eye: a high-performance three-degree-of-freedom camera-orienting
    device, IEEE Int. Conf. Robotics and Automation 1994, pp. 781-786.
    """

    family = "spherical 3-RRR"

    # Bodies and what drives add to them: to be set before the mechanism is asked for.
    parts = LinkBodies()

    def __init__(
        self,
        base_axes: ArrayLike,
        middle_axes: ArrayLike,
        platform_axes: ArrayLike,
        distal: ArrayLike = np.pi / 2,
        *,
        limits: ArrayLike | None = None,
        drive_limits: Mapping[str, ArrayLike] | None = None,
        name: str = "spherical_3rrr",
    ) -> None:
        self.name = name
        self.base_axes = unit_axes("base_axes", base_axes)
        self.middle_axes = unit_axes("middle_axes", middle_axes)
        self.platform_axes = unit_axes("platform_axes", platform_axes)
        self.distal = _three("distal", distal)
        if not ((self.distal > 0.0) & (np.sin(self.distal) > _LEAST_ARC)).all():
            raise BadValueError("distal", self.distal.tolist(), "angles between 0 and pi (rad)")
        arcs = np.linalg.norm(np.cross(self.base_axes, self.middle_axes), axis=1)
        if arcs.min() < _LEAST_ARC:
            limb = int(np.argmin(arcs)) + 1
            raise BadValueError(f"middle axis {limb}", middle_axes, "another axis than the base's")
        pairs = np.cross(self.platform_axes, np.roll(self.platform_axes, 1, axis=0))
        if np.linalg.norm(pairs, axis=1).min() < _LEAST_ARC:
            raise BadValueError("platform_axes", platform_axes, "axes of different directions")
        self.limits = angle_limits(limits)
        self.drive_limits = checked_drive_limits(drive_limits, 3)

    @cached_property
    def mechanism(self) -> Mechanism:
        """All joints of the robot, passive ones included, in one model: three limbs R R R."""
        limbs = spherical_limbs(
            self.name,
            self.base_axes,
            self.middle_axes,
            self.platform_axes,
            self.distal,
            self.limits,
        )
        return Mechanism.of(self, limbs, spherical_homes())

    def inverse(self, T: ArrayLike, *, seed: ArrayLike | None = None) -> LimbPostures:
        """Find all angles of the drives that hold an orientation: up to eight.

        Parameters
        ----------
        T : array_like, shape (4, 4) or (3, 3)
            ``T_base_platform`` without translation, or its rotation.
        seed : array_like, shape (3,), optional
            Angles (rad): the nearest posture comes first.
        """
        turned = self.platform_axes @ rotation_only(T).T
        limbs = [
            turning_limb(self.base_axes[i], self.middle_axes[i], turned[i], float(self.distal[i]))
            for i in range(3)
        ]
        return postures(limbs, self.limits, seed, "rad")

    def direct(self, q: ArrayLike, seed: ArrayLike | None = None) -> DirectKinematicsResult:
        """Find all orientations for angles of the drives: up to eight.

        Parameters
        ----------
        q : array_like, shape (3,)
            In rad.
        seed : array_like, shape (4, 4) or (3, 3), optional
            An orientation: the nearest one comes first.

        Returns
        -------
        DirectKinematicsResult
            Its errors are those of cosines.
        """
        given = actuated("q", q, 3)
        near = None if seed is None else assembled(rotation_only(seed), np.zeros(3))
        turns = matrix_from_rotation_vector(given[:, None] * self.base_axes)
        w = np.ascontiguousarray((turns @ self.middle_axes[:, :, None])[:, :, 0])
        poses, errors = np.empty((17, 9)), np.empty(17)
        multiplicity = np.empty(17, np.int64)
        cosines = np.cos(self.distal)
        count = spherical_modes(w, self.platform_axes, cosines, poses, errors, multiplicity)
        R = poses[: max(count, 0)].reshape(-1, 3, 3)
        T = assembled(R, np.zeros((len(R), 3)))
        found = modes_found(T, multiplicity, errors, count, self.family)
        return found if near is None else nearest_first(found, near, 1.0)


def _three(what: str, value: ArrayLike) -> Array:
    array = as_finite(what, value, ())
    return np.full(3, float(array)) if array.ndim == 0 else actuated(what, array, 3).copy()
