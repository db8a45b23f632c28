"""The smallest ground forces on feet that carry a load, and the missing wrench."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.sparse import csc_matrix

from robomech_ros.errors import BadValueError, LimitExceededError, MissingSupportError
from robomech_ros.hands.conic_solver import conic_solver
from robomech_ros.hands.force_program import solver_settings
from robomech_ros.spatial import cross_product_matrix
from robomech_ros.spatial.arrays import as_choice, as_single, check_kind, finite_within
from robomech_ros.typing import Array, ArrayLike
from robomech_ros.walking.robot import LeggedRobot
from robomech_ros.walking.stance_mechanism import contact_rows

SMALLEST = ("forces", "torques")
UPWARDS = (0.0, 0.0, 1.0)
_MOST_FRICTION = 1e3
# Residual of the solver, as a part of the load.
_OPEN = 1e-7
# Least scale of the unknowns.
_LEAST_SIZE = 1e-6
# Residual of rounding, as a part of the load; part by which the solver's cones are narrower.
_BALANCED, _NARROWER = 1e-9, 1e-8


@dataclass(frozen=True, eq=False)
class FootForces:
    """Ground forces on the feet of a robot with k legs, and joint torques.

    Attributes
    ----------
    forces : ndarray, shape (k, 3)
        On each foot (N), in the axes of the trunk; 0 for feet in the air.
    torques : ndarray, shape (3 k,)
        Joint torques (N m or N).
    used_friction : ndarray, shape (k,)
        Part of the friction cone that each force uses, up to 1.
    used_effort : ndarray, shape (3 k,)
        Part of the effort limit of each joint, NaN without one.
    """

    forces: Array
    torques: Array
    used_friction: Array
    used_effort: Array


@dataclass(frozen=True, eq=False)
class _Share:
    """Program for forces ``F = L z + F_0`` (3 s,) of s feet with the least norm of z.

    The forces carry the load, ``G F = load`` (6,), within ``A F <= b`` and a cone for each foot:
    the product of F with the first of its rows C (s, 3, 3) bounds those with the two others.
    """

    L: Array
    offset: Array
    G: Array
    load: Array
    C: Array
    A: Array
    b: Array

    def solve(self) -> Array | None:
        """Return the forces (3 s,), or None if there are none."""
        W = self.G @ self.L
        needed = self.load - self.G @ self.offset
        size = max(1.0, float(np.abs(self.load).max()))
        z = np.linalg.lstsq(W, needed, rcond=_BALANCED)[0]
        if np.abs(W @ z - needed).max() <= _BALANCED * size:
            F = self.L @ z + self.offset
            if self._holds(F):
                return F
        z, solved = self._program(W, needed, max(_LEAST_SIZE, float(np.abs(z).max())))
        return self.L @ z + self.offset if solved else None

    def missing(self, length: float) -> Array:
        """Return the smallest missing wrench (6,), with moments divided by a length (m)."""
        scale = np.array([length] * 3 + [1.0] * 3)
        W = np.hstack((np.zeros((6, self.L.shape[1])), np.diag(scale)))
        W[:, : self.L.shape[1]] = self.G @ self.L
        needed = self.load - self.G @ self.offset
        z, solved = self._program(W, needed, max(1.0, float(np.abs(needed).max())), 6)
        help_needed = scale * z[self.L.shape[1] :] if solved else self.load
        return np.where(np.abs(help_needed) > 1e-6 * np.abs(help_needed).max(), help_needed, 0.0)

    def _holds(self, F: Array) -> bool:
        """Return whether forces are inside cones and limits."""
        parts = np.einsum("kij,kj->ki", self.C, F.reshape(-1, 3))
        inside = parts[:, 0] >= np.hypot(parts[:, 1], parts[:, 2])
        return bool(inside.all() and (self.b >= self.A @ F).all())

    def _program(self, W: Array, needed: Array, size: float, more: int = 0) -> tuple[Array, bool]:
        """Minimize the norm of z, or of the last ``more`` unknowns alone, the missing wrench.

        ``size`` scales all numbers for the solver.
        """
        library = conic_solver()
        m = self.L.shape[1]
        cones = self.C * np.array([1.0 - _NARROWER, 1.0, 1.0])[:, None]
        blocks = [-np.einsum("kij,kjl->kil", cones, self.L.reshape(-1, 3, m)).reshape(-1, m)]
        moved = np.einsum("kij,kj->ki", cones, self.offset.reshape(-1, 3)).ravel()
        rows = np.zeros((6 + len(self.b) + len(moved), m + more))
        rows[:6] = W
        rows[6:, :m] = np.vstack((self.A @ self.L, *blocks))
        right = np.concatenate((needed, self.b - self.A @ self.offset, moved)) / size
        kinds = [library.ZeroConeT(6), library.NonnegativeConeT(len(self.b))]
        kinds += [library.SecondOrderConeT(3)] * len(self.C)
        found = library.DefaultSolver(
            _squares(m, more),
            np.zeros(m + more),
            _by_columns(rows),
            right,
            kinds,
            solver_settings(library),
        ).solve()
        ended = library.SolverStatus
        solved = found.status in (ended.Solved, ended.AlmostSolved)
        return size * np.array(found.x), solved


@cache
def _squares(m: int, more: int) -> csc_matrix:
    """Return the matrix of the sum of the squares of m numbers, or of the others alone."""
    count = m + more
    weights = np.repeat([0.0 if more else 1.0, 1.0], [m, more])
    return csc_matrix((weights, np.arange(count), np.arange(count + 1)))


def _by_columns(dense: Array) -> csc_matrix:
    """Return a sparse matrix for the solver, faster than scipy's own conversion."""
    present = dense.T != 0.0
    starts = np.concatenate(([0], np.cumsum(present.sum(axis=1))))
    return csc_matrix((dense.T[present], np.nonzero(present)[1], starts), shape=dense.shape)


