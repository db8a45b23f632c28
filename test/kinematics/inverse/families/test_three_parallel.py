"""Arms with three parallel axes: every solution of random poses."""

import numpy as np
import pytest

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics, inverse_kinematics_batch
from robomech_ros.kinematics.inverse.families.three_parallel import match
from robomech_ros.robots import chain_from_dh

POSES = 10_000
ROBOTS = ("ur5e", "ur10e", "no-offset")
SYNTHETIC = tuple(
    f"{axes}-{kind}"
    for axes in ("123", "234", "345", "456")
    for kind in ("skew", "meeting", "parallel", "square")
)
SLIDING = tuple(
    f"{axes}-slide{joint}"
    for axes, joints in (("123", "456"), ("234", "156"), ("345", "126"), ("456", "123"))
    for joint in joints
)
ARMS = ROBOTS + SYNTHETIC + SLIDING


def random_postures(chain, count, seed):
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, chain.n))
    q[:, chain.types == 1] *= 0.2
    return q


@pytest.mark.parametrize("name", ARMS)
def test_residuals_and_generating_postures(three_parallel_arm, apart, pose_errors, name):
    chain = three_parallel_arm(name)
    q = random_postures(chain, POSES, 1)
    targets = forward_kinematics(chain, q)
    solutions, counts, status = inverse_kinematics_batch(chain, targets, respect_limits=False)
    assert (counts > 0).all() and (status == 0).all() and counts.max() <= 8
    rows = np.arange(solutions.shape[1]) < counts[:, None]
    errors = pose_errors(chain, np.repeat(targets, counts, axis=0), solutions[rows])
    assert errors.max() < 1e-9
    assert np.quantile(errors, 0.999) < 1e-12
    distance = apart(chain, np.where(rows[:, :, None], solutions, 9.0), q[:, None, :])
    assert np.where(rows, distance, np.inf).min(axis=1).max() < 1e-6


@pytest.mark.parametrize("name", ARMS)
def test_family(three_parallel_arm, name):
    chain = three_parallel_arm(name)
    result = inverse_kinematics(
        chain, forward_kinematics(chain, np.full(6, 0.4)), respect_limits=False
    )
    assert result.family == "three-parallel" and result.complete


@pytest.mark.parametrize("count", [12, pytest.param(50, marks=pytest.mark.long)])
@pytest.mark.parametrize("name", ("ur5e", "no-offset", *SYNTHETIC, *SLIDING[::3]))
def test_nothing_missing(three_parallel_arm, apart, search_everywhere, name, count):
    chain = three_parallel_arm(name)
    q = random_postures(chain, count, 2)
    targets = forward_kinematics(chain, q)
    solutions, counts, _ = inverse_kinematics_batch(chain, targets, respect_limits=False)
    for k, postures in enumerate(search_everywhere(chain, targets)):
        ours = solutions[k, : counts[k]]
        nearest = apart(chain, ours, postures[:, None]).min(axis=1)
        assert nearest.max(initial=0.0) < 1e-6, (name, k, postures[nearest.argmax()])


@pytest.mark.parametrize("name", ("ur5e", "123-skew", "345-meeting", "456-parallel"))
def test_solutions_are_distinct(three_parallel_arm, apart, name):
    chain = three_parallel_arm(name)
    targets = forward_kinematics(chain, random_postures(chain, 300, 3))
    for target in targets:
        q = inverse_kinematics(chain, target, respect_limits=False).q
        distance = apart(chain, q[:, None], q[None]) + 9.0 * np.eye(len(q))
        assert distance.min() > 1e-6


def test_branches_of_a_universal_robot_differ(three_parallel_arm):
    chain = three_parallel_arm("ur5e")
    T = forward_kinematics(chain, [0.3, -1.2, 1.5, -1.9, -1.3, 0.4])
    result = inverse_kinematics(chain, T, respect_limits=False)
    assert len(result) == 8 and len(set(result.branches)) == 8
    named = {
        f"{s} {e} {w}"
        for s in ("shoulder-left", "shoulder-right")
        for e in ("elbow-up", "elbow-down")
        for w in ("wrist-flip", "wrist-noflip")
    }
    assert set(result.branches) == named


def test_elbow_up_is_up(three_parallel_arm):
    """In a level line of the stretched arm, the elbow of an elbow-up posture is above the line."""
    chain = three_parallel_arm("ur5e")
    elbow = chain.with_tip("forearm_link")
    T = forward_kinematics(chain, [0.3, -0.6, 1.2, -1.9, -1.3, 0.4])
    result = inverse_kinematics(chain, T, respect_limits=False)
    height = forward_kinematics(elbow, result.q[:, : elbow.n])[:, 2, 3]
    for shoulder in ("shoulder-left", "shoulder-right"):
        rows = [shoulder in branch for branch in result.branches]
        up = np.array(["elbow-up" in branch for branch in result.branches])[rows]
        assert height[rows][up].min() > height[rows][~up].max()


