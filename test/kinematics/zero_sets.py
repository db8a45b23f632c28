"""Postures at which a function of the joint values is zero, many at once."""

import numpy as np

__all__ = ["on_segments", "turned_to"]


def on_segments(function, chain, count, rng, points=30):
    """Postures on the zero set, each the first on a segment between two random ones.

    ``function`` takes postures, shape (m, n), and gives m values.
    """
    parts = np.linspace(0, 1, points)[:, None, None]
    found = []
    while sum(map(len, found)) < count:
        start, end = rng.uniform(-np.pi, np.pi, (2, count, chain.n))
        steps = start + parts * (end - start)
        crossed = _crossed(function, steps)
        found.append(_between(function, steps, crossed.argmax(axis=0), crossed.any(axis=0)))
    return np.concatenate(found)[:count]


def turned_to(function, chain, count, rng, joints, points=25):
    """Random postures on the zero set, where one of the joints is turned until they are on it."""
    found = []
    while sum(map(len, found)) < count:
        q = rng.uniform(-np.pi, np.pi, (count, chain.n))
        q[:, chain.types == 1] *= 0.2
        steps = np.repeat(q[None], points, axis=0)
        steps[:, np.arange(count), rng.choice(joints, count)] = np.linspace(-np.pi, np.pi, points)[
            :, None
        ]
        crossed = _crossed(function, steps)
        one = (crossed * rng.uniform(0.1, 1.0, crossed.shape)).argmax(axis=0)
        found.append(_between(function, steps, one, crossed.any(axis=0)))
    return np.concatenate(found)[:count]


def _crossed(function, steps):
    """Whether the sign changes from each step to the next."""
    values = function(steps.reshape(-1, steps.shape[2])).reshape(steps.shape[:2])
    return values[1:] * values[:-1] < 0


def _between(function, steps, k, there):
    """Bisect between the steps k and k + 1 of those that have a zero there."""
    low, high = steps[k[there], there], steps[k[there] + 1, there]
    sign = function(low) > 0
    for _ in range(80):
        middle = 0.5 * (low + high)
        before = ((function(middle) > 0) == sign)[:, None]
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return 0.5 * (low + high)
