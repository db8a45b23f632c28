"""Arms with bodies: random ones, and the golden ones."""

from dataclasses import replace

import numpy as np

from robomech_ros.robots import Body, Drive, chain_from_dh

GRAVITY = np.array([0.3, -0.4, -9.81])


def random_body(rng):
    """A body of random points: what every body can have."""
    points, weights = rng.normal(0.0, 0.2, (12, 3)), rng.uniform(0.1, 1.0, 12)
    mass = weights.sum()
    com = weights @ points / mass
    arms = points - com
    second = arms.T @ (weights[:, None] * arms)
    return Body(mass, com, np.trace(second) * np.eye(3) - second)


def random_drive(rng):
    """Friction of all kinds, and a rotor."""
    coulomb = rng.uniform(0.1, 1.0)
    return Drive(
        viscous=rng.uniform(0.1, 2.0),
        coulomb=coulomb,
        static=coulomb + rng.uniform(0.1, 1.0),
        stribeck_velocity=rng.uniform(0.05, 0.5),
        rotor_inertia=rng.uniform(1e-5, 1e-3),
        gear_ratio=rng.uniform(-100.0, 100.0),
    )


def furnished(chain, seed, drives=False):
    """The chain with random bodies, and with random drives where asked for."""
    rng = np.random.default_rng(seed)
    bodies = tuple(random_body(rng) for _ in range(chain.n))
    made = tuple(random_drive(rng) for _ in range(chain.n)) if drives else ()
    return replace(chain, bodies=bodies, drives=made)


def golden_planar(case):
    lengths = case["params"]["l"]
    rows = zip(*(case["params"][key] for key in ("l", "lc", "m", "I")), strict=True)
    bodies = [
        Body(m, [at - length, 0.0, 0.0], np.diag([0.0, moment, moment]))
        for length, at, m, moment in rows
    ]
    return chain_from_dh(lengths, [0.0] * 3, [0.0] * 3, bodies=bodies)


def states(chain, count, seed=0):
    """Random joint values, rates and accelerations, shape (3, count, n)."""
    return np.random.default_rng(seed).uniform(-3.0, 3.0, (3, count, chain.n))


def relative(found, expected):
    """Largest difference, seen from the largest of each state."""
    found, expected = np.asarray(found), np.asarray(expected)
    scale = np.abs(expected).max(axis=-1, keepdims=True)
    return float((np.abs(found - expected) / scale).max())
