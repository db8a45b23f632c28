"""Ends of paths where modes meet, where the platform can move with locked legs, or at infinity."""

from dataclasses import dataclass, field

import numpy as np

from robomech_ros._kernels.parallel.newton import move, read_parameters, rows_at
from robomech_ros.parallel.study import still_finite
from robomech_ros.typing import Array, ComplexArray

# Ends of paths that meet are apart by the root of what was left of t, 1e-8, times a slope.
_MEETING = 0.02
# How far the mean of a cluster may be from its own conjugate to be real.
_REAL = 1e-3
# Singular values below this, of the largest, do not count.
_RANK = 1e-4
_STEPS = 30
_LEAST_SQUARES_STEPS, _LEAST_SQUARE = 40, 1e-24
# Poses apart from where modes meet by less than this (rad, and of the size) are one there.
_DOUBLE = 1e-6
_EXACT = 1e-13
_VERTEX_STEPS, _PROBE, _FLAT = 4, 1e-3, 1e-6
# How far along the free direction a pose is moved to see whether the legs let it: where they do
# not, they miss by the square of it.
_NUDGE, _STILL_CLOSED = 0.02, 1e-10


@dataclass(eq=False)
class SingularEnds:
    """Outcome of homotopy paths without a regular end.

    For each real pose (12,) in which modes meet, ``multiplicity`` says how many do, and
    ``movable`` whether the platform can move there with locked legs.  Of ``unexplained`` paths
    nothing is known.
    """

    poses: list[Array] = field(default_factory=list)
    multiplicity: list[int] = field(default_factory=list)
    movable: list[bool] = field(default_factory=list)
    unexplained: int = 0

    def add(self, pose: Array, count: int, movable: bool) -> None:
        """Note a pose in which so many modes meet."""
        self.poses.append(pose)
        self.multiplicity.append(count)
        self.movable.append(movable)


def _aligned(x: ComplexArray, y: ComplexArray) -> ComplexArray:
    """Return y times the number of unit length that brings it nearest to x."""
    inner = np.vdot(y, x)
    return y * (inner / abs(inner)) if abs(inner) > 0.0 else y


def _apart(x: ComplexArray, y: ComplexArray) -> float:
    return float(np.linalg.norm(x - _aligned(x, y)))


def _clusters(x: ComplexArray) -> list[list[int]]:
    left, found = list(range(len(x))), []
    while left:
        cluster = [left.pop(0)]
        for i in cluster:
            near = [j for j in left if _apart(x[i], x[j]) < _MEETING]
            cluster += near
            left = [j for j in left if j not in near]
        found.append(cluster)
    return found


def _residual(a: Array, b: Array, squares: Array, pose: Array) -> tuple[Array, Array]:
    J, now = np.empty((6, 6)), np.empty(6)
    rows_at(a, b, pose, J, now)
    return J, 0.25 * (squares - now)


def truncated_newton(
    a: Array,
    b: Array,
    squares: Array,
    pose: Array,
    frozen: Array | None = None,
    rank: float = _RANK,
) -> float:
    """Improve a pose (12,) in place in the directions that the legs hold; give its error.

    Anchors a and b (6, 3) are of order one.  Along a ``frozen`` direction (6,) the pose may not
    move; ``rank`` is the least singular value, of the largest, of a direction that the legs hold.
    """
    for _ in range(_STEPS):
        J, r = _residual(a, b, squares, pose)
        if frozen is not None:
            J = J - np.outer(J @ frozen, frozen)
        u, values, v = np.linalg.svd(J)
        kept = values > rank * values[0]
        step = v[kept].T @ ((u.T @ r)[kept] / values[kept])
        if not np.abs(step).max() < 1.0:
            break
        move(pose, np.ascontiguousarray(step))
        if np.abs(step).max() < 1e-14:
            break
    return float(np.abs(_residual(a, b, squares, pose)[1]).max())


def least_squares(a: Array, b: Array, lengths: Array, pose: Array) -> Array:
    """Move a pose (12,) in place to the least sum of squared length errors; give the errors."""
    squares, damping = lengths * lengths, 1e-3
    J, r = _residual(a, b, squares, pose)
    now = np.sqrt(np.maximum(squares - 4.0 * r, _LEAST_SQUARE))
    for _ in range(_LEAST_SQUARES_STEPS):
        slopes = 2.0 * J / now[:, None]
        normal = slopes.T @ slopes + damping * np.eye(6)
        other = pose.copy()
        move(other, np.linalg.solve(normal, slopes.T @ (lengths - now)))
        new_J, new_r = _residual(a, b, squares, other)
        new = np.sqrt(np.maximum(squares - 4.0 * new_r, _LEAST_SQUARE))
        if ((lengths - new) ** 2).sum() < ((lengths - now) ** 2).sum():
            pose[:], J, now, damping = other, new_J, new, 0.2 * damping
        else:
            damping *= 8.0
    return np.asarray(lengths - now)


