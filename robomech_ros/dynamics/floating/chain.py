"""A chain on a free base: momentum, generalised Jacobian, dynamics, reactionless motions."""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.chain.serial import NOT_FINITE
from robomech_ros._kernels.dynamics.layout import MASS
from robomech_ros._kernels.dynamics.mass import totals
from robomech_ros.dynamics.floating.equations import (
    WEIGHTLESS,
    check_status,
    floating_accelerations,
    floating_efforts,
    floating_inertia,
    floating_models,
)
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots.bodies import Body
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import LEAST, as_choice, as_single, real_array
from robomech_ros.typing import Array, ArrayLike

STILL = ("pose", "orientation")
# Singular values below this part of the greatest count as zero.
_ZERO = 1e-9
# Least eigenvalue of a locked inertia scaled to a unit diagonal; rounding leaves 1e-16 of zero.
_SINGULAR = 1e-14
# Part of the greatest singular value of the generalised Jacobian below which it is singular.
_SINGULAR_JACOBIAN = 1e-4


class FloatingChain:
    r"""A serial chain on a free-floating base, such as an arm on a spacecraft.

    The rates are ``u = [omega; v; qd]``, shape (6 + n,): the twist of the base at its origin and in
    its axes, then the joint rates.  Accelerations are their derivatives in the same axes.
    Efforts are ``[n; f; tau]``: the wrench on the base, then the drive torques.  With the momentum
    :math:`\mu` about the origin of the base,

    .. math::

       \begin{bmatrix} H_b & H_{bm} \\ H_{bm}^T & H_m \end{bmatrix} \dot u + h(q, u)
       = \begin{bmatrix} w \\ \tau \end{bmatrix}, \qquad \mu = H_b t_b + H_{bm} \dot q

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints with the bodies of its links.
    base : Body, optional
        Body fixed to the base link, in its frame.  Default no mass, as for a leg whose trunk is
        modelled elsewhere.

    Raises
    ------
    MissingInertiaError, BadValueError
        A body is unknown or impossible, or joints are coupled.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.5.2; Umetani, Yoshida,
    Resolved motion rate control of space manipulators with generalized Jacobian matrix, IEEE Trans.
    Robotics and Automation 5, 1989.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.dynamics import FloatingChain
    >>> from robomech_ros.robots import Body, load_robot
    >>> robot = FloatingChain(load_robot("iiwa14"), Body(200.0, [0.0, 0.0, -0.5], 30.0 * np.eye(3)))
    >>> rates = robot.rates(robot.chain.home(), np.full(7, 0.1))
    >>> bool(np.abs(robot.momentum(robot.chain.home(), rates)).max() < 1e-12)
    True
    """

    def __init__(self, chain: SerialChain, base: Body | None = None) -> None:
        check_chain(chain)
        chain.require_uncoupled()
        self.chain, self.base, self._models = chain, base, floating_models([chain], base)
        self._shapes = {0: (chain.n,), 6: (6 + chain.n,)}

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.chain.n

    @property
    def mass(self) -> float:
        """Mass of base and links (kg)."""
        return float(self._models[0, :, MASS].sum())

    def mass_matrix(self, q: ArrayLike) -> Array:
        """Compute the generalised inertia (6 + n, 6 + n) of the rates u at joint values (n,)."""
        return floating_inertia(self._models, self._values("q", q)[None])

    def momentum(self, q: ArrayLike, rates: ArrayLike) -> Array:
        """Compute the momentum of base and links about their mass centre, shape (6,).

        Parameters
        ----------
        q : array_like, shape (n,)
            Joint values (rad or m).
        rates : array_like, shape (6 + n,)
            u (rad/s, m/s and those of the joints).

        Returns
        -------
        ndarray, shape (6,)
            Angular (kg m^2/s), then linear momentum (kg m/s), in the axes of the base.
        """
        totals = self._totals(q, rates)
        found = totals[4:10].copy()
        found[:3] -= np.cross(totals[1:4] / totals[0], found[3:])
        return found

    def center_of_mass(self, q: ArrayLike) -> Array:
        """Compute the mass centre of base and links in the base (m), shape (3,)."""
        totals = self._totals(q, np.zeros(6 + self.n))
        return totals[1:4] / totals[0]

    def kinetic_energy(self, q: ArrayLike, rates: ArrayLike) -> float:
        """Compute the kinetic energy of base, links and rotors (J)."""
        return float(self._totals(q, rates)[10])

    def rates(self, q: ArrayLike, qd: ArrayLike, momentum: ArrayLike | None = None) -> Array:
        """Return u, shape (6 + n,), for joint rates and a momentum of the robot.

        Parameters
        ----------
        q, qd : array_like, shape (n,)
            Joint values (rad or m) and rates (rad/s or m/s).
        momentum : array_like, shape (6,), optional
            As from :meth:`momentum`.  Default zero.
        """
        given = self._values("qd", qd)
        H, about = self.mass_matrix(q), np.zeros(6)
        with np.errstate(over="ignore", invalid="ignore"):
            if momentum is not None:
                about = as_single("momentum", momentum, (6,)).copy()
                about[:3] += H[:3, 3:6] @ about[3:] / H[3, 3]
            twist = self._solved(H[:6, :6], about - H[:6, 6:] @ given)
        if not np.isfinite(twist).all():
            check_status(NOT_FINITE, qd=given, momentum=momentum)
        return np.concatenate((twist, given))

    def generalized_jacobian(self, q: ArrayLike) -> Array:
        r"""Compute the Jacobian from joint rates to the tip twist at zero momentum.

        .. math:: J_g = J_m - J_b H_b^{-1} H_{bm}

        Parameters
        ----------
        q : array_like, shape (n,)
            Joint values (rad or m).

        Returns
        -------
        ndarray, shape (6, n)
            Twists [omega; v] in inertial space, at the tip's origin and in the axes of the base.
        """
        H = self.mass_matrix(q)
        return self.tip_jacobian(q) @ np.vstack(
            (-self._solved(H[:6, :6], H[:6, 6:]), np.eye(self.n))
        )

    def joint_rates(
        self, q: ArrayLike, twist: ArrayLike, momentum: ArrayLike | None = None
    ) -> Array:
        """Return the joint rates for a tip twist in inertial space; zero holds a drifting tip.

        Parameters
        ----------
        q : array_like, shape (n,)
            Joint values (rad or m).
        twist : array_like, shape (6,)
            [omega; v] of the tip in inertial space (rad/s, m/s), at the tip's origin and in the
            axes of the base.
        momentum : array_like, shape (6,), optional
            As for :meth:`rates`.  Default zero.

        Returns
        -------
        ndarray, shape (n,)
            The least-norm solution.

        Raises
        ------
        BadValueError
            The generalised Jacobian is singular.
        """
        adrift = self.rates(q, np.zeros(self.n), momentum)
        found, regular = least_rates(self, q, as_single("twist", twist, (6,)), adrift)
        if not regular:
            expected = "a posture with a regular generalised Jacobian"
            raise BadValueError("q", np.asarray(q).tolist(), expected)
        return found

    def tip_jacobian(self, q: ArrayLike) -> Array:
        """Return the matrix from u to the twist of the tip in the axes of the base, (6, 6 + n)."""
        values = self._values("q", q)
        x, y, z = forward_kinematics(self.chain, values)[:3, 3]
        J = np.hstack((np.eye(6), jacobian(self.chain, values)))
        J[3:, :3] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
        return J

    def reactionless(self, q: ArrayLike, still: str = "pose") -> Array:
        """Return an orthonormal basis of the joint rates that leave the base still.

        Parameters
        ----------
        q : array_like, shape (n,)
            Joint values (rad or m).
        still : {"pose", "orientation"}, optional
            Property of the base that stays constant.

        Returns
        -------
        ndarray, shape (n, k)
            k is n - 6 or n - 3 in regular postures; the momentum is zero.
        """
        H = self.mass_matrix(q)
        rows = H[:6, 6:]
        if as_choice("still", still, STILL) == "orientation":
            rows = self._solved(H[:6, :6], rows)[:3]
        _, s, Vt = np.linalg.svd(rows)
        rank = int((s > _ZERO * s[0]).sum())
        return np.ascontiguousarray(Vt[rank:].T)

    def inverse(
        self,
        q: ArrayLike,
        rates: ArrayLike,
        accelerations: ArrayLike,
        *,
        gravity: ArrayLike = WEIGHTLESS,
        tip_wrench: ArrayLike | None = None,
    ) -> Array:
        """Compute the wrench on the base and the drive torques of a motion.

        Parameters
        ----------
        q : array_like, shape (n,)
            Joint values (rad or m).
        rates, accelerations : array_like, shape (6 + n,)
            u and its derivative.
        gravity : array_like, shape (3,), optional
            In the axes of the base (m/s^2).  Default none.
        tip_wrench : array_like, shape (6,), optional
            Wrench [n; f] on the tip, at its origin, in the axes of the base.

        Returns
        -------
        ndarray, shape (6 + n,)
            ``[n; f; tau]`` (N m, N and those of the drives).
        """
        values, u = self._values("q", q), self._values("rates", rates, 6)
        change = self._values("accelerations", accelerations, 6)
        return floating_efforts(self._models, values[None], u, change, gravity, tip_wrench)

    def forward(
        self,
        q: ArrayLike,
        rates: ArrayLike,
        efforts: ArrayLike,
        *,
        gravity: ArrayLike = WEIGHTLESS,
        tip_wrench: ArrayLike | None = None,
    ) -> Array:
        """Compute the accelerations (6 + n,) that efforts cause.

        Parameters
        ----------
        q : array_like, shape (n,)
            Joint values (rad or m).
        rates : array_like, shape (6 + n,)
            u.
        efforts : array_like, shape (6 + n,)
            ``[n; f; tau]``; the wrench on a free base is zero.
        gravity, tip_wrench
            As for :meth:`inverse`.
        """
        values, u = self._values("q", q), self._values("rates", rates, 6)
        given = self._values("efforts", efforts, 6)
        return floating_accelerations(self._models, values, u, given, gravity, tip_wrench)

    def torques(self, q: ArrayLike, rates: ArrayLike, qdd: ArrayLike) -> tuple[Array, Array]:
        """Compute the torques for joint accelerations while the base floats.

        Parameters
        ----------
        q, qdd : array_like, shape (n,)
            Joint values and accelerations.
        rates : array_like, shape (6 + n,)
            u.

        Returns
        -------
        torques : ndarray, shape (n,)
            N m or N.
        base : ndarray, shape (6,)
            Derivative of the twist of the base.
        """
        change = np.concatenate((np.zeros(6), self._values("qdd", qdd)))
        held = self.inverse(q, rates, change)
        H = self.mass_matrix(q)
        base = self._solved(H[:6, :6], -held[:6])
        return held[6:] + H[6:, :6] @ base, base

    def _values(self, what: str, value: ArrayLike, more: int = 0) -> Array:
        """Check the shape (more + n,) of an array; kernels check that it is finite."""
        array = real_array(what, value)
        if not array.flags.c_contiguous:
            array = np.ascontiguousarray(array)
        if array.shape != self._shapes[more]:
            raise WrongSizeError(what, array.shape, str(self._shapes[more]))
        return array

    def _totals(self, q: ArrayLike, rates: ArrayLike) -> Array:
        """Compute mass, first moment (3), momentum about the base's origin (6) and energy."""
        values, u = self._values("q", q), self._values("rates", rates, 6)
        out, joints = np.empty((1, 11)), np.concatenate((np.zeros(6), values))
        moving = np.concatenate((u[3:6], u[:3], u[6:]))
        status = totals(self._models[0], joints[None], moving[None], out)
        check_status(status, q=values, rates=u)
        return out[0]

    def _solved(self, H: Array, right: Array) -> Array:
        """Solve with the locked inertia, which can be singular for a base without mass."""
        scale = 1.0 / np.sqrt(np.maximum(H.diagonal(), LEAST))
        if not np.linalg.eigvalsh(H * np.outer(scale, scale))[0] > _SINGULAR:
            expected = "bodies that resist every motion of the base"
            raise BadValueError("least inertia of the floating chain", 0.0, expected)
        return np.asarray(np.linalg.solve(H, right))


def least_rates(
    robot: FloatingChain, q: ArrayLike, twist: Array, adrift: Array
) -> tuple[Array, bool]:
    """Return the least-norm joint rates (n,) for a tip twist, and whether they reach all of it.

    ``adrift``: rates u (6 + n,) of the drifting base while the joints stand still.
    """
    needed = twist - robot.tip_jacobian(q) @ adrift
    J = robot.generalized_jacobian(q)
    found, _, rank, _ = np.linalg.lstsq(J, needed, rcond=_SINGULAR_JACOBIAN)
    return np.asarray(found, dtype=np.float64), bool(rank == 6)
