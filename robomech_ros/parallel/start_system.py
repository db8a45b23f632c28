"""Poses of a platform for complex leg lengths, from which those for real ones are reached."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.parallel.length_homotopy import track_lengths
from robomech_ros._kernels.parallel.projective import REGULAR, track
from robomech_ros.parallel.generic_platform import LEGS, POSES
from robomech_ros.parallel.study import quadrics_of_platform, still_finite
from robomech_ros.typing import ComplexArray

# Two ends nearer than this (of unit length) are one: paths have been confused.
_ONE = 1e-7
# A path that has come so far without an end has a singular one, or leaves for infinity.
_NEARLY_THERE = 0.99
# How far complex squared lengths are from typical ones, of their mean, and how often they are
# drawn before two draws must have agreed on the number of poses.
_AWAY, _DRAWS = 0.5, 4
# Of several draws that are nearer to typical lengths, the one is kept from which paths to a few
# real lengths take the fewest steps: 20 to 40 % fewer than from the first draw.
_NEARER, _CANDIDATES, _TRIALS = 0.35, 16, 8
_SMALLEST, _LARGEST = 0.4, 1.8


@dataclass(frozen=True, eq=False)
class StartSystem:
    """All poses of a platform for generic complex lengths.

    The squares (6,) are squared lengths, and the poses (n, 8) Study parameters of unit length.
    The doubt says why poses may be missing; it is empty where two draws agree on their number.
    """

    squares: ComplexArray
    poses: ComplexArray
    doubt: str


@lru_cache(maxsize=1)
def _generic() -> tuple[ComplexArray, ComplexArray]:
    """Return quadrics and the forty poses of the generic platform, exact."""
    quadrics = quadrics_of_platform(LEGS[:, :3], LEGS[:, 3:6], LEGS[:, 6])
    poses, ends, times = POSES.copy(), np.zeros(40, np.int64), np.zeros(40)
    track(quadrics, quadrics, poses, ends, times)
    return quadrics, poses


def unlike(poses: ComplexArray) -> bool:
    """Return whether points (n, 8) of unit length are all different as points of P^7."""
    inner = poses @ poses.conj().T
    apart = poses[:, None, :] - inner[:, :, None] * poses[None, :, :]
    distances = np.linalg.norm(apart, axis=2) + np.eye(len(poses))
    return bool(len(poses) == 0 or distances.min() > _ONE)


def start_system(a: NDArray, b: NDArray, typical: NDArray) -> StartSystem:
    """Find all poses for complex squared lengths drawn near typical ones (6,).

    Base and platform points (6, 3) are about their centres, and of order one.
    """
    generic, poses = _generic()
    rng = np.random.default_rng(1965)
    found: dict[int, StartSystem] = {}
    doubt = ""
    for _ in range(_DRAWS):
        noise = rng.normal(size=(2, 6))
        squares = typical + _AWAY * typical.mean() * (noise[0] + 1j * noise[1])
        x, ends, times = poses.copy(), np.zeros(40, np.int64), np.zeros(40)
        track(generic, quadrics_of_platform(a, b, squares), x, ends, times)
        regular = ends == REGULAR
        gone = ~regular & (times > _NEARLY_THERE) & ~still_finite(x)
        count = int(regular.sum())
        if not (regular | gone).all() or not unlike(x[regular]):
            doubt = "paths to the poses of this geometry end without a verdict"
        elif count in found:
            return _shortest_paths(a, b, found[count], typical, rng)
        else:
            found[count] = StartSystem(squares, np.ascontiguousarray(x[regular]), "")
    if not found:
        return StartSystem(squares, np.ascontiguousarray(x[regular]), doubt)
    best = found[max(found)]
    doubt = f"two draws of lengths do not agree on the number of poses ({sorted(found)})"
    return StartSystem(best.squares, best.poses, doubt)


def _shortest_paths(
    a: NDArray, b: NDArray, start: StartSystem, typical: NDArray, rng: np.random.Generator
) -> StartSystem:
    """Return a start system from which paths to real lengths near typical ones are short."""
    trials = (typical * rng.uniform(_SMALLEST, _LARGEST, (_TRIALS, 6))).astype(np.complex128)
    n = len(start.poses)
    ends, times = np.empty(n, np.int64), np.empty(n)

    def followed(origin: StartSystem, squares: ComplexArray) -> tuple[ComplexArray, int]:
        x = origin.poses.copy()
        steps = track_lengths(a, b, origin.squares, squares, x, ends, times)
        return x, steps

    best, fewest = start, np.inf
    for _ in range(_CANDIDATES):
        noise = rng.normal(size=(2, 6))
        squares = typical + _NEARER * typical.mean() * (noise[0] + 1j * noise[1])
        poses, _ = followed(start, squares)
        if (ends != REGULAR).any() or not unlike(poses):
            continue
        candidate = StartSystem(squares, poses, "")
        steps = sum(followed(candidate, trial)[1] for trial in trials)
        if steps < fewest:
            best, fewest = candidate, steps
    return best
