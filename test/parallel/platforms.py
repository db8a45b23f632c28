"""Platforms on six legs, random poses, and a search for all poses that shares no code with ours."""

import numpy as np
from scipy.spatial.transform import Rotation

from robomech_ros.parallel import StewartGough

__all__ = [
    "KINDS",
    "independent_poses",
    "on_circles",
    "platform",
    "random_pose",
    "same_poses",
    "traced",
]


def on_circles(base, top, ratio=0.6):
    """A hexapod whose anchors are on two circles, at azimuths in degrees."""

    def ring(radius, degrees):
        angles = np.radians(degrees)
        return radius * np.stack((np.cos(angles), np.sin(angles), 0.0 * angles), axis=1)

    return ring(1.0, base), ring(ratio, top)


def platform(kind, seed=0):
    """A platform of one kind."""
    rng = np.random.default_rng(seed)
    flat = np.array([1.0, 1.0, 0.0])
    a, b = rng.normal(size=(2, 6, 3))
    points = {
        "general": (a, b),
        "planar platform": (a, b * flat),
        "planar": (a * flat, b * flat),
        "similar": (a, 0.6 * a),
        "hexapod": on_circles([-10, 10, 110, 130, 230, 250], [-40, 40, 80, 160, 200, 280]),
        "6-3": on_circles([-10, 10, 110, 130, 230, 250], [0, 0, 120, 120, 240, 240]),
        "3-3": on_circles([0, 0, 120, 120, 240, 240], [-60, 60, 60, 180, 180, 300]),
    }
    return StewartGough(*points[kind])


# How many poses there are for complex lengths.
KINDS = {
    "general": 40,
    "planar platform": 40,
    "planar": 40,
    "similar": 24,
    "hexapod": 28,
    "6-3": 16,
    "3-3": 16,
}


def random_pose(robot, rng, spread=0.7):
    """Any rotation, and the middle of the platform not far from that of the base."""
    T = np.eye(4)
    T[:3, :3] = Rotation.random(random_state=rng).as_matrix()
    middle = robot.base_points.mean(axis=0) - T[:3, :3] @ robot.platform_points.mean(axis=0)
    T[:3, 3] = middle + spread * rng.normal(size=3)
    return T


def independent_poses(robot, lengths, starts=3000, steps=60, seed=1):
    """All poses that Newton's method finds from random starts, in plain NumPy."""
    rng = np.random.default_rng(seed)
    a, b = robot.base_points, robot.platform_points
    R = Rotation.random(starts, random_state=rng).as_matrix()
    p = rng.normal(size=(starts, 3))
    for _ in range(steps):
        turned = np.einsum("nij,kj->nki", R, b)
        d = p[:, None] + turned - a
        rows = np.concatenate((np.cross(turned, d), d), axis=2)
        error = 0.5 * ((d * d).sum(axis=2) - lengths**2)
        rows += 1e-14 * np.eye(6)
        step = -np.linalg.solve(rows, error[:, :, None])[:, :, 0]
        size = np.abs(step).max(axis=1, keepdims=True)
        step *= np.minimum(1.0, 0.5 / np.maximum(size, 1e-300))
        R = Rotation.from_rotvec(step[:, :3]).as_matrix() @ R
        p += step[:, 3:]
    d = p[:, None] + np.einsum("nij,kj->nki", R, b) - a
    good = np.abs(np.linalg.norm(d, axis=2) - lengths).max(axis=1) < 1e-11
    found = []
    for turn, place in zip(R[good], p[good], strict=True):
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = turn, place
        if all(np.abs(T - other).max() > 1e-6 for other in found):
            found.append(T)
    return np.array(found).reshape(-1, 4, 4)


def same_poses(ours, theirs, tolerance):
    """Whether two sets of poses are the same, each within a tolerance of one other."""
    if len(ours) != len(theirs):
        return False
    apart = np.abs(np.asarray(ours)[:, None] - np.asarray(theirs)[None]).max(axis=(2, 3))
    nearest = apart.argmin(axis=1)
    return len(set(nearest)) == len(ours) and float(apart.min(axis=1).max()) <= tolerance


def traced(robot, T, lengths):
    """Trace the curve of poses while the squared lengths move along a line, by its arc length.

    The curve is smooth also in singular poses, in which it turns back.  Steps are so short that its
    tangent turns by less than 0.1 rad in each, and that none reaches another curve nearby.

    Returns
    -------
    part : float
        1.0 at the end of the line, less in the singular pose on the way to it.
    pose : ndarray, shape (4, 4)
        There.
    """
    a, b = robot.base_points, robot.platform_points
    first = robot.inverse(T) ** 2
    rise = lengths**2 - first

    def system(pose, part):
        turned = b @ pose[:3, :3].T
        legs = pose[:3, 3] + turned - a
        error = 0.5 * ((legs * legs).sum(axis=1) - first - part * rise)
        return np.column_stack((np.cross(turned, legs), legs, -0.5 * rise)), error

    def moved(pose, part, step):
        new = pose.copy()
        new[:3, :3] = Rotation.from_rotvec(step[:3]).as_matrix() @ pose[:3, :3]
        new[:3, 3] += step[3:6]
        return new, part + step[6]

    def corrected(pose, part, tangent):
        """Bring a pose back onto the curve, and return the tangent there."""
        for _ in range(8):
            A, error = system(pose, part)
            step = np.linalg.lstsq(A, -error, rcond=None)[0]
            pose, part = moved(pose, part, step)
            if np.abs(step).max() < 1e-12:
                _, values, right = np.linalg.svd(system(pose, part)[0])
                return pose, part, right[6] * np.sign(right[6] @ tangent), 0.1 * values[5]
        return None

    pose, part, tangent, longest = corrected(T, 0.0, np.eye(7)[6])
    step = 1e-3
    for _ in range(200_000):
        step = min(step, longest)
        found = corrected(*moved(pose, part, step * tangent), tangent)
        if found is None or found[2] @ tangent < 0.995:
            step *= 0.5
            continue
        back, over = found[2][6] <= 0.0, found[1] >= 1.0
        if not (back or over):
            pose, part, tangent, longest = found
            step *= 1.3
        elif step > 1e-7:
            step *= 0.5
        elif back:
            return part, pose
        else:
            # The rest is almost nothing: move to the end itself.
            A, error = system(pose, 1.0)
            return 1.0, moved(pose, 1.0, np.append(np.linalg.solve(A[:, :6], -error), 0.0))[0]
    raise AssertionError("the curve does not end")
