"""Intervals without singular postures: proofs against dense samples, postures found, refusals."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, MissingLimitsError, NonFiniteError, WrongSizeError
from robomech_ros.kinetostatics import jacobian, singularity_free, singularity_report
from robomech_ros.kinetostatics.singularities.generic_rank import generic_rank
from robomech_ros.kinetostatics.singularities.minors import minors_of
from robomech_ros.robots import chain_from_dh, list_robots, load_robot

SAMPLES = 4000
ARMS = ["puma560", "stanford", "ur5e", "xarm6", "general6r", "planar3r", "scara", "vx300", "panda"]


def intervals(chain, width, seed):
    rng = np.random.default_rng(seed)
    middle = rng.uniform(-1.5, 1.5, chain.n)
    half = width * rng.uniform(0.3, 1.0, chain.n)
    slides = chain.types == 1
    middle[slides], half[slides] = 0.3 * middle[slides] + 0.6, 0.3 * half[slides]
    return middle - half, middle + half


@pytest.mark.parametrize("width", [0.1, 0.4, 1.2])
@pytest.mark.parametrize("robot", ARMS)
def test_against_samples(robot, width):
    chain = load_robot(robot)
    for seed in range(3):
        low, high = intervals(chain, width, seed)
        verdict = singularity_free(chain, low, high, most_boxes=300)
        if verdict.posture is not None:
            q = verdict.posture
            assert not verdict.proven and not verdict.undecided
            assert (q >= low).all() and (q <= high).all()
            assert singularity_report(chain, q, length=0.3).singular
        elif verdict.proven:
            q = np.random.default_rng(seed).uniform(low, high, (SAMPLES, chain.n))
            rank = generic_rank(chain)
            values = np.linalg.svd(jacobian(chain, q), compute_uv=False)[:, rank - 1]
            assert values.min() > 1e-6
            if chain.n == 6:
                signs = np.sign(np.linalg.det(jacobian(chain, q)))
                assert (signs == signs[0]).all()
        else:
            assert verdict.undecided and verdict.boxes == 300


@pytest.mark.parametrize("robot", ARMS)
def test_around_a_regular_posture_there_is_room(robot):
    chain = load_robot(robot)
    q = np.random.default_rng(7).uniform(-1.5, 1.5, chain.n) + 0.2
    verdict = singularity_free(chain, q - 0.02, q + 0.02)
    assert verdict.proven and verdict.posture is None and not verdict.undecided


@pytest.mark.parametrize("robot", ["puma560", "ur5e"])
def test_the_intervals_may_end_just_before_the_wrist_is_stretched(robot):
    """With all factors regular but that of the wrist, which vanishes at zero."""
    chain = load_robot(robot)
    q = np.array([0.3, -1.0, 0.9, 0.2, 0.5, 0.6]) if robot == "ur5e" else np.full(6, 0.5)
    q[2] += 0.8 if robot == "puma560" else 0.0
    low, high = q - 0.1, q + 0.1
    low[[0, 5]], high[[0, 5]] = -3.0, 3.0
    for least, proven in ((1e-3, True), (-1e-3, False)):
        low[4] = least
        verdict = singularity_free(chain, low, high)
        assert verdict.proven is proven
        assert (verdict.posture is None) is proven
        if not proven:
            assert singularity_report(chain, verdict.posture, length=0.3).kinds == ("wrist",)


@pytest.mark.parametrize("robot", ["iiwa14", "gen3", "scara", "ur5e", "stanford"])
def test_all_that_the_limits_allow(robot):
    chain = load_robot(robot)
    verdict = singularity_free(chain, most_boxes=50)
    q = verdict.posture
    assert singularity_report(chain, q, length=0.3).singular
    assert (q >= chain.lower).all() and (q <= chain.upper).all()


def test_where_one_minor_vanishes_another_may_not():
    """A redundant arm is regular where any six of its joints are."""
    chain = load_robot("iiwa14")
    low, high = np.full(7, 0.5), np.full(7, 0.6)
    low[1], high[1] = -0.1, 0.1
    verdict = singularity_free(chain, low, high)
    assert verdict.proven
    first, last = (np.sign(minors_of(chain).at(q)) for q in (low, high))
    assert (first != last).any() and (first == last).any()


def test_no_interval_at_all_is_a_posture():
    chain = load_robot("puma560")
    regular, singular = np.array([0.3, 0.4, 0.5, 0.2, 0.3, 0.6]), [0.3, 0.4, 0.5, 0.2, 0.0, 0.6]
    assert singularity_free(chain, regular, regular).proven
    np.testing.assert_allclose(singularity_free(chain, singular, singular).posture, singular)


@pytest.mark.parametrize("robot", [name for name in list_robots() if load_robot(name).n < 7])
def test_minors_and_their_bounds(robot):
    """The coefficients are those of the minors, and those over a box bound them."""
    chain = load_robot(robot)
    minors, rng = minors_of(chain), np.random.default_rng(9)
    turns = np.array([chain.types[joint] == 0 for joint in minors.joints])
    middle, half = rng.uniform(-2, 2, len(turns)), rng.uniform(0.1, 1.2, len(turns))
    reach = np.where(turns, np.tan(half / 2), half)
    bounds = minors.bernstein(middle, reach).reshape(minors.count, -1)
    degrees = np.array([(size - 1) // 2 for size in minors.tensor.shape[1:]])
    for _ in range(200):
        q = rng.uniform(-2, 2, chain.n)
        t = rng.uniform(-1, 1, len(turns)) * reach
        q[list(minors.joints)] = middle + np.where(turns, 2 * np.arctan(t), t)
        values = minors.at(q) * np.where(turns, (1 + t**2) ** degrees, 1.0).prod()
        assert (values >= bounds.min(axis=1) - 1e-9).all()
        assert (values <= bounds.max(axis=1) + 1e-9).all()


def test_what_is_refused():
    puma, zero = load_robot("puma560"), np.zeros(6)
    with pytest.raises(BadValueError, match="lower end of joint 'elbow' is 1.0, expected at most"):
        singularity_free(puma, [0, 0, 1, 0, 0, 0], zero)
    with pytest.raises(WrongSizeError, match="lower has shape"):
        singularity_free(puma, np.zeros((2, 6)), zero)
    with pytest.raises(NonFiniteError, match="upper of joint 'waist'"):
        singularity_free(puma, zero, [np.nan, 0, 0, 0, 0, 0])
    with pytest.raises(BadValueError, match="most_boxes is 0, expected a number of parts"):
        singularity_free(puma, zero, zero, most_boxes=0)
    with pytest.raises(MissingLimitsError, match="no position limit for joint"):
        singularity_free(load_robot("scara"), [0, 0, -np.inf, 0], [0, 0, 1, 0])
    with pytest.raises(BadValueError, match="with 9 joints.*expected one of 1 to 8 joints"):
        singularity_free(chain_from_dh([0.1] * 9, [0.2] * 9, [0.3] * 9), np.zeros(9), np.ones(9))
    with pytest.raises(BadValueError, match="one of 1 to 8 joints"):
        singularity_free(puma.with_tip("base_link"))
