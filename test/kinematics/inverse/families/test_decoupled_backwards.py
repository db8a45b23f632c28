"""Six-joint arms whose first three axes meet: in closed form, read from the tip."""

import numpy as np
import pytest

from robomech_ros.kinematics import (
    Status,
    forward_kinematics,
    inverse_kinematics,
    inverse_kinematics_batch,
)
from robomech_ros.kinematics.inverse.families.six_joints import chain_of, reversed_transforms
from robomech_ros.robots import load_robot
from robomech_ros.robots.chain_layout import unpack_chain

ARMS = ["puma560", "irb120", "stanford"]


def turned_round(name):
    """The robot with its tip fixed and its base moving."""
    robot = load_robot(name)
    return chain_of(reversed_transforms(unpack_chain(robot.packed)), robot.types[::-1].tolist())


def random_postures(chain, count, seed):
    half = np.where(chain.types == 1, 0.5, np.pi)
    return np.random.default_rng(seed).uniform(-half, half, (count, 6))


@pytest.mark.parametrize("name", ARMS)
def test_solutions_are_those_of_the_robot_itself(apart, pose_errors, name):
    robot, chain = load_robot(name), turned_round(name)
    q = random_postures(chain, 200, 1)
    T = forward_kinematics(chain, q)
    found, counts, status = inverse_kinematics_batch(chain, T, respect_limits=False)
    _, own, _ = inverse_kinematics_batch(robot, np.linalg.inv(T), respect_limits=False)
    assert (status == Status.SUCCESS).all() and (counts == own).all()
    for k, posture in enumerate(q):
        assert apart(chain, found[k, : counts[k]], posture).min() < 1e-8
        assert pose_errors(chain, T[k], found[k, : counts[k]]).max() < 1e-9


@pytest.mark.parametrize("name", ARMS)
def test_postures_are_numbered(name):
    chain = turned_round(name)
    for T in forward_kinematics(chain, random_postures(chain, 20, 2)):
        result = inverse_kinematics(chain, T, respect_limits=False)
        assert result.family == "decoupled" and result.complete
        assert len(set(result.branches)) == len(result)
        assert all(branch.startswith("posture-") for branch in result.branches)


def test_a_stretched_shoulder_is_a_continuum(pose_errors):
    """Axes 1 and 3 on one line turn against each other while the tip stays."""
    chain = turned_round("puma560")
    q = np.array([0.3, 0.0, 0.7, 0.4, -1.2, 0.5])
    T = forward_kinematics(chain, q)
    result = inverse_kinematics(chain, T, seed=q, respect_limits=False)
    assert result.continuum and not result.complete
    assert any("self-motion" in branch for branch in result.branches)
    assert pose_errors(chain, T, result.q).max() < 1e-9
    np.testing.assert_allclose(result.q[0], q, atol=1e-9)
