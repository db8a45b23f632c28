"""Dynamics of a walking machine: a floating trunk with legs, on planted feet and in stride."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.walking.planted import planted_forward
from robomech_ros.dynamics.checked_states import as_vector
from robomech_ros.dynamics.floating.equations import (
    check_status,
    floating_efforts,
    floating_inertia,
    floating_models,
)
from robomech_ros.dynamics.model import GRAVITY, surroundings
from robomech_ros.errors import MissingInertiaError
from robomech_ros.robots.bodies import Body, possible_body
from robomech_ros.spatial.arrays import as_single, check_kind
from robomech_ros.typing import Array, ArrayLike
from robomech_ros.walking.ground_forces import UPWARDS, FootForces, foot_forces
from robomech_ros.walking.robot import LeggedRobot

_planted_forward = direct(planted_forward)


@dataclass(frozen=True, eq=False)
class PlantedMotion:
    """Motion caused by torques while feet stand still.

    Attributes
    ----------
    accelerations : ndarray, shape (6 + 3 k,)
        Derivative of the twist of the trunk in its axes, then joint accelerations.
    forces : ndarray, shape (k, 3)
        Ground force on each foot (N), in the axes of the trunk; its normal part is negative if the
        ground would have to pull.
    """

    accelerations: Array
    forces: Array


class WalkingDynamics:
    r"""A legged robot as a floating trunk with k legs of three joints each.

    The rates are ``u = [omega; v; qd]``, shape (6 + 3 k,): the twist of the trunk at its origin and
    in its axes, then the joint rates, leg by leg; efforts are ``[n; f; tau]``.  While feet stand
    still, the twist of the trunk and the rates of lifted legs, w, determine ``u = N w`` with an
    orthogonal complement N of the constraints.  Ground forces drop out of

    .. math:: N^T M N \dot w = N^T (B \tau - M \dot N w - h)

    Parameters
    ----------
    robot : LeggedRobot
        Robot with the bodies of its legs.
    trunk : Body, optional
        Body of the trunk with everything fixed to it, in its frame.  Default ``robot.trunk_body``.

    Raises
    ------
    MissingInertiaError
        The mass of the trunk or of a leg's link is unknown.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 7.5, 10.4 and 12.3.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.walking import WalkingDynamics, load_legged
    >>> robot = load_legged("go1")
    >>> standing = WalkingDynamics(robot).share_load(robot.home, np.zeros(18), np.zeros(18))
    >>> round(float(standing.forces[:, 2].sum()), 2)
    110.94
    """

    def __init__(self, robot: LeggedRobot, trunk: Body | None = None) -> None:
        check_kind("robot", robot, LeggedRobot, "a LeggedRobot")
        body = robot.trunk_body if trunk is None else trunk
        if body is None:
            raise MissingInertiaError([robot.trunk], robot.joint_names)
        self.robot, self._models = robot, floating_models(robot.legs, possible_body("trunk", body))

    def mass_matrix(self, q: ArrayLike) -> Array:
        """Compute the generalised inertia of the rates u, shape (6 + 3 k, 6 + 3 k).

        Parameters
        ----------
        q : array_like, shape (3 k,)
            All joints (rad or m).
        """
        return floating_inertia(self._models, self.robot.joints(q))

    def inverse(
        self,
        q: ArrayLike,
        rates: ArrayLike,
        accelerations: ArrayLike,
        *,
        gravity: ArrayLike = GRAVITY,
    ) -> Array:
        """Compute the wrench on the trunk and the torques of a motion without forces at the feet.

        Parameters
        ----------
        q : array_like, shape (3 k,)
            All joints (rad or m).
        rates, accelerations : array_like, shape (6 + 3 k,)
            u and its derivative.
        gravity : array_like, shape (3,), optional
            In the axes of the trunk (m/s^2).

        Returns
        -------
        ndarray, shape (6 + 3 k,)
            ``[n; f; tau]`` (N m, N and those of the joints).
        """
        rows = self.robot.joints(q)
        u = self._vector("rates", rates, 6 + self.robot.n)
        du = self._vector("accelerations", accelerations, 6 + self.robot.n)
        return floating_efforts(self._models, rows, u, du, gravity)

    def share_load(
        self,
        q: ArrayLike,
        rates: ArrayLike,
        accelerations: ArrayLike,
        *,
        stance: Sequence[str] | None = None,
        gravity: ArrayLike = GRAVITY,
        friction: float = 0.6,
        normals: ArrayLike = UPWARDS,
        smallest: str = "forces",
    ) -> FootForces:
        """Compute the ground forces and joint torques of a motion.

        Parameters
        ----------
        q, rates, accelerations, gravity
            As for :meth:`inverse`; feet that stand should not move (:meth:`stance_motion`).
        stance, friction, normals, smallest
            As for :func:`foot_forces`.

        Raises
        ------
        MissingSupportError, LimitExceededError
            As for :func:`foot_forces`.
        """
        efforts = self.inverse(q, rates, accelerations, gravity=gravity)
        return foot_forces(
            self.robot,
            q,
            -efforts[:6],
            stance=stance,
            friction=friction,
            normals=normals,
            torques=efforts[6:],
            smallest=smallest,
        )

    def complement(self, q: ArrayLike, stance: Sequence[str] | None = None) -> Array:
        """Compute the matrix N from the twist of the trunk and the rates of lifted legs to u.

        Parameters
        ----------
        q : array_like, shape (3 k,)
            All joints (rad or m).
        stance : sequence of str, optional
            The legs that stand, default all.

        Returns
        -------
        ndarray, shape (6 + 3 k, 6 + 3 m)
            For m legs in the air, in their order.
        """
        return self.robot.planted_legs(q, stance)[0]

    def stance_motion(
        self,
        q: ArrayLike,
        independent: ArrayLike,
        changes: ArrayLike,
        stance: Sequence[str] | None = None,
    ) -> tuple[Array, Array]:
        """Complete a motion of the trunk and of legs in the air so that the other feet stand still.

        Parameters
        ----------
        q : array_like, shape (3 k,)
            All joints (rad or m).
        independent, changes : array_like, shape (6 + 3 m,)
            w and its derivative: the twist of the trunk, then the rates of m legs in the air.
        stance : sequence of str, optional
            The legs that stand, default all.

        Returns
        -------
        rates, accelerations : ndarray, shape (6 + 3 k,)
            u and its derivative.
        """
        N, (u, drift) = self.robot.planted_legs(q, stance, independent)
        return u, N @ as_vector("changes", changes, N.shape[1]) + drift

    def planted_forward(
        self,
        q: ArrayLike,
        independent: ArrayLike,
        torques: ArrayLike,
        *,
        stance: Sequence[str] | None = None,
        gravity: ArrayLike = GRAVITY,
    ) -> PlantedMotion:
        """Compute the motion caused by torques while feet stand still, by the complement N.

        Parameters
        ----------
        q : array_like, shape (3 k,)
            All joints (rad or m).
        independent : array_like, shape (6 + 3 m,)
            The twist of the trunk, then the rates of m legs in the air.
        torques : array_like, shape (3 k,)
            Joint torques (N m or N).
        stance : sequence of str, optional
            The legs that stand, default all.
        gravity : array_like, shape (3,), optional
            In the axes of the trunk (m/s^2).
        """
        N, motion = self.robot.planted_legs(q, stance, independent)
        n, rows, around = self.robot.n, self.robot.joints(q), surroundings((6,), gravity)
        tau, found = self._vector("torques", torques, n), np.empty(6 + 2 * n)
        status = _planted_forward(self._models, rows, tau, around, N, motion, found)
        check_status(status, q=q, independent=independent, torques=tau, gravity=gravity)
        return PlantedMotion(found[: 6 + n], found[6 + n :].reshape(-1, 3))

    def _vector(self, what: str, value: ArrayLike, size: int) -> Array:
        return np.ascontiguousarray(as_single(what, value, (size,)))