def foot_forces(
    robot: LeggedRobot,
    q: ArrayLike,
    wrench: ArrayLike,
    *,
    stance: Sequence[str] | None = None,
    friction: float = 0.6,
    normals: ArrayLike = UPWARDS,
    torques: ArrayLike | None = None,
    smallest: str = "forces",
) -> FootForces:
    r"""Compute the smallest ground forces on the feet that carry a load.

    .. math::

       \min \sum_i |f_i|^2, \quad \sum_i \begin{bmatrix} p_i \times f_i \\ f_i \end{bmatrix} = -w,
       \quad |f_i - n_i n_i^T f_i| \le \mu\, n_i^T f_i, \quad |\tau_i - J_i^T f_i| \le e_i

    Parameters
    ----------
    robot : LeggedRobot
        Robot of k legs; finite values of ``robot.effort`` limit the torques.
    q : array_like, shape (3 k,)
        All joints (rad or m).
    wrench : array_like, shape (6,)
        Wrench on the robot besides ground forces, such as its weight: moment about the origin of
        the trunk (N m), then force (N), in its axes.
    stance : sequence of str, optional
        The legs that stand, default all.
    friction : float, optional
        Largest tangential force as a share of the normal force.
    normals : array_like, shape (3,) or (k, 3), optional
        Directions out of the ground at the feet, in the axes of the trunk.
    torques : array_like, shape (3 k,), optional
        Joint torques without ground forces, for weight and inertia of the legs (N m or N).  Default
        0.
    smallest : {"forces", "torques"}, optional
        The smallest sum of squares: of the forces, or of the torques as parts of their limits, for
        which all joints share the load.

    Returns
    -------
    FootForces
        Equilibrium to 1e-8 of the load.

    Raises
    ------
    MissingSupportError
        The feet cannot carry the load; the error has the missing wrench.
    LimitExceededError
        A lifted leg is too heavy for a joint.
    BadValueError, WrongSizeError, ConicSolverUnavailableError
        An argument is wrong; for smallest torques, a standing leg is singular or a joint has no
        effort limit; or the extra ``hands`` is not installed.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.4; Boyd and Wegbreit,
    Fast Computation of Optimal Contact Forces, IEEE Trans. Robotics 23, 2007.

    Examples
    --------
    >>> from robomech_ros.walking import foot_forces, load_legged
    >>> robot = load_legged("phantomx")
    >>> found = foot_forces(robot, robot.home, [0.0, 0.0, 0.0, 0.0, 0.0, -12.0])
    >>> found.forces[:, 2].round(6).tolist()
    [2.0, 2.0, 2.0, 2.0, 2.0, 2.0]
    """
    check_kind("robot", robot, LeggedRobot, "a LeggedRobot")
    load = -as_single("wrench", wrench, (6,))
    own = np.zeros(robot.n) if torques is None else as_single("torques", torques, (robot.n,))
    mu = finite_within("friction", friction, f"0 to {_MOST_FRICTION:g}", 0.0, _MOST_FRICTION)
    upward = _unit_normals(normals, len(robot.legs))
    standing = list(robot.standing(stance, 0))
    _check_lifted(robot, standing, own)
    feet = robot.feet(q)
    J = robot.foot_jacobians(q)
    if not standing:
        raise MissingSupportError((), load.tolist())
    share = _share(robot, standing, (q, feet, J, own), load, (mu, upward), smallest)
    F = share.solve()
    if F is None:
        missing = share.missing(float(np.abs(feet).max()))
        raise MissingSupportError([robot.leg_names[k] for k in standing], missing.tolist())
    forces = np.zeros((len(robot.legs), 3))
    forces[standing] = F.reshape(-1, 3)
    exerted = own - np.einsum("kij,ki->kj", J, forces).ravel()
    along = np.einsum("ki,ki->k", forces, upward)
    aside = np.linalg.norm(forces - along[:, None] * upward, axis=1)
    # A force within the residual of the solver uses no friction.
    pressed = mu * along > _OPEN * np.abs(load[3:]).max()
    used = np.divide(aside, mu * along, out=np.zeros_like(along), where=pressed)
    return FootForces(forces, exerted, used, np.abs(exerted) / robot.effort)