def test_same_request_same_bytes(three_parallel_arm):
    chain = three_parallel_arm("234-skew")
    targets = forward_kinematics(chain, random_postures(chain, 200, 4))
    first = inverse_kinematics_batch(chain, targets, respect_limits=False)
    second = inverse_kinematics_batch(chain, targets.copy(), respect_limits=False)
    for one, other in zip(first, second, strict=True):
        assert one.tobytes() == other.tobytes()


def test_calibrated_arm_is_not_idealised(three_parallel_arm):
    """Axes 1e-4 rad off parallel are no three parallel axes."""
    ideal = three_parallel_arm("ur5e").dh
    off = chain_from_dh(ideal.a, ideal.b, ideal.alpha + [0, 1e-4, 0, 0, 0, 0], ideal.theta)
    assert match(off) is None
    T = forward_kinematics(off, [0.3, -1.2, 1.5, -1.9, -1.3, 0.4])
    result = inverse_kinematics(off, T, respect_limits=False)
    assert result.family == "general-6r" and result.complete and len(result)
    assert result.position_error.max() < 1e-9


@pytest.mark.parametrize("digits", (9, 10, 12))
def test_printed_angles_are_solved_for_the_arm_as_printed(
    three_parallel_arm, apart, pose_errors, digits
):
    """Angles with nine digits count as parallel; the residual is that of the printed arm."""
    ideal = three_parallel_arm("ur5e").dh
    alpha = np.array([np.pi / 2, np.pi, np.pi, np.pi / 2, -np.pi / 2, 0.0]).round(digits)
    chain = chain_from_dh(ideal.a, ideal.b, alpha)
    q = random_postures(chain, 300, 5)
    targets = forward_kinematics(chain, q)
    solutions, counts, _ = inverse_kinematics_batch(chain, targets, respect_limits=False)
    assert match(chain) is not None
    for k in range(len(q)):
        ours = solutions[k, : counts[k]]
        assert apart(chain, ours, q[k]).min() < 1e-6
        assert pose_errors(chain, targets[k], ours).max() < 1e-11


@pytest.mark.parametrize("power", range(-12, -1))
@pytest.mark.parametrize("quantity", ("distance", "angle"))
@pytest.mark.parametrize("first", (0, 1, 2, 3))
def test_outer_axes_that_nearly_meet_or_are_nearly_parallel(
    apart, pose_errors, power, quantity, first
):
    rng = np.random.default_rng([first, -power, len(quantity)])
    a, b, alpha = rng.uniform(0.1, 0.6, 6), rng.uniform(-0.4, 0.4, 6), rng.uniform(0.4, 2.7, 6)
    alpha[first : first + 2] = rng.choice([0.0, np.pi], 2)
    outer = 4 if first < 2 else 0
    if quantity == "distance":
        a[outer] = 3.0 * 10.0**power
    else:
        alpha[outer] = 3.0 * 10.0**power
    chain = chain_from_dh(a, b, alpha)
    q = random_postures(chain, 500, 6)
    targets = forward_kinematics(chain, q)
    solutions, counts, _ = inverse_kinematics_batch(chain, targets, respect_limits=False)
    rows = np.arange(solutions.shape[1]) < counts[:, None]
    assert counts.min() > 0 and counts.max() <= 8
    errors = pose_errors(chain, np.repeat(targets, counts, axis=0), solutions[rows])
    assert errors.max() < 1e-9
    distance = apart(chain, np.where(rows[:, :, None], solutions, 9.0), q[:, None, :])
    assert np.where(rows, distance, np.inf).min(axis=1).max() < 1e-4


@pytest.mark.parametrize(
    "alpha",
    (
        [1.2, 0.0, 0.0, 0.0, 0.9, 0.3],  # four parallel axes
        [0.0, 0.0, 1.2, 0.0, 0.0, 0.3],  # twice three parallel axes
        [1.2, 0.0, 0.9, -0.8, 0.7, 0.3],  # two parallel axes only
    ),
)
def test_arms_of_other_kinds_do_not_match(alpha):
    chain = chain_from_dh([0.1, 0.4, 0.3, 0.2, 0.1, 0.1], [0.1, 0.2, 0.1, 0.2, 0.1, 0.1], alpha)
    assert match(chain) is None


def test_coincident_parallel_axes_do_not_match():
    a, alpha = [0.1, 0.0, 0.3, 0.2, 0.1, 0.1], [1.2, 0.0, 0.0, -0.8, 0.7, 0.3]
    assert match(chain_from_dh(a, [0.1, 0.2, 0.1, 0.2, 0.1, 0.1], alpha)) is None


@pytest.mark.parametrize("slides", ((0, 4), (0, 5), (4, 5)))
def test_two_prismatic_joints_do_not_match(three_parallel_arm, slides):
    dh = three_parallel_arm("234-skew").dh
    types = [int(joint in slides) for joint in range(6)]
    assert match(chain_from_dh(dh.a, dh.b, dh.alpha, types=types)) is None


def test_nothing_beyond_the_reach(three_parallel_arm):
    chain = three_parallel_arm("ur5e")
    T = forward_kinematics(chain, np.full(6, 0.3))
    T[:3, 3] = [3.0, 0.0, 0.0]
    result = inverse_kinematics(chain, T, respect_limits=False)
    assert not len(result) and result.status.name == "OUT_OF_REACH"
