"""Contours whose crossings are the postures of an arm."""

import numpy as np
import pytest
from general_arms import general_arm, random_postures

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinematics.oracles import PostureContours
from robomech_ros.robots import load_robot


def turned(q):
    return (q + np.pi) % (2.0 * np.pi) - np.pi


@pytest.mark.parametrize("name", ["general6r", "diestro", "random-0"])
def test_crossings_are_the_postures_and_what_is_left_over_tells_them_apart(name):
    chain = general_arm(name)
    pose = forward_kinematics(chain, random_postures(1, 4))[0]
    ours = inverse_kinematics(chain, pose, respect_limits=False).q
    found = PostureContours(chain, pose).all()
    postures = [each for each in found if each.posture is not None]
    assert len(postures) == len(ours)
    for each in postures:
        assert np.abs(turned(ours - each.posture.q)).max(axis=1).min() < 1e-7
        np.testing.assert_allclose(turned(each.posture.q[3:5] - each.angles), 0.0, atol=1e-8)
        assert each.left_over < 1e-9
    spurious = [each for each in found if each.posture is None]
    assert spurious
    assert min(each.left_over for each in spurious) > 1e-3


def test_an_estimate_beside_a_crossing_is_refined_to_it():
    """Two pixels of a page 600 pixels wide."""
    chain = general_arm("general6r")
    pose = forward_kinematics(chain, random_postures(1, 4))[0]
    contours = PostureContours(chain, pose)
    for each in contours.all():
        if each.posture is None:
            continue
        again = contours.refine(each.angles + 2.0 * 2.0 * np.pi / 600.0)
        np.testing.assert_allclose(again.angles, each.angles, atol=1e-10)
        assert len(again.path) > 2
        error = forward_kinematics(chain, again.posture.q) - pose
        assert np.abs(error).max() < 1e-12


def test_the_curves_run_through_the_crossings():
    chain = general_arm("general6r")
    pose = forward_kinematics(chain, random_postures(1, 4))[0]
    contours = PostureContours(chain, pose)
    curves = [np.concatenate(pieces) for pieces in contours.curves()]
    postures = [each for each in contours.all() if each.posture is not None]
    assert postures
    for each in postures:
        for points in curves:
            assert np.linalg.norm(points - each.angles, axis=1).min() < 0.03


def test_wrong_arms_and_estimates():
    with pytest.raises(BadValueError, match="six revolute"):
        PostureContours(load_robot("panda"), np.eye(4))
    chain = general_arm("general6r")
    contours = PostureContours(chain, forward_kinematics(chain, np.zeros(6)))
    with pytest.raises(WrongSizeError, match="estimate"):
        contours.refine([1.0])
    with pytest.raises(NonFiniteError):
        contours.refine([np.nan, 0.0])