def _share(
    robot: LeggedRobot,
    standing: list[int],
    state: tuple[ArrayLike, Array, Array, Array],
    load: Array,
    ground: tuple[float, Array],
    smallest: str,
) -> _Share:
    """Lay out the program for joints, feet, Jacobians and own torques, friction and normals."""
    q, feet, J, own = state
    mu, upward = ground
    size = 3 * len(standing)
    turned, mine = np.zeros((size, size)), own.reshape(-1, 3)[standing].ravel()
    for i, k in enumerate(standing):
        turned[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = J[k].T
    limits = robot.effort.reshape(-1, 3)[standing].ravel()
    L: Array = np.eye(size)
    offset: Array = np.zeros(size)
    if as_choice("smallest", smallest, SMALLEST) == "torques":
        robot.check_regular(q, J, standing)
        if not np.isfinite(limits).all():
            raise BadValueError("effort limits", robot.effort.tolist(), "one for each joint")
        L = np.asarray(np.linalg.inv(turned / limits[:, None]), dtype=np.float64)
        offset = np.asarray(np.linalg.solve(turned, mine), dtype=np.float64)
    G, C = contact_rows(feet[standing]).T, _cone_rows(mu, upward[standing])
    limited = np.isfinite(limits)
    pressed = np.zeros((len(standing), size))
    for i, k in enumerate(standing):
        pressed[i, 3 * i : 3 * i + 3] = -upward[k]
    A = np.vstack((turned[limited], -turned[limited], pressed))
    bounds = (limits + mine)[limited], (limits - mine)[limited], np.zeros(len(standing))
    return _Share(L, offset, G, load, C, A, np.concatenate(bounds))


def _cone_rows(mu: float, n: Array) -> Array:
    """Return the rows (s, 3, 3) of friction cones: the first product bounds the two others."""
    across = cross_product_matrix(n)
    first = across[np.arange(len(n)), :, np.abs(n).argmin(axis=1)]
    first = first / np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack((mu * n, first, (across @ first[:, :, None])[:, :, 0]), axis=1)


def _unit_normals(normals: ArrayLike, k: int) -> Array:
    """Check one normal for all feet, or one for each, and return them (k, 3)."""
    given = np.asarray(normals, dtype=object)
    shape = (3,) if given.ndim == 1 else (k, 3)
    array = np.broadcast_to(as_single("normals", normals, shape), (k, 3))
    largest = np.abs(array).max(axis=1, keepdims=True)
    if not largest.min() > 0.0:
        raise BadValueError("normals", array.tolist(), "directions out of the ground")
    # Scaled, so that no square overflows or vanishes.
    array = array / largest
    return array / np.linalg.norm(array, axis=1, keepdims=True)


def _check_lifted(robot: LeggedRobot, standing: list[int], own: Array) -> None:
    """Refuse lifted legs whose torques exceed their effort limits."""
    for leg in set(range(len(robot.legs))) - set(standing):
        for j in range(3 * leg, 3 * leg + 3):
            if abs(own[j]) > robot.effort[j]:
                unit = "N m" if robot.units[j] == "rad" else "N"
                limit = float(np.copysign(robot.effort[j], own[j]))
                raise LimitExceededError("effort", robot.joint_names[j], float(own[j]), limit, unit)
