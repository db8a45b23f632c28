"""Dynamics of a walking machine: a floating trunk with legs, on planted feet and in stride."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros.dynamics.checked_states import as_vector
from robomech_ros.dynamics.complement.stacking import solve
from robomech_ros.dynamics.floating.chain import floating_efforts, floating_inertia, floating_models
from robomech_ros.dynamics.model import GRAVITY
from robomech_ros.errors import MissingInertiaError
from robomech_ros.kinetostatics import bias_acceleration
from robomech_ros.robots.bodies import Body, possible_body
from robomech_ros.spatial import cross_product_matrix
from robomech_ros.spatial.arrays import as_single, check_kind
from robomech_ros.typing import Array, ArrayLike
from robomech_ros.walking.ground_forces import UPWARDS, FootForces, foot_forces
from robomech_ros.walking.robot import LeggedRobot
from robomech_ros.walking.stance_mechanism import contact_rows


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
        u = self._all_rates("rates", rates)
        du = self._all_rates("accelerations", accelerations)
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
        standing, lifted = self._legs_by_contact(stance)
        feet, J = self.robot.feet(q), self.robot.foot_jacobians(q)
        self.robot.check_regular(q, J, standing)
        N = np.zeros((6 + self.robot.n, 6 + 3 * len(lifted)))
        N[:6, :6] = np.eye(6)
        found = np.linalg.solve(J[standing], contact_rows(feet[standing]).reshape(-1, 3, 6))
        N[6:, :6].reshape(-1, 3, 6)[standing] = -found
        for i, k in enumerate(lifted):
            N[6 + 3 * k : 9 + 3 * k, 6 + 3 * i : 9 + 3 * i] = np.eye(3)
        return N

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
        N = self.complement(q, stance)
        w = as_vector("independent", independent, N.shape[1])
        dw = as_vector("changes", changes, N.shape[1])
        u = N @ w
        return u, N @ dw + self._drift(q, u, stance)

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
        N = self.complement(q, stance)
        tau, gravity = as_vector("torques", torques, self.robot.n), as_vector("gravity", gravity, 3)
        u = N @ as_vector("independent", independent, N.shape[1])
        drift = self._drift(q, u, stance)
        left = np.concatenate((np.zeros(6), tau)) - self.inverse(q, u, drift, gravity=gravity)
        du = drift + N @ np.linalg.solve(N.T @ self.mass_matrix(q) @ N, N.T @ left)
        lacking = (self.inverse(q, u, du, gravity=gravity)[6:] - tau).reshape(-1, 3)
        standing, _ = self._legs_by_contact(stance)
        forces, J = np.zeros((len(self.robot.legs), 3)), self.robot.foot_jacobians(q)[standing]
        forces[standing] = solve(J.transpose(0, 2, 1), lacking[standing])
        return PlantedMotion(du, forces)

    def _drift(self, q: ArrayLike, u: Array, stance: Sequence[str] | None) -> Array:
        """Return the derivative of u, feet still, while w is constant: ``dN/dt w``, (6 + 3 k,)."""
        standing, _ = self._legs_by_contact(stance)
        rows, speeds = self.robot.joints(q), u[6:].reshape(-1, 3)
        J = self.robot.foot_jacobians(q)[standing]
        legs = self.robot.legs
        bent = np.array([bias_acceleration(legs[k], rows[k], speeds[k])[3:] for k in standing])
        turned = np.einsum("kij,kj->ki", J, speeds[standing]) @ cross_product_matrix(u[:3]).T
        drift = np.zeros(6 + self.robot.n)
        drift[6:].reshape(-1, 3)[standing] = -solve(J, turned + bent)
        return drift

    def _legs_by_contact(self, stance: Sequence[str] | None) -> tuple[list[int], list[int]]:
        """Return the numbers of the standing legs, and of the lifted ones."""
        standing = list(self.robot.standing(stance, 1))
        return standing, [k for k in range(len(self.robot.legs)) if k not in standing]

    def _all_rates(self, what: str, value: ArrayLike) -> Array:
        return np.ascontiguousarray(as_single(what, value, (6 + self.robot.n,)))
