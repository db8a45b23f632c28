"""One pose in one call from Python: checked, solved and ranked.

A call costs as much as the solutions of an arm for every few arrays that are made for it, so that
all that Python does not need is made here, and :func:`clean_poses` is not called by itself.
"""

from numba import types

from robomech_ros._kernels._jit import (
    IOUT1,
    OUT1,
    OUT2,
    b1,
    borrowed,
    direct,
    f8,
    i8,
    kernel,
    linked,
    scratch,
    scratch_integers,
)
from robomech_ros._kernels.inverse import BRANCH, MARKS, MAX_SOLUTIONS, NAMES, solve
from robomech_ros._kernels.poses import clean_pose
from robomech_ros._kernels.tolerances import ROTATION_ERROR

__all__ = ["MOST_JOINTS", "solve_one", "solve_one_pose"]

# Of the families whose solutions are listed.
MOST_JOINTS = 6
_ROOM = MAX_SOLUTIONS * MOST_JOINTS
_ENTRIES = 6
_ANY2 = types.Array(f8, 2, "A")

_call_solve = linked(solve)


@kernel(types.UniTuple(i8, _ENTRIES)(OUT1, _ANY2, OUT1, i8, b1, OUT2, OUT2, OUT1, IOUT1))
def solve_one(arm, T, seed, metric, bounded, target, ranked, distances, names):
    """Solve the pose T (4, 4) of any memory layout, as it comes from a caller.

    It goes to ``target`` (4, 4), its rotation made orthogonal to rounding.  Where that fails, what
    is wrong with it, as :func:`clean_poses` tells, is the first number returned; else it is 0, and
    the others are those that ``solve`` returns, with the same arguments: the solutions inside the
    limits go to ``ranked`` (16, n), their distances and branches to ``distances`` (16,) and
    ``names`` (16,).  Where there are none, ``ranked`` and ``names`` get the bare ones instead.
    """
    n = seed.shape[0]
    T, target, ranked, names = borrowed(T), borrowed(target), borrowed(ranked), borrowed(names)
    for i in range(4):
        for j in range(4):
            target[i, j] = T[i, j]
    fault = clean_pose(target, scratch(3, 3), ROTATION_ERROR)
    if fault != 0:
        return fault, 0, 0, 0, 0, 0
    bare = scratch(_ROOM)[: MAX_SOLUTIONS * n].reshape((MAX_SOLUTIONS, n))
    marks, counts = scratch_integers(MARKS, MAX_SOLUTIONS), scratch_integers(1)
    found, missing, count, singular, unproven = _call_solve(
        borrowed(arm),
        target.reshape((1, 4, 4)),
        borrowed(seed),
        metric,
        bounded,
        bare,
        ranked.reshape((1, MAX_SOLUTIONS, n)),
        borrowed(distances),
        marks,
        counts,
    )
    for k in range(count):
        names[k] = marks[NAMES, k]
    if count == 0:
        for k in range(found):
            names[k] = marks[BRANCH, k]
            for i in range(n):
                ranked[k, i] = bare[k, i]
    return 0, found, missing, count, singular, unproven


# The same for callers that make all arguments but T themselves, and T to be a float64 array.
solve_one_pose = direct(solve_one)
