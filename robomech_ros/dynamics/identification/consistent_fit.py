"""Possible bodies, as near as possible to what motions have shown."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from robomech_ros.dynamics.identification.consistent_parameters import consistent_least_squares
from robomech_ros.dynamics.identification.fit import Identification, known_parameters
from robomech_ros.dynamics.pseudo_inertias import bodies_from_parameters
from robomech_ros.errors import BadValueError
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.drives import Drive
from robomech_ros.typing import Array

# How much a consistent body is drawn to the one known before, where 1 is a standard error or so.
_PULL = 1e-6
# Least standard error of a base parameter that is counted on, of the largest base parameter.
_LEAST_ERROR = 1e-6
# A body to start from where nothing is known: 1 kg, a ball of 0.1 m about the joint.
_START = np.array([1.0, 0.0, 0.0, 0.0, 4e-3, 0.0, 0.0, 4e-3, 0.0, 4e-3])


@dataclass(frozen=True, eq=False)
class ConsistentFit:
    """Physically possible bodies, chosen by the motions.

    Parameters
    ----------
    parameters : ndarray, shape (n, 10)
        Parameters of the bodies.
    chain : SerialChain
        With these bodies, and the friction found, none of it negative.
    deviation : float
        Of the base parameters from those found, in their standard errors: about 1 where the data
        allow these bodies.
    converged : bool
        The deviation is the least that bodies can have, except for a part of 1e-4 or of an error;
        otherwise they are consistent, but not the best.
    """

    parameters: Array
    chain: SerialChain
    deviation: float
    converged: bool


def consistent_fit(found: Identification) -> ConsistentFit:
    """Choose possible bodies, as near as possible to the identified parameters.

    The base parameters, weighted by their covariance, are brought as near to those found as bodies
    with positive definite pseudo-inertias can: a convex program, whose minimum is the only one.
    Where the data leave a choice, the bodies stay near those known before.

    References
    ----------
    Lee, Wensing, Park, "Geometric robot dynamic identification: a convex programming approach",
    IEEE Trans. Robotics 36(2), 2020.
    """
    if not isinstance(found, Identification):
        raise BadValueError("found", found, "an Identification, as returned by identify")
    chain, base = found.chain, found.base
    # Torques without noise leave nothing but rounding, which no solution has to meet.
    least = _LEAST_ERROR * np.abs(found.base_values).max()
    covariance = found.covariance[: base.rank, : base.rank] + least**2 * np.eye(base.rank)
    scale = np.sqrt(np.diag(covariance))
    inner = np.linalg.cholesky(covariance / np.outer(scale, scale))
    C: Array = np.linalg.solve(inner, base.combination / scale[:, None]).astype(np.float64)
    target: Array = np.linalg.solve(inner, found.base_values / scale).astype(np.float64)
    outcome = consistent_least_squares(C, target, known_parameters(chain, _START), _PULL)
    parameters = outcome.parameters
    left = C @ parameters.ravel() - target
    drives = tuple(
        Drive(
            viscous=max(float(viscous), 0.0),
            coulomb=max(float(coulomb), 0.0),
            rotor_inertia=drive.rotor_inertia,
            gear_ratio=drive.gear_ratio,
        )
        for drive, viscous, coulomb in zip(chain.drives, found.viscous, found.coulomb, strict=True)
    )
    bodies = bodies_from_parameters(parameters)
    return ConsistentFit(
        parameters=parameters,
        chain=replace(chain, bodies=bodies, drives=drives),
        deviation=float(np.sqrt(np.mean(left**2))),
        converged=outcome.converged,
    )
