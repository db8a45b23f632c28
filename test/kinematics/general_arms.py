"""Arms of six revolute joints without a closed form, and their singular postures."""

import numpy as np
from zero_sets import on_segments

from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import chain_from_dh, load_robot

HALF = np.pi / 2
ROBOTS = ("general6r", "diestro", "fanuc_arcmate", "crx10ia", "jaco2", "xarm6")
# Denavit-Hartenberg tables (m) of the geometry of built arms: axes 2 and 3 parallel, wrists whose
# axes do not meet in one point.
_TABLES = {
    "offset-wrist-cobot": (
        [0, 0.54, 0, 0, 0, 0],
        [0.245, 0, 0, -0.54, 0.15, -0.16],
        [-HALF, np.pi, -HALF, HALF, -HALF, np.pi],
    ),
    "slanted-wrist": (
        [0, 0.41, 0, 0, 0, 0],
        [0.2755, 0, -0.0098, -0.2501, -0.0856, -0.2036],
        [HALF, np.pi, HALF, np.pi / 3, np.pi / 3, np.pi],
    ),
    "right-angle-cobot": (
        [0, 0.28949, 0.0775, 0, 0.076, 0],
        [0.267, 0, 0, 0.3425, 0, 0.097],
        [-HALF, 0, -HALF, HALF, -HALF, 0],
    ),
    "manocha-code": (
        [0.1348, 1.9773, 0.0786, 0.9887, 0.4382, 1.0448],
        [0, 0.9999, 0.2809, -0.4831, 0.5617, -1.5054],
        np.deg2rad([-57, 35, 95, 79, -75, -90]),
    ),
    # Raghavan and Roth, 1990.
    "raghavan-roth": (
        [0.8, 1.2, 0.33, 1.8, 0.6, 2.2],
        [0.9, 3.7, 1.0, 0.5, 2.1, 0.63],
        np.deg2rad([20, 31, 45, 81, 12, 100]),
    ),
}
TABLES = tuple(_TABLES)
# Right angles throughout, lengths that are multiples of each other: the signs of the angles, then
# a and b in quarters of a metre.
_SQUARES = {
    "square-0": ((-1, 1, -1, 1, 1, -1), (2, 1, 1, 0, 1, 0), (1, -1, 0, 2, 0, 1)),
    "square-1": ((1, 1, -1, 1, -1, 1), (1, 2, 0, 1, 1, 0), (0, 1, 2, 0, -1, 1)),
    "square-2": ((-1, -1, 1, -1, 1, 1), (0, 2, 1, 1, 0, 1), (2, 0, 1, -1, 1, 0)),
    "square-3": ((1, -1, -1, 1, 1, -1), (1, 1, 2, 0, 2, 0), (1, 0, 0, 1, 1, 2)),
    "square-4": ((1, 1, 1, -1, -1, 1), (0, 1, 1, 2, 1, 0), (1, 1, 0, 0, 1, 1)),
}
SQUARES = tuple(_SQUARES)
NEAR_SIZES = (1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
NEAR_KINDS = ("wrist", "wrist-puma", "parallel", "parallel-pair", "meeting", "shoulder")
NEAR = tuple(f"near-{kind}-{size:.0e}" for kind in NEAR_KINDS for size in NEAR_SIZES)


def general_arm(name):
    """A robot, a table above, ``random-<number>``, or ``near-wrist-1e-4`` and the like.

    The latter have axes that nearly meet or are nearly parallel, off by so much (m or rad).
    """
    if name in ROBOTS:
        return load_robot(name)
    if name in _TABLES:
        return chain_from_dh(*_TABLES[name])
    if name in _SQUARES:
        signs, a, b = _SQUARES[name]
        return chain_from_dh(0.25 * np.array(a), 0.25 * np.array(b), HALF * np.array(signs))
    if name.startswith("random"):
        rng = np.random.default_rng(int(name.split("-")[1]))
        return chain_from_dh(
            rng.uniform(0.1, 1, 6), rng.uniform(-0.5, 0.5, 6), rng.uniform(-np.pi, np.pi, 6)
        )
    kind, _, size = name.removeprefix("near-").partition("-1e")
    return chain_from_dh(*_nearly_special(kind, float(f"1e{size}")))


def _nearly_special(kind, e):
    """Denavit-Hartenberg table of an arm that is special but for e (rad or m)."""
    if kind == "wrist":
        return (
            [0, 0.43, 0.02, e, 2 * e, 0],
            [0, 0.15, 0, 0.43, e, 0.05],
            [HALF, 0, -HALF, HALF, -HALF, 0],
        )
    if kind == "wrist-puma":
        return (
            [0, 0.4318, 0.0203, e, 0, 0],
            [0, 0.15, 0, 0.4318, 0, 0],
            [HALF, 0, -HALF, HALF, -HALF, 0],
        )
    if kind == "parallel":
        return (
            [0, -0.425, -0.39, 0, 0, 0],
            [0.09, 0, 0, 0.11, 0.095, 0.08],
            [HALF + e, e, -2 * e, HALF, -HALF, 0],
        )
    if kind == "parallel-pair":
        return (
            [0, 0.54, 0, 0, 0, 0],
            [0.245, 0, 0, -0.54, 0.15, -0.16],
            [-HALF, np.pi + e, -HALF + e, HALF, -HALF + e, np.pi],
        )
    if kind == "meeting":
        return [e, 0.5, e, 0.2, e, 0], [0.3, 0.1, 0.2, 0.4, 0.15, 0.1], [1.2, 0.9, -1.1, 1.3, -1, 0]
    return (
        [e, 0.4318, 0.0203, 0, 0, 0],
        [0, 0.15, 0, 0.4318, 0, 0],
        [HALF, e, -HALF, HALF, -HALF, 0],
    )


def random_postures(count, seed):
    return np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, 6))


def right_angles(count, seed):
    return np.random.default_rng(seed).integers(-1, 3, (count, 6)) * HALF


def folds(chain, count, seed):
    """Postures where the determinant of the Jacobian changes its sign."""
    rng = np.random.default_rng(seed)
    return on_segments(lambda q: np.linalg.det(jacobian(chain, q)), chain, count, rng)


def regularity(chain, q):
    """Ratio of the least to the largest singular value of the Jacobian."""
    values = np.linalg.svd(jacobian(chain, q), compute_uv=False)
    return values[..., -1] / values[..., 0]
