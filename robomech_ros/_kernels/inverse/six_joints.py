"""One kernel for all solvers of six-joint arms, from the base or from the tip."""

from robomech_ros._kernels.compiling.jit import inline, kernel, linked, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, IOUT1, OUT2, b1, i8
from robomech_ros._kernels.inverse.branch_bits import DOUBT as DOUBT
from robomech_ros._kernels.inverse.decoupled.solutions import solve_decoupled
from robomech_ros._kernels.inverse.general.solutions import call_general
from robomech_ros._kernels.inverse.iterative.solutions import solve_iterative
from robomech_ros._kernels.inverse.parallel.solutions import solve_parallel

DECOUPLED = 0
THREE_PARALLEL = 1
ITERATIVE = 2
# Families 3 and 4 have more and fewer joints.
GENERAL = 5
# Added to the index of a family whose constants are those of the inverse motion.
BACKWARDS = 16

MAX_SOLUTIONS = 16


@inline
def _postures(family, data, T, seed, q, branch):
    """Solve an arm by the solver of its family; return the number of solutions."""
    if family == DECOUPLED:
        return solve_decoupled(data, T, seed, q, branch)
    if family == THREE_PARALLEL:
        return solve_parallel(data, T, seed, q, branch)
    if family == GENERAL:
        return call_general(data, T, seed, q, branch)
    return solve_iterative(data, T, seed, q, branch)


@kernel(i8(i8, b1, IN1, IN2, IN1, OUT2, IOUT1))
def six_joint_postures(family, backwards, data, T, seed, q, branch):
    """Write the bare solutions for the pose T (4, 4) to q (16, n), branches to ``branch`` (16,).

    With ``backwards`` the constants are those of the inverse motion of a six-joint arm, with the
    joints in opposite order and sense; T, ``seed`` and q are those of the arm itself.  One kernel
    serves all families, since a kernel is compiled together with all that it calls.  Returns the
    number of solutions, plus DOUBT if the list may be incomplete.
    """
    if not backwards:
        return _postures(family, data, T, seed, q, branch)
    back, start = scratch(4, 4), scratch(6)
    for i in range(3):
        for j in range(3):
            back[i, j] = T[j, i]
        back[i, 3] = -(T[0, i] * T[0, 3] + T[1, i] * T[1, 3] + T[2, i] * T[2, 3])
        back[3, i] = 0.0
    back[3, 3] = 1.0
    for i in range(6):
        start[i] = -seed[5 - i]
    count = _postures(family, data, back, start, q, branch)
    for k in range(count % DOUBT):
        for i in range(3):
            q[k, i], q[k, 5 - i] = -q[k, 5 - i], -q[k, i]
    return count


call_six_joints = linked(six_joint_postures)
