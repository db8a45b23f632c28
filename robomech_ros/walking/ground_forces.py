"""The smallest ground forces on feet that carry a load, and the missing wrench."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from robomech_ros.errors import BadValueError, LimitExceededError, MissingSupportError
from robomech_ros.hands.conic_solver import conic_solver
from robomech_ros.hands.force_program import solver_settings
from robomech_ros.spatial import cross_product_matrix
from robomech_ros.spatial.arrays import as_choice, as_single, check_kind, finite_within
from robomech_ros.typing import Array, ArrayLike, BoolArray
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
_BALANCED = 1e-9
_SCALED = np.array([[1.0 - 1e-8], [1.0], [1.0]])
_MOST_KEPT = 64


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

    The forces carry the load, ``G F = load`` (6,), and keep the limits ``A F <= b``. The force of
    each foot is inside its cone: with the rows c_1, c_2, c_3 of its C (s, 3, 3), ``c_1 F`` is at
    least the norm of ``c_2 F`` and ``c_3 F``.
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
        W, needed = self._balance()
        U, values, Vt = np.linalg.svd(W)
        rank = int((values > _BALANCED * values[0]).sum())
        z = ((needed @ U[:, :rank]) / values[:rank]) @ Vt[:rank]
        size = max(1.0, float(np.abs(self.load).max()))
        if np.abs(W @ z - needed).max() > _BALANCED * size:
            return None
        F, K = self.L @ z + self.offset, self.L @ Vt[rank:].T
        exceeded = self.b < self.A @ F
        if not exceeded.any() and self._inside_cones(F):
            return F
        # K x does not change the load.  Few limits bind: the first program keeps the exceeded ones.
        scale, squares = max(_LEAST_SIZE, float(np.abs(z).max())), _squares(K.shape[1], 0)
        for limits in (exceeded, np.ones_like(exceeded)):
            x, solved = self._program(K, F, squares, scale, limits)
            found = F + K @ x
            if solved and (limits.all() or (self.A @ found <= self.b + _BALANCED * size).all()):
                return found
        return None

    def missing(self, length: float) -> Array:
        """Return the smallest missing wrench (6,), with moments divided by a length (m)."""
        W, needed = self._balance()
        scale, m = np.array([length] * 3 + [1.0] * 3), self.L.shape[1]
        K = np.hstack((self.L, np.zeros((len(self.L), 6))))
        size, limits = max(1.0, float(np.abs(needed).max())), np.ones(len(self.b), np.bool_)
        equal = np.hstack((W, np.diag(scale))), needed
        x, solved = self._program(K, self.offset, _squares(m, 6), size, limits, equal)
        help_needed = scale * x[m:] if solved else self.load
        return np.where(np.abs(help_needed) > 1e-6 * np.abs(help_needed).max(), help_needed, 0.0)

    def _balance(self) -> tuple[Array, Array]:
        """Return the wrenches (6, m) of unit unknowns z, and the wrench that all must exert."""
        return self.G @ self.L, self.load - self.G @ self.offset

    def _inside_cones(self, F: Array) -> bool:
        parts = (self.C @ F.reshape(-1, 3, 1))[:, :, 0]
        return bool((parts[:, 0] >= np.hypot(parts[:, 1], parts[:, 2])).all())

    def _program(
        self,
        K: Array,
        F: Array,
        squares: csc_matrix,
        size: float,
        limits: BoolArray,
        equal: tuple[Array, Array] | None = None,
    ) -> tuple[Array, bool]:
        """Minimize the squares of unknowns x for forces ``F + K x``.

        ``size`` scales all numbers for the solver, ``limits`` chooses rows of A, and ``equal`` is
        the matrix and the right side of more equations in x.
        """
        library, k = conic_solver(), K.shape[1]
        E, e = (np.zeros((0, k)), np.zeros(0)) if equal is None else equal
        cones, A = self.C * _SCALED, self.A[limits]
        rows = np.vstack((E, A @ K, -(cones @ K.reshape(-1, 3, k)).reshape(-1, k)))
        inside = (cones @ F.reshape(-1, 3, 1)).ravel()
        found = library.DefaultSolver(
            squares,
            np.zeros(k),
            _by_columns(rows),
            np.concatenate((e, self.b[limits] - A @ F, inside)) / size,
            [
                library.ZeroConeT(len(e)),
                library.NonnegativeConeT(len(A)),
                *[library.SecondOrderConeT(3)] * len(cones),
            ],
            solver_settings(library),
        ).solve()
        ended = library.SolverStatus
        return size * np.array(found.x), found.status in (ended.Solved, ended.AlmostSolved)


@lru_cache(maxsize=_MOST_KEPT)
def _squares(m: int, more: int) -> csc_matrix:
    """Return the matrix of the sum of the squares of m numbers, or of the others alone."""
    weights = np.repeat([0.0 if more else 1.0, 1.0], [m, more])
    return csc_matrix((weights, np.arange(m + more), np.arange(m + more + 1)))


def _by_columns(dense: Array) -> csc_matrix:
    """Return a matrix for the solver with all entries, faster than scipy's own conversion."""
    rows, columns = dense.shape
    places = _all_places(rows, columns)
    return csc_matrix((dense.T.ravel(), *places), shape=dense.shape)


@lru_cache(maxsize=_MOST_KEPT)
def _all_places(rows: int, columns: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Return the rows of all entries by columns, and where the columns begin."""
    numbers = np.arange(max(rows, columns) + 1, dtype=np.int32)
    starts = (rows * numbers[: columns + 1]).astype(np.int32)
    return np.tile(numbers[:rows], columns), starts


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
        raise MissingSupportError((), (load + 0.0).tolist())
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
