"""Arms with one to three slides at poses where joints stand at multiples of 45 degrees."""

import itertools

import numpy as np
import pytest

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import chain_from_dh

HALF = 0.5 * np.pi
ARMS = [
    (count, number, "".join("P" if joint in slides else "R" for joint in range(6)))
    for count in (1, 2, 3)
    for number, slides in enumerate(itertools.combinations(range(6), count))
]
# Of each arm, so that there are some 240 with each number of slides.
POSES = {1: 40, 2: 16, 3: 12}
NUDGES = (0.0, 0.0, 0.0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-3)


def special_arm(types, rng):
    """Tables of round numbers; every other one with some right angles, zeros and tiny lengths."""
    a, b = np.round(rng.uniform(-0.5, 0.5, (2, 6)), 1)
    alpha = np.where(rng.random(6) < 0.4, rng.choice([-HALF, HALF], 6), rng.uniform(-3.0, 3.0, 6))
    if rng.random() < 0.5:
        a, b = rng.choice([0.0, 1e-4, 1.0, 1.0], (2, 6)) * (a, b)
    return chain_from_dh(a, b, alpha, types=types)


def postures_of(chain, count, rng):
    step = rng.choice([HALF, HALF, 0.5 * HALF], (count, 1))
    turns, slides = rng.integers(-1, 3, (count, 6)) * step, rng.integers(-3, 4, (count, 6)) * 0.1
    off = rng.choice(NUDGES, (count, 1)) * rng.normal(size=(count, 6))
    return np.where(chain.types == 1, slides, turns) + off


def is_regular(chain, q):
    values = np.linalg.svd(jacobian(chain, q), compute_uv=False)
    return values[-1] > 1e-3 * values[0]


def check(chain, postures, apart):
    """Look for the generating postures; tell how many are regular, and how many proved."""
    regular, proved = 0, 0
    for q in postures:
        result = inverse_kinematics(chain, forward_kinematics(chain, q), respect_limits=False)
        nearest = apart(chain, result.q, q).min() if len(result) else np.inf
        if is_regular(chain, q):
            regular += 1
            proved += result.complete
            # A posture with a double neighbour is known to the root of the rounding.
            assert nearest < 1e-6 or not result.complete, (q, nearest)
            assert nearest < 1e-6 or chain.types.sum() == 1, (q, nearest)
        elif result.complete:
            assert nearest < 1e-3, (q, nearest)
    return regular, proved


@pytest.mark.parametrize("slides", (1, 2, 3))
def test_round_poses(apart, slides):
    regular, proved, poses = 0, 0, 0
    for count, number, types in ARMS:
        if count == slides:
            rng = np.random.default_rng([count, number])
            chain = special_arm(types, rng)
            postures = postures_of(chain, POSES[count], rng)
            more = check(chain, postures, apart)
            regular, proved, poses = regular + more[0], proved + more[1], poses + len(postures)
    assert poses >= 200 and regular > 0.25 * poses
    assert proved > 0.9 * regular


MEETING = [
    (
        ([-0.2, 0.5, 0.1, -0.4, -0.5, 0.3], [-0.2, -0.1, 0.1, -0.5, 0.5, -0.3]),
        [-HALF, 0.43, 0.78, -0.68, 0.79, -HALF],
        "RRRPRP",
        [-HALF, -HALF, np.pi, 0.05 * np.pi, np.pi, 0.1 * np.pi],
    ),
    (
        ([0.0, 0.0, 0.3, 0.0, -0.1, 0.19], [0.04, 0.0, 0.0, 0.275, 0.0, 0.0]),
        [-0.5 * HALF, -3.015, -0.157, 0.905, -HALF, 0.0],
        "RRPRPR",
        [np.pi, -HALF, 0.1 * np.pi, np.pi, 0.1 * np.pi, np.pi],
    ),
]


@pytest.mark.parametrize(("lengths", "alpha", "types", "q"), MEETING)
@pytest.mark.parametrize("off", (0.0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-3))
def test_where_the_angles_of_the_opposite_joint_meet(apart, lengths, alpha, types, q, off):
    """There both postures with a value of the given joint become one, which is regular."""
    chain = chain_from_dh(*lengths, alpha, types=types)
    for sign in (-1.0, 1.0):
        posture = q + sign * off * np.array([1.0, -0.7, 0.4, 0.9, -0.5, 0.8])
        result = inverse_kinematics(chain, forward_kinematics(chain, posture), respect_limits=False)
        assert result.complete and apart(chain, result.q, posture).min() < 1e-6


def test_slides_that_move_against_each_other_are_told_near_the_arm(apart):
    """Two slides are parallel in these postures, or three in one plane."""
    rng = np.random.default_rng(0)
    for types, joint in (("RPRPRP", 2), ("RRPRPR", 3)):
        a, b = rng.uniform(-0.4, 0.4, (2, 6))
        alpha = rng.uniform(0.4, 1.2, 6)
        # Slides before and behind one joint that stands so that they are parallel.
        alpha[joint] = alpha[joint - 1]
        chain = chain_from_dh(a, b, alpha, types=types)
        for q in rng.uniform(-0.5, 0.5, (5, 6)):
            q[joint] = np.pi
            result = inverse_kinematics(chain, forward_kinematics(chain, q), respect_limits=False)
            assert result.continuum and not result.complete
            slides = result.q[:, chain.types == 1]
            assert np.abs(slides).max(axis=1).min() < 5.0
