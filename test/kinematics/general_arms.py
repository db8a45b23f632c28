"""Arms of six revolute joints without a closed form, and their singular postures."""

import numpy as np

from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import chain_from_dh, load_robot

HALF = np.pi / 2
ROBOTS = ("general6r", "diestro", "fanuc_arcmate")
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
}
TABLES = tuple(_TABLES)
NEAR = tuple(
    f"near-{kind}-{size:g}" for kind in ("wrist", "parallel") for size in (1e-3, 1e-4, 1e-5, 1e-6)
)


def general_arm(name):
    """A robot, a table above, ``random-<number>``, or ``near-wrist-1e-4`` and the like.

    The latter have wrist axes that pass each other, or parallel axes that are off, by so much.
    """
    if name in ROBOTS:
        return load_robot(name)
    if name in _TABLES:
        return chain_from_dh(*_TABLES[name])
    if name.startswith("random"):
        rng = np.random.default_rng(int(name.split("-")[1]))
        return chain_from_dh(
            rng.uniform(0.1, 1, 6), rng.uniform(-0.5, 0.5, 6), rng.uniform(-np.pi, np.pi, 6)
        )
    _, kind, size = name.split("-", 2)
    e = float(size)
    if kind == "wrist":
        return chain_from_dh(
            [0, 0.43, 0.02, e, 2 * e, 0],
            [0, 0.15, 0, 0.43, e, 0.05],
            [HALF, 0, -HALF, HALF, -HALF, 0],
        )
    return chain_from_dh(
        [0, -0.425, -0.39, 0, 0, 0],
        [0.09, 0, 0, 0.11, 0.095, 0.08],
        [HALF + e, e, -2 * e, HALF, -HALF, 0],
    )


def random_postures(count, seed):
    return np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, 6))


def right_angles(count, seed):
    return np.random.default_rng(seed).integers(-1, 3, (count, 6)) * HALF


def folds(chain, count, seed):
    """Postures where the determinant of the Jacobian changes its sign."""
    rng = np.random.default_rng(seed)
    found = []
    while len(found) < count:
        start, end = rng.uniform(-np.pi, np.pi, (2, 6))
        steps = start + np.linspace(0, 1, 30)[:, None] * (end - start)
        values = np.linalg.det(jacobian(chain, steps))
        changes = np.flatnonzero(values[1:] * values[:-1] < 0)
        if not len(changes):
            continue
        low, high = steps[changes[0]], steps[changes[0] + 1]
        for _ in range(60):
            middle = 0.5 * (low + high)
            if np.linalg.det(jacobian(chain, middle)) * values[changes[0]] > 0:
                low = middle
            else:
                high = middle
        found.append(low)
    return np.array(found)


def regularity(chain, q):
    """Ratio of the least to the largest singular value of the Jacobian."""
    values = np.linalg.svd(jacobian(chain, q), compute_uv=False)
    return values[..., -1] / values[..., 0]
