"""Identification of bodies and friction from motions and measured torques.

Torques are linear in the bodies' parameters; those combinations that any motion shows, the base
parameters, and viscous and Coulomb friction are found by least squares.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., ch. 7 and appendix B.
Gautier, Khalil, Exciting trajectories for the identification of base inertial parameters of robots,
Int. J. Robotics Research 11, 1992.
Swevers et al., Optimal robot excitation and identification, IEEE Trans. Robotics and Automation 13,
1997.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robomech_ros.dynamics.checked_states import as_vector, finite_states
from robomech_ros.dynamics.identification.regressor import (
    BaseParameters,
    base_parameters,
    torque_regressor,
)
from robomech_ros.dynamics.model import GRAVITY, body_parameters
from robomech_ros.dynamics.posed_bodies import reflected_inertias
from robomech_ros.dynamics.pseudo_inertias import is_physically_consistent
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.numerics import least_squares, minimum_norm
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike, BoolArray

# Singular values below this of the largest: the motion does not show all parameters.
_RANK = 1e-9
# Least deviation of torques (N m or N) that weights are made of.
_LEAST_DEVIATION = 1e-12


@dataclass(frozen=True, eq=False)
class Identification:
    """Body and friction parameters identified from motions of a chain.

    Parameters
    ----------
    chain : SerialChain
        As it was described before.
    base : BaseParameters
        Which combinations of parameters are found.
    values : ndarray, shape (r + 2 n,)
        Base parameters, then the viscous and the Coulomb friction of the joints (SI units).
    covariance : ndarray, shape (r + 2 n, r + 2 n)
        Covariance of the values.
    condition : float
        Condition number of the regressor, weighted, with columns of unit length.
    deviations : ndarray, shape (n,)
        Standard deviations of the torques that are left (N m or N).
    """

    chain: SerialChain
    base: BaseParameters
    values: Array
    covariance: Array
    condition: float
    deviations: Array

    @property
    def base_values(self) -> Array:
        """Base parameters, shape (r,)."""
        return self.values[: self.base.rank]

    @property
    def viscous(self) -> Array:
        """Viscous friction, shape (n,) (N m s/rad or N s/m)."""
        return self.values[self.base.rank : self.base.rank + self.chain.n]

    @property
    def coulomb(self) -> Array:
        """Coulomb friction, shape (n,) (N m or N)."""
        return self.values[self.base.rank + self.chain.n :]

    @cached_property
    def standard_errors(self) -> Array:
        """Standard errors of the values, shape (r + 2 n,)."""
        return np.sqrt(np.diag(self.covariance))

    @cached_property
    def parameters(self) -> Array:
        """Parameters of bodies, shape (n, 10), that have the base parameters found.

        Of all of them those nearest to the bodies known before, or to none. They may be impossible;
        :attr:`consistent` says which are possible.
        """
        known = known_parameters(self.chain, np.zeros(10)).ravel()
        missing = self.base_values - self.base.combination @ known
        found = known + minimum_norm(self.base.combination, missing)
        return found.reshape(-1, 10)

    @cached_property
    def consistent(self) -> BoolArray:
        """Mask (n,) of the bodies of :attr:`parameters` that are possible."""
        return is_physically_consistent(self.parameters)


def identify(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    qdd: ArrayLike,
    tau: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    deviations: ArrayLike | None = None,
) -> Identification:
    """Find base parameters and friction by weighted least squares.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints; its rotors are taken as known, its bodies are not needed.
    q, qd, qdd : array_like, shape (m, n)
        Joint values, rates and accelerations (rad or m; per s, per s^2).
    tau : array_like, shape (m, n)
        Torques and forces of the drives, as measured: with their friction (N m or N).
    gravity : array_like, shape (3,), optional
        In the base (m/s^2).
    deviations : array_like, shape (n,), optional
        Standard deviations of the measured torques (N m or N), by which the joints are weighted.
        Default those that a first solution without weights leaves.

    Raises
    ------
    BadValueError, WrongSizeError
        Arguments that are no finite numbers of these shapes, too few states, or a motion that does
        not show all parameters.
    """
    q, qd, qdd, tau = finite_states(chain, q=q, qd=qd, qdd=qdd, tau=tau)
    base, A = _columns(chain, q, qd, qdd, gravity)
    b = tau - reflected_inertias(chain) * qdd
    if A.shape[0] * chain.n <= A.shape[2]:
        raise WrongSizeError("q", q.shape, f"more than {A.shape[2] // chain.n} states")
    _require_rank(A)
    weights = _first_deviations(A, b) if deviations is None else _deviations(chain, deviations)
    weighted = (A / weights[:, None]).reshape(-1, A.shape[2])
    right = (b / weights).ravel()
    values = _solved(weighted, right)
    variance = np.sum((right - weighted @ values) ** 2) / (len(right) - len(values))
    lengths = np.linalg.norm(weighted, axis=0)
    singular, turn = np.linalg.svd(weighted / lengths, full_matrices=False)[1:]
    roots = (turn.T / singular) / lengths[:, None]
    return Identification(
        chain=chain,
        base=base,
        values=values,
        covariance=variance * (roots @ roots.T),
        condition=float(singular[0] / singular[-1]),
        deviations=_left(A, b, values),
    )


def _first_deviations(A: Array, b: Array) -> Array:
    """Estimate the standard deviations (n,) of the torques from a solution without weights."""
    left = _left(A, b, _solved(A.reshape(-1, A.shape[2]), b.ravel()))
    # Torques without noise leave rounding only, which weighs nothing.
    return np.maximum(left, 1e-9 * np.abs(b).max(initial=1.0))


def excitation(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    qdd: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    deviations: ArrayLike | None = None,
) -> float:
    """Score a motion by how well it shows the parameters.

    Parameters
    ----------
    chain, q, qd, qdd, gravity, deviations
        As for :func:`identify`; default all joints alike.

    Returns
    -------
    float
        Condition number of the regressor of base parameters and friction, with columns of unit
        length: the less, the less noise is amplified; infinite where a parameter is not shown.
    """
    q, qd, qdd = finite_states(chain, q=q, qd=qd, qdd=qdd)
    _, A = _columns(chain, q, qd, qdd, gravity)
    weights = np.ones(chain.n) if deviations is None else _deviations(chain, deviations)
    singular = _singular_values((A / weights[:, None]).reshape(-1, A.shape[2]))
    if len(singular) < A.shape[2] or singular[-1] <= _RANK * singular[0]:
        return float("inf")
    return float(singular[0] / singular[-1])


def known_parameters(chain: SerialChain, otherwise: Array) -> Array:
    """Parameters of the bodies known before, shape (n, 10), or of others where there are none."""
    if any(body is None or body.fault() or body.mass == 0.0 for body in chain.bodies):
        return np.tile(otherwise, (len(chain.bodies), 1))
    known = body_parameters(chain)
    flat = ~is_physically_consistent(known)
    known[flat] = otherwise
    return known


def _columns(
    chain: SerialChain, q: Array, qd: Array, qdd: Array, gravity: ArrayLike
) -> tuple[BaseParameters, Array]:
    """Regressor of base parameters, viscous and Coulomb friction, shape (m, n, r + 2 n)."""
    if q.ndim != 2:
        raise WrongSizeError("q", q.shape, f"(m, {chain.n})")
    gravity = as_vector("gravity", gravity, 3)
    base = base_parameters(chain, gravity=gravity)
    Y = torque_regressor(chain, q, qd, qdd, gravity=gravity)[..., base.columns]
    viscous = qd[..., None] * np.eye(chain.n)
    coulomb = np.sign(qd)[..., None] * np.eye(chain.n)
    return base, np.concatenate((Y, viscous, coulomb), axis=-1)


def _deviations(chain: SerialChain, deviations: ArrayLike) -> Array:
    given = as_vector("deviations", deviations, chain.n)
    if not (given > _LEAST_DEVIATION).all():
        expected = f"{chain.n} positive numbers, above {_LEAST_DEVIATION:g}"
        raise BadValueError("deviations", given.tolist(), expected)
    return given


def _require_rank(A: Array) -> None:
    singular = _singular_values(A.reshape(-1, A.shape[2]))
    rank = int(np.sum(singular > _RANK * singular[0])) if singular[0] > 0.0 else 0
    if rank < A.shape[2]:
        raise BadValueError(
            "number of parameters that the motion shows", rank, f"a motion that shows {A.shape[2]}"
        )


def _singular_values(A: Array) -> Array:
    lengths = np.linalg.norm(A, axis=0)
    columns = A / np.where(lengths > 0.0, lengths, 1.0)
    return np.asarray(np.linalg.svd(columns, compute_uv=False), dtype=np.float64)


def _solved(A: Array, b: Array) -> Array:
    lengths = np.linalg.norm(A, axis=0)
    scaled, _ = least_squares(A / lengths, b)
    return np.asarray(scaled / lengths, dtype=np.float64)


def _left(A: Array, b: Array, values: Array) -> Array:
    """Return standard deviations of what is left of the torques of each joint, shape (n,)."""
    left = b - A @ values
    share = len(b) - A.shape[2] / A.shape[1]
    return np.asarray(np.sqrt((left**2).sum(axis=0) / share), dtype=np.float64)