def _vertex(a: Array, b: Array, squares: Array, pose: Array) -> tuple[float, Array]:
    """Move a pose (12,) in place to where two modes meet, or would if the lengths were right.

    Along the direction (6,) in which the legs give way the error is a parabola, and this its
    vertex.  Returns the square of how far each of the two modes is from here, negative where they
    are complex, and the direction.
    """
    square, free = 0.0, np.zeros(6)
    for _ in range(_VERTEX_STEPS):
        truncated_newton(a, b, squares, pose)
        J, r = _residual(a, b, squares, pose)
        u, _, v = np.linalg.svd(J)
        free, held = v[5], u[:, 5]
        errors = []
        for way in (_PROBE, -_PROBE):
            other = pose.copy()
            move(other, np.ascontiguousarray(way * free))
            errors.append(held @ _residual(a, b, squares, other)[1])
        bend = (errors[0] + errors[1] - 2.0 * held @ r) / _PROBE**2
        slope = (errors[0] - errors[1]) / (2.0 * _PROBE)
        if not abs(bend) > _FLAT:
            return 0.0, free
        square = float(-2.0 * (held @ r) / bend)
        step = float(np.clip(-slope / bend, -_MEETING, _MEETING))
        move(pose, np.ascontiguousarray(step * free))
    return square, free


def _two_modes(a: Array, b: Array, squares: Array, pose: Array, step: Array) -> list[Array]:
    """Return the modes on either side of the place where they nearly meet."""
    found = []
    for way in (1.0, -1.0):
        other = pose.copy()
        move(other, np.ascontiguousarray(way * step))
        if truncated_newton(a, b, squares, other, rank=0.0) <= _EXACT:
            found.append(other)
    return found


def _can_move(a: Array, b: Array, squares: Array, pose: Array) -> bool:
    """Return whether the platform can leave a pose with locked legs, either way."""
    free = np.linalg.svd(_residual(a, b, squares, pose)[0])[2][5]
    for way in (_NUDGE, -_NUDGE):
        other = pose.copy()
        move(other, np.ascontiguousarray(way * free))
        if truncated_newton(a, b, squares, other, free) > _STILL_CLOSED:
            return False
    return True


def _real_pose(x: ComplexArray) -> Array:
    norm = np.sqrt((x[:4] * x[:4]).sum())
    pose = np.empty(12)
    read_parameters(np.ascontiguousarray((x / norm).real), pose)
    return pose


def singular_ends(a: Array, b: Array, squares: Array, x: ComplexArray) -> SingularEnds:
    """Explain ends x (m, 8), of unit length, of paths that have come nearly to their ends."""
    found = SingularEnds()
    x = x[still_finite(x)]
    for cluster in _clusters(x):
        mean = np.mean([_aligned(x[cluster[0]], x[i]) for i in cluster], axis=0)
        mean /= np.linalg.norm(mean)
        if _apart(mean, mean.conj()) > _REAL:
            # Complex modes that meet, or points of a continuum, of which there may be real ones.
            pose = _real_pose(mean)
            closed = truncated_newton(a, b, squares, pose) <= _EXACT
            if closed and _can_move(a, b, squares, pose):
                found.add(pose, len(cluster), True)
            elif len(cluster) < 2:
                found.unexplained += 1
            continue
        _explain(found, a, b, squares, _real_pose(mean), len(cluster))
    return found


def _explain(
    found: SingularEnds, a: Array, b: Array, squares: Array, pose: Array, count: int
) -> None:
    """Note what becomes of as many paths as come to a real pose together."""
    if truncated_newton(a, b, squares, pose) <= _EXACT and _can_move(a, b, squares, pose):
        found.add(pose, count, True)
        return
    square, free = _vertex(a, b, squares, pose)
    if count < 2 or abs(square) > _MEETING**2:
        found.unexplained += count
    elif abs(square) <= _DOUBLE**2:
        found.add(pose, count, False)
    elif count > 2:
        found.unexplained += count
    elif square > 0.0:
        modes = _two_modes(a, b, squares, pose, float(np.sqrt(square)) * free)
        for mode in modes:
            found.add(mode, 1, False)
        found.unexplained += 2 - len(modes)
