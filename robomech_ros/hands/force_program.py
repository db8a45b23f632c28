"""The conic program of the smallest contact forces.

Its unknowns are, contact by contact, the normal force and those of three components that the
contact has (friction along two tangents, torsion), each divided by how far it may go for a unit of
normal force.  Where grasps have the same components, only numbers of their programs differ: what
they share is kept.
"""

from dataclasses import dataclass
from functools import cache, lru_cache
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from robomech_ros.hands.conic_solver import conic_solver
from robomech_ros.typing import Array, BoolArray

# Tolerances for loads of size 1.
_PRECISION = 1e-9
# Cones are narrower by this part for the solver, so that what it leaves open lies within them.
_NARROWER = 2e-8
_MOST_KEPT = 128


@dataclass(frozen=True, eq=False)
class ForceProgram:
    """Shared parts of conic programs of grasps: min q x, A x + s = b, s in cones.

    Of A there are the row of each entry, column by column, where each column begins, and those
    entries that are the same for all; others are 0. ``balance`` and ``friction`` are the places in
    these of the wrenches and of the negative coefficients of friction, ``sliding`` those of the
    coefficients in the flat (k, 3) ``reach`` of :meth:`solve`. The objective is q, ``no_squares``
    its quadratic part, which is empty. The cones are kept as the solver takes them, and the size is
    that of b.
    """

    library: ModuleType
    rows: NDArray[np.int32]
    starts: NDArray[np.int32]
    entries: Array
    balance: NDArray[np.intp]
    friction: NDArray[np.intp]
    sliding: NDArray[np.intp]
    objective: Array
    no_squares: csc_matrix
    kinds: list[Any]
    size: int

    def solve(self, W: Array, reach: Array, needed: Array) -> Any:
        """Solve for m unknowns whose wrenches W (d, m) exert a wrench (d,).

        `reach` (k, 3) is how far the components of each contact go for a unit of normal force.
        """
        entries = self.entries.copy()
        entries[self.balance] = W.T.ravel()
        entries[self.friction] = -reach.ravel()[self.sliding]
        b = np.zeros(self.size)
        b[: len(needed)] = needed
        A = csc_matrix((entries, self.rows, self.starts), shape=(self.size, len(self.objective)))
        solver = self.library.DefaultSolver(
            self.no_squares, self.objective, A, b, self.kinds, solver_settings(self.library)
        )
        return solver.solve()


def force_program(used: BoolArray, d: int, largest: bool) -> ForceProgram:
    """Return the program of contacts with given components, for wrenches of size d.

    `used` (k, 4) tells which of normal force, friction along both tangents and torsion each contact
    has.  The greatest force of a contact is minimized if `largest`, by one more unknown that bounds
    the force of each; otherwise the sum of the normal forces.
    """
    return _kept(conic_solver(), used.tobytes(), d, largest)


@lru_cache(maxsize=_MOST_KEPT)
def _kept(library: ModuleType, flags: bytes, d: int, largest: bool) -> ForceProgram:
    used = np.frombuffer(flags, np.bool_).reshape(-1, 4)
    m = int(used.sum())
    shared = np.zeros((d + m + largest * int((1 + used[:, :3].sum(axis=1)).sum()), m + largest))
    friction = np.zeros(shared.shape, np.bool_)
    objective = np.zeros(m + largest)
    kinds, row, column = [library.ZeroConeT(d)], d, 0
    for own in used.tolist():
        count, tangents = sum(own), sum(own[1:3])
        here = np.arange(count)
        shared[row + here, column + here] = -1.0
        shared[row, column] = _NARROWER - 1.0
        kinds.append(library.SecondOrderConeT(count))
        row += count
        if largest:
            shared[row, m] = shared[row + 1, column] = -1.0
            here = 1 + np.arange(tangents)
            friction[row + 1 + here, column + here] = True
            kinds.append(library.SecondOrderConeT(2 + tangents))
            row += 2 + tangents
        else:
            objective[column] = 1.0
        column += count
    if largest:
        objective[m] = 1.0
    present = (shared != 0.0) | friction
    present[:d, :m] = True
    _, rows = np.nonzero(present.T)
    return ForceProgram(
        library=library,
        rows=rows.astype(np.int32),
        starts=np.concatenate([[0], np.cumsum(present.sum(axis=0))]).astype(np.int32),
        entries=shared.T[present.T],
        balance=np.flatnonzero(rows < d),
        friction=np.flatnonzero(friction.T[present.T]),
        sliding=np.flatnonzero(used[:, 1:] & [largest, largest, False]),
        objective=objective,
        no_squares=csc_matrix((len(objective), len(objective))),
        kinds=kinds,
        size=len(shared),
    )


def separating_program(cones: Array, used: BoolArray, needed: Array, apart: float) -> Array | None:
    """Find the direction (d,) that is farthest along a wrench, of those that no contact is along.

    Products of it with wrenches of unit normal forces are `apart` below 0.  Its length is 1 at
    most; None where the solver finds none.
    """
    library = conic_solver()
    d = len(needed)
    blocks, kinds, b = [], [], []
    for cone, own in zip(cones, used, strict=True):
        blocks.append(np.vstack([cone[:1], -cone[1:][own[1:]]]))
        b += [-apart, *np.zeros(len(blocks[-1]) - 1)]
        kinds.append(library.SecondOrderConeT(len(blocks[-1])))
    blocks.append(np.vstack([np.zeros((1, d)), -np.eye(d)]))
    b += [1.0, *np.zeros(d)]
    kinds.append(library.SecondOrderConeT(d + 1))
    settings = solver_settings(library)
    A = csc_matrix(np.vstack(blocks))
    solver = library.DefaultSolver(csc_matrix((d, d)), -needed, A, np.array(b), kinds, settings)
    found = solver.solve()
    ended = library.SolverStatus
    return np.array(found.x) if found.status in (ended.Solved, ended.AlmostSolved) else None


@cache
def solver_settings(library: ModuleType) -> Any:
    """Return the settings of the solver for loads of size 1."""
    settings = library.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = _PRECISION
    return settings
