"""The search for forces inside their cones, or for a proof that there are none.

Nothing is taken from the solver unseen: close to the border of what is held it may end with forces
outside the cones and no proof.
"""

import math
from collections.abc import Iterator
from enum import Enum

import numpy as np

from robomech_ros.hands.force_program import force_program, separating_program
from robomech_ros.typing import Array, BoolArray

# What may be left of loads of size 1 after one correction, and how far forces may be outside their
# cones, of the greatest of them.
_BALANCED = 1e-9
_OUTSIDE = 1e-9
_MOST_ROUNDS = 8
_TINY = 1e-300
# Singular values below this share of the largest are none: what it takes them for are forces a
# thousand million times the load.
_RANK = 1e-10
# How far wrenches of unit normal forces may be along a direction that no wrench is to be along, at
# most and as a share of what the load needs along it: no forces a million times the load hold it.
_ALONG = 1e-12
_SHARE = 1e-6
# How far below 0 they are to be where a direction is searched for, if that can be.
_APART = 1e-9


class ForceStatus(Enum):
    """Outcome of the search for contact forces."""

    HELD = "held"
    NOT_HELD = "not held"
    NOT_CONVERGED = "not converged"


def search(
    rows: Array, cones: Array, needed: Array, smallest: str
) -> tuple[Array, ForceStatus, Array | None]:
    """Search for the smallest forces that exert a wrench (d,) of length 1.

    Rows (k, 15) are those of :func:`rows_of`, cones those of :func:`cones_of`. Returns normal
    forces and components that these bound (k, 4), NaN unless held; the status; and, where it is not
    held, a unit vector (d,) with which no wrench has a positive product, but that which is needed.
    """
    used = np.ones((len(rows), 4), np.bool_)
    used[:, 1:] = rows[:, 12:] > 0.0
    y = np.where(used, np.nan, 0.0)
    W = cones[used].T
    program = force_program(used, len(needed), smallest == "largest")
    U, s, Vt = np.linalg.svd(W, full_matrices=False)
    rank = int((s > _RANK * s[0]).sum())
    U, back = U[:, :rank], Vt[:rank].T / s[:rank]
    # A wrench that no forces exert at all, as a moment about the line through two contacts: the
    # solver finds no proof of that.
    rest = needed - U @ (U.T @ needed)
    if math.hypot(*rest) > _BALANCED:
        rest /= math.hypot(*rest)
        return y, ForceStatus.NOT_HELD, _unit(rest - U @ (U.T @ rest))
    if rank < len(W):
        W, needed = (U * s[:rank]) @ Vt[:rank], needed - rest
    proof = None
    if rank == W.shape[1]:
        # No internal forces: those that balance are the only ones.
        x = back @ (U.T @ needed)
        proof = _unit(U @ (back.T @ _worst(x, used)))
    else:
        solution = program.solve(W, rows[:, 12:], needed)
        x = np.array(solution.x[: W.shape[1]])
        if solution.status == program.library.SolverStatus.PrimalInfeasible:
            proof = -_unit(np.array(solution.z[: len(needed)]))
    if rank == W.shape[1] or proof is None:
        x, outside = _moved_inside(x, W, needed, back @ U.T, used)
        if outside <= _OUTSIDE and np.abs(W @ x - needed).max() < _BALANCED:
            y[used] = x
            return y, ForceStatus.HELD, None
    direction = _separating(cones, needed, _proofs(proof, cones, used, needed))
    status = ForceStatus.NOT_CONVERGED if direction is None else ForceStatus.NOT_HELD
    return y, status, direction


def _unit(vector: Array) -> Array:
    size = math.hypot(*vector)
    return vector / size if size > 0.0 else vector


def _of_contacts(x: Array, used: BoolArray) -> Array:
    """Return normal forces and bounded components, 0 where a contact has none, shape (k, 4)."""
    found = np.zeros(used.shape)
    found[used] = x
    return found


def _worst(x: Array, used: BoolArray) -> Array:
    """Return the normal of the face that the force farthest outside its cone is outside of."""
    found = _of_contacts(x, used)
    i = int(np.argmax(_bounded(found) - found[:, 0]))
    face = np.zeros(used.shape)
    face[i, 0], face[i, 1:] = -1.0, _unit(found[i, 1:])
    return face[used]


def _bounded(found: Array) -> Array:
    """Return how large a normal force has to be for what it bounds, shape (k,)."""
    return np.sqrt((found[:, 1:] * found[:, 1:]).sum(axis=1))


def _moved_inside(
    x: Array, W: Array, needed: Array, inverse: Array, used: BoolArray
) -> tuple[Array, float]:
    """Project forces on those that balance, and if need be on those inside the cones, in turn.

    Returns forces (m,) that balance, and how far they are outside the cones, as a share of the
    greatest of them if that is above 1.
    """
    for _ in range(_MOST_ROUNDS):
        balanced = x - inverse @ (W @ x - needed)
        found = _of_contacts(balanced, used)
        bounded = _bounded(found)
        outside = float((bounded - found[:, 0]).max() / max(1.0, np.abs(balanced).max()))
        if outside <= _OUTSIDE:
            break
        beyond = bounded > found[:, 0]
        normal = np.clip(0.5 * (found[:, 0] + bounded), 0.0, None)[beyond]
        found[beyond, 1:] *= (normal / np.maximum(bounded[beyond], _TINY))[:, None]
        found[beyond, 0] = normal
        x = found[used]
    return balanced, outside


def _proofs(proof: Array | None, cones: Array, used: BoolArray, needed: Array) -> Iterator[Array]:
    """Yield directions that may separate, the cheapest first."""
    if proof is not None:
        yield proof
    for apart in (_APART, 0.0):
        found = separating_program(cones, used, needed, apart)
        if found is not None:
            yield _unit(found)


def _separating(cones: Array, needed: Array, proofs: Iterator[Array]) -> Array | None:
    """Return the first direction that no wrench is along but the one needed, or the best of all."""
    best, least = None, _SHARE
    for one in proofs:
        need = float(one @ needed)
        across = np.sqrt(((cones[:, 1:] @ one) ** 2).sum(axis=1))
        along = float((cones[:, 0] @ one + across).max())
        if need > 0.0 and along < least * need:
            if along <= _ALONG * need:
                return one
            best, least = one, along / need
    return best
