"""Kernel that checks and solves one pose and ranks its solutions in one call from Python.

Python takes as long to allocate a few arrays as a kernel to solve an arm, so one array serves all
results, and the pose is checked in the same call.
"""

from numba import types

from robomech_ros._kernels.compiling.jit import (
    borrowed,
    direct,
    kernel,
    linked,
    scratch,
    scratch_integers,
)
from robomech_ros._kernels.compiling.types import OUT1, OUT2, b1, f8, i8
from robomech_ros._kernels.inverse.poses import clean_pose
from robomech_ros._kernels.inverse.solutions import BRANCH, MARKS, MAX_SOLUTIONS, NAMES, solve
from robomech_ros._kernels.tolerances import ROTATION_ERROR

# Offsets of further results behind the rows of solutions.
TARGET = 0  # the pose, row by row
DISTANCES = 16  # distance of each solution from the seed
BRANCHES = DISTANCES + MAX_SOLUTIONS  # branch of each solution
TOTAL = BRANCHES + MAX_SOLUTIONS

# Largest number of joints of the arms solved here.
_MAX_JOINTS = 6
_ROOM = MAX_SOLUTIONS * _MAX_JOINTS
_ENTRIES = 6
_ANY2 = types.Array(f8, 2, "A")

_call_solve = linked(solve)


@kernel(types.UniTuple(i8, _ENTRIES)(OUT1, _ANY2, OUT1, i8, b1, OUT2))
def solve_one(arm, T, seed, metric, bounded, space):
    """Solve the pose T (4, 4) of any memory layout.

    The other arguments are those of ``solve``.  Returns the fault of T as in :func:`clean_poses`,
    or 0, and then the results of ``solve``.

    ``space`` has n numbers a row.  Its first 16 rows receive the solutions inside the limits,
    nearest to the seed first; if there are none, the bare solutions.  TOTAL numbers follow: T with
    its rotation made orthogonal to rounding, the distances and the branches.
    """
    n = seed.shape[0]
    T, space = borrowed(T), borrowed(space)
    flat = space.reshape(space.size)
    rest = flat[MAX_SOLUTIONS * n :]
    target = rest[TARGET:DISTANCES].reshape((1, 4, 4))
    for i in range(4):
        for j in range(4):
            target[0, i, j] = T[i, j]
    fault = clean_pose(target[0], scratch(3, 3), ROTATION_ERROR)
    if fault != 0:
        return fault, 0, 0, 0, 0, 0
    bare = scratch(_ROOM)[: MAX_SOLUTIONS * n].reshape((MAX_SOLUTIONS, n))
    marks, counts = scratch_integers(MARKS, MAX_SOLUTIONS), scratch_integers(1)
    found, missing, count, singular, unproven = _call_solve(
        borrowed(arm),
        target,
        borrowed(seed),
        metric,
        bounded,
        bare,
        flat[: MAX_SOLUTIONS * n].reshape((1, MAX_SOLUTIONS, n)),
        rest[DISTANCES:BRANCHES],
        marks,
        counts,
    )
    names = marks[NAMES] if count > 0 else marks[BRANCH]
    for k in range(count if count > 0 else found):
        rest[BRANCHES + k] = names[k]
        if count == 0:
            for i in range(n):
                space[k, i] = bare[k, i]
    return 0, found, missing, count, singular, unproven


# The same without checks of the arguments; T must be a float64 array.
solve_one_pose = direct(solve_one)
