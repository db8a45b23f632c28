"""The Delta robot: three arms on a base, three parallelograms, a platform that translates."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np

from robomech_ros._kernels.parallel import delta as kernels
from robomech_ros.errors import BadValueError
from robomech_ros.outcomes import Code
from robomech_ros.parallel.argument_checks import actuated, angle_limits, positive, translation_only
from robomech_ros.parallel.limbs import Limb, postures
from robomech_ros.parallel.mechanism.closed_form_limbs import delta_limbs
from robomech_ros.parallel.mechanism.limb import checked_drive_limits
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.parallel.mechanism.parts import LinkBodies
from robomech_ros.parallel.mode_order import nearest_first
from robomech_ros.parallel.result import DirectKinematicsResult, LimbPostures
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array, ArrayLike

_FAMILY = "delta"
# Angles of all arms among which the one to begin with is found.
_TRIED = 33


class Delta:
    """A Delta robot with revolute drives.

    Parameters
    ----------
    base_radius, platform_radius : float
        Of the axes of the arms from the centre of the base, and of the forearms' joints from that
        of the platform (m).
    arm, forearm : float
        Lengths (m).
    azimuths : array_like, shape (3,), optional
        Azimuths of the limbs about z, which points up (rad); -90, 30 and 150 degrees by default.
    limits : array_like, shape (2,) or (3, 2), optional
        Limits of the arms' angles, downwards from the horizontal (rad).
    drive_limits : mapping, optional
        Of ``velocity``, ``acceleration``, ``jerk`` and ``effort`` of all drives or of each (rad or
        m, and s; N m or N).
    name : str, optional
        What it is called.

    References
    ----------
    Clavel, Conception d'un robot parallele rapide a 4 degres de liberte, thesis, EPFL 1991.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.parallel import load_parallel
    >>> robot = load_parallel("delta")
    >>> np.round(np.degrees(robot.inverse([0, 0, -0.9]).q[0]), 4)
    array([-20.5473, -20.5473, -20.5473])
    >>> np.round(robot.direct([0, 0, 0]).poses[:, 2, 3], 6)
    array([-1.064452,  1.064452])
    """

    # Bodies and what drives add to them: to be set before the mechanism is asked for.
    parts = LinkBodies()

    def __init__(
        self,
        base_radius: float,
        platform_radius: float,
        arm: float,
        forearm: float,
        *,
        azimuths: ArrayLike | None = None,
        limits: ArrayLike | None = None,
        drive_limits: Mapping[str, ArrayLike] | None = None,
        name: str = "delta",
    ) -> None:
        self.name = name
        self.family = _FAMILY
        self.base_radius = positive("base_radius", base_radius, zero=True)
        self.platform_radius = positive("platform_radius", platform_radius, zero=True)
        self.arm = positive("arm", arm)
        self.forearm = positive("forearm", forearm)
        given = np.radians([-90.0, 30.0, 150.0]) if azimuths is None else azimuths
        self.azimuths = actuated("azimuths", given, 3)
        around = np.exp(1j * self.azimuths)
        if min(abs(around[i] - around[i - 1]) for i in range(3)) < 1e-6:
            raise BadValueError("azimuths", self.azimuths.tolist(), "three different angles (rad)")
        self.limits = angle_limits(limits)
        self.drive_limits = checked_drive_limits(drive_limits, 3)
        self._geometry = np.array([self.base_radius, self.platform_radius, self.arm, self.forearm])

    @cached_property
    def mechanism(self) -> Mechanism:
        """All joints of the robot, passive ones included, in one model: three limbs R U U."""
        limbs = delta_limbs(self.name, self._geometry, self.azimuths, self.limits)
        angles = np.linspace(self.limits.min(), self.limits.max(), _TRIED)
        poses = [self.direct(np.full(3, angle)).poses[:1] for angle in angles]
        return Mechanism.of(self, limbs, np.concatenate(poses))

    def inverse(self, T: ArrayLike, *, seed: ArrayLike | None = None) -> LimbPostures:
        """Find all angles of the arms that hold the platform in a place: up to eight.

        Parameters
        ----------
        T : array_like, shape (4, 4) or (3,)
            ``T_base_platform``, without rotation, or the position alone (m).
        seed : array_like, shape (3,), optional
            Angles (rad): the nearest posture comes first.

        Returns
        -------
        LimbPostures
            The branch ``-`` has its elbow outwards.
        """
        point = translation_only(T)
        angles, excess = np.empty((3, 2)), np.empty(3)
        count = kernels.delta_angles(self._geometry, self.azimuths, point, angles, excess)
        if count < 0:
            limbs = [Limb((), any_angle=True)] * 3
        else:
            limbs = [
                Limb(tuple(both), float(over))
                for both, over in zip(angles.tolist(), excess, strict=True)
            ]
        return postures(limbs, self.limits, seed)

    def direct(self, q: ArrayLike, seed: ArrayLike | None = None) -> DirectKinematicsResult:
        """Find all poses of the platform for the angles of the arms: up to two.

        Parameters
        ----------
        q : array_like, shape (3,)
            Downwards from the horizontal (rad).
        seed : array_like, shape (4, 4) or (3,), optional
            A place: the nearest one comes first; else the lower one.
        """
        given = actuated("q", q, 3)
        near = None if seed is None else translation_only(seed)
        points, report = np.empty((2, 3)), np.empty(1)
        count = kernels.delta_points(self._geometry, self.azimuths, given, points, report)
        points = points[: max(count, 0)]
        points = points[np.argsort(points[:, 2], kind="stable")]
        multiplicity = np.ones(len(points), np.int64)
        status, reason = Code.NONE, ""
        if count < 0:
            status = Code.SINGULAR_CONTINUUM
            reason = "the forearms' spheres have their centres in a line: they share a circle"
        elif count == 0:
            status = Code.OUT_OF_REACH
            gap = float(np.sqrt(self.forearm**2 - report[0]) - self.forearm)
            reason = f"no real pose: the forearms are too short by {gap:.3g} m"
        elif count == 1:
            multiplicity[0] = 2
            reason = "1 pose is singular: assembly modes meet there"
        poses = assembled(np.eye(3), points)
        errors = self._errors(points, given)
        found = DirectKinematicsResult(
            poses, multiplicity, count >= 0, self.family, status, reason, errors
        )
        return found if near is None else nearest_first(found, assembled(np.eye(3), near), 1.0)

    def _errors(self, points: Array, q: Array) -> Array:
        """Return by how much forearms miss their length (k,), m."""
        out = self.base_radius - self.platform_radius + self.arm * np.cos(q)
        x, y = out * np.cos(self.azimuths), out * np.sin(self.azimuths)
        centres = np.stack((x, y, -self.arm * np.sin(q)), axis=1)
        lengths = np.linalg.norm(points[:, None] - centres, axis=2)
        return np.asarray(np.abs(lengths - self.forearm).max(axis=1, initial=0.0))
