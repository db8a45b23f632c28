"""Pose paths in, joint paths out: continuous, with the fewest jumps, told where they are."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, SeedOutsideLimitsError, WrongSizeError
from robomech_ros.kinematics import branch_path, forward_kinematics
from robomech_ros.kinematics.branch_selection import fewest_jumps
from robomech_ros.robots import chain_from_dh, load_robot

HALF = np.pi / 2


def path_between(chain, seed, count=60, width=0.6):
    """Poses of a smooth joint path inside the limits, and that path."""
    rng = np.random.default_rng(seed)
    lower = np.where(np.isfinite(chain.lower), np.maximum(chain.lower, -2.5), -2.5)
    upper = np.where(np.isfinite(chain.upper), np.minimum(chain.upper, 2.5), 2.5)
    a, b = rng.uniform(lower, upper, (2, chain.n))
    b = a + width * (b - a)
    s = np.linspace(0, 1, count)[:, None]
    q = a + (3 * s**2 - 2 * s**3) * (b - a)
    return forward_kinematics(chain, q), q


def squares(q):
    """Sum of the squares of all moves."""
    return np.square(np.diff(q, axis=0)).sum()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["puma560", "ur5e", "irb120", "panda", "iiwa14", "vx300", "scara"])
def test_a_joint_path_is_followed_from_its_start(name, pose_errors):
    chain = load_robot(name)
    for seed in (0, 1, 2, 4, 5):
        poses, q = path_between(chain, seed)
        result = branch_path(chain, poses, start=q[0])
        assert result.complete and result.fraction == 1.0 and result.reason == ""
        assert (result.q >= chain.lower).all() and (result.q <= chain.upper).all()
        for pose, posture in zip(poses, result.q, strict=True):
            assert pose_errors(chain, pose, posture[None]).max() < 1e-8
        assert not result.jumps
        if chain.n <= 6:
            assert squares(result.q) <= squares(q) + 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("name", ["panda", "iiwa14"])
def test_redundant_arms_find_the_way_where_the_nearest_posture_ends_in_a_jump(name):
    """Going to the nearest posture only, some of these paths jump: 4 and 9 of 40."""
    chain = load_robot(name)
    for seed in range(40):
        poses, q = path_between(chain, seed, width=1.0)
        result = branch_path(chain, poses, start=q[0])
        assert result.complete and not result.jumps
        assert (result.q >= chain.lower).all() and (result.q <= chain.upper).all()
        np.testing.assert_allclose(forward_kinematics(chain, result.q), poses, atol=1e-8)


def test_without_a_start_the_best_branch_is_taken():
    """Only one of the branches of this path goes on without leaving the limits."""
    chain = load_robot("irb120")
    continuous = 0
    for seed in range(20):
        poses, q = path_between(chain, seed, width=1.0)
        result = branch_path(chain, poses)
        assert result.complete and not result.jumps
        assert np.abs(np.diff(result.q, axis=0)).max() <= 0.5
        continuous += 1
        assert (
            np.square(np.diff(result.q, axis=0)).sum() <= np.square(np.diff(q, axis=0)).sum() + 1e-9
        )
    assert continuous == 20


def test_a_jump_is_told_where_it_has_to_be():
    """A start on a branch that meets a joint limit half way: one jump, to another branch."""
    limits = np.tile([-3.1, 3.1], (6, 1))
    limits[2] = [-3.1, -0.6]
    arm = {
        "a": [0, 0.4318, 0.0203, 0, 0, 0],
        "b": [0, 0, 0.15005, 0.4318, 0, 0],
        "alpha": [HALF, 0, -HALF, HALF, -HALF, 0],
    }
    free = chain_from_dh(**arm, limits=np.tile([-3.1, 3.1], (6, 1)))
    held = chain_from_dh(**arm, limits=limits)
    # The elbow is stretched at -1.52, so that these postures stay on one branch.
    q = np.tile([0.3, 0.5, -1.2, 0.4, 0.8, 0.2], (80, 1))
    q[:, 2] += np.linspace(0, 1.0, 80)
    poses = forward_kinematics(free, q)
    assert branch_path(free, poses, start=q[0]).jumps == ()
    result = branch_path(held, poses, start=q[0])
    crossing = int(np.argmax(q[:, 2] > -0.6))
    assert result.complete and len(result.jumps) == 1
    (jump,) = result.jumps
    assert jump.index <= crossing and "to another branch" in jump.reason
    moves = np.diff(np.vstack((q[0], result.q)), axis=0)
    np.testing.assert_allclose(jump.move, moves[jump.index])


def test_windings_go_on_beyond_half_a_turn():
    chain = load_robot("ur5e")
    q = np.tile([0.3, -1.2, 1.5, -0.8, 0.9, -4.0], (200, 1))
    q[:, 5] += np.linspace(0, 8.0, 200)
    result = branch_path(chain, forward_kinematics(chain, q), start=q[0])
    assert result.jumps == ()
    np.testing.assert_allclose(result.q, q, atol=1e-7)
    free = branch_path(chain, forward_kinematics(chain, q))
    assert free.jumps == () and np.abs(np.diff(free.q, axis=0)).max() < 0.5


def test_a_joint_that_has_wound_up_has_to_unwind():
    chain = load_robot("ur5e")
    q = np.tile([0.3, -1.2, 1.5, -0.8, 0.9, 0.0], (400, 1))
    q[:, 5] += np.linspace(0, 9.0, 400)
    result = branch_path(chain, forward_kinematics(chain, q), start=q[0])
    assert result.complete and len(result.jumps) == 1
    (jump,) = result.jumps
    assert "to another winding" in jump.reason and "'wrist_3_joint'" in jump.reason
    assert q[jump.index - 1, 5] <= 2 * np.pi < q[jump.index, 5]
    assert abs(jump.move[5]) > 6.0
    unwound = branch_path(chain, forward_kinematics(chain, q))
    assert unwound.jumps == ()


def test_where_the_path_leaves_the_workspace_it_ends():
    chain = load_robot("puma560")
    T = forward_kinematics(chain, [0.2, 0.3, -1.2, 0.1, 0.4, 0.2])
    poses = np.tile(T, (50, 1, 1))
    poses[:, 0, 3] += np.linspace(0, 1.0, 50)
    result = branch_path(chain, poses)
    assert not result.complete and 0.0 < result.fraction < 1.0
    assert len(result.q) == round(result.fraction * 50)
    assert result.reason.startswith(f"pose {len(result.q)}: ")
    nowhere = branch_path(chain, poses[-2:])
    assert nowhere.q.shape == (0, 6) and nowhere.jumps == () and "pose 0" in nowhere.reason


def test_each_joint_has_the_threshold_of_its_kind():
    chain = chain_from_dh([0.0, 1.0], [0.0, 0.0], [0.0, 0.0], types="PR")
    slides, turns = [0.3, 0.0], [0.0, 0.4]
    still = np.zeros((1, 2))
    lists = [still, np.array([slides, turns]), still]
    path = fewest_jumps(chain, lists, None, np.array([0.1, 0.5]))
    np.testing.assert_allclose(path, [still[0], turns, still[0]], atol=1e-12)


def test_a_start_elsewhere_is_a_jump():
    chain = load_robot("puma560")
    poses, _ = path_between(chain, 3)
    result = branch_path(chain, poses, start=chain.midrange())
    assert result.jumps and result.jumps[0].index == 0


def test_bad_requests_are_refused():
    chain = load_robot("puma560")
    poses, q = path_between(chain, 0)
    with pytest.raises(BadValueError, match="at least one pose"):
        branch_path(chain, np.empty((0, 4, 4)))
    with pytest.raises(WrongSizeError, match="poses has shape"):
        branch_path(chain, poses[0])
    with pytest.raises(SeedOutsideLimitsError):
        branch_path(chain, poses, start=q[0] + 9.0)
    with pytest.raises(BadValueError, match="positive"):
        branch_path(chain, poses, revolute_jump=0.0)
