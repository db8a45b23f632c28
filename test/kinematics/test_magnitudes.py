"""Requests at the ends of double precision: rounded poses, far targets, huge joint values."""

import warnings

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, NonFiniteError
from robomech_ros.kinematics import (
    Status,
    forward_kinematics,
    inverse_kinematics,
    inverse_kinematics_batch,
)
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import chain_from_dh, load_robot

ROBOTS = ("puma560", "ur5e", "panda")


@pytest.mark.parametrize("digits", [4, 5, 6, 8])
def test_targets_as_they_are_typed_or_printed_are_solved(digits):
    chain = load_robot("puma560")
    rng = np.random.default_rng(digits)
    targets = forward_kinematics(chain, rng.uniform(-np.pi, np.pi, (1000, 6)))
    targets[:, :3, :3] = targets[:, :3, :3].round(digits)
    given = targets.copy()
    _, _, status = inverse_kinematics_batch(chain, targets, respect_limits=False)
    assert (status == Status.SUCCESS).mean() > 0.98  # rounding moves some out of reach
    np.testing.assert_array_equal(targets, given)
    result = inverse_kinematics(chain, targets[0], respect_limits=False)
    turn = result.target[:3, :3]
    np.testing.assert_allclose(turn.T @ turn, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(turn, targets[0, :3, :3], atol=2.0 * 10.0**-digits)


def test_what_is_off_by_more_than_rounding_is_refused():
    chain = load_robot("ur5e")
    T = forward_kinematics(chain, np.full(6, 0.3))
    for scale, accepted in ((1 + 5e-5, True), (1 - 5e-5, True), (1 + 1e-3, False), (0.999, False)):
        off = T.copy()
        off[:3, :3] *= scale
        if accepted:
            assert len(inverse_kinematics(chain, off))
        else:
            with pytest.raises(BadValueError, match="a rotation matrix to 0.0002; it is off by"):
                inverse_kinematics(chain, off)


def test_the_last_row_may_be_rounded_as_well():
    chain = load_robot("ur5e")
    T = forward_kinematics(chain, np.full(6, 0.3))
    T[3] = [1e-7, -1e-7, 0.0, 1.0 - 1e-5]
    result = inverse_kinematics(chain, T)
    assert len(result) and result.target[3].tolist() == [0.0, 0.0, 0.0, 1.0]
    T[3, 0] = 1e-3
    with pytest.raises(BadValueError, match="last row of T is"):
        inverse_kinematics(chain, T)


@pytest.mark.parametrize("name", ROBOTS)
def test_a_target_too_far_for_doubles_is_refused(name):
    chain = load_robot(name)
    T = np.eye(4)
    T[0, 3] = 1e300
    for solve in (inverse_kinematics, lambda c, T: inverse_kinematics_batch(c, T[None])):
        with pytest.raises(BadValueError, match="position of T.* at most 1e[+]06 m"):
            solve(chain, T)
    T[0, 3] = 1e6
    result = inverse_kinematics(chain, T)
    assert result.status is Status.OUT_OF_REACH and "inf" not in result.reason


@pytest.mark.parametrize("name", ROBOTS)
def test_solutions_near_a_wound_up_seed_keep_their_digits(name):
    table = load_robot(name).dh
    chain = chain_from_dh(table.a, table.b, table.alpha, table.theta)
    T = forward_kinematics(chain, np.full(chain.n, 0.3))
    seed = np.full(chain.n, 99_999.0)
    result = inverse_kinematics(chain, T, seed=seed)
    assert len(result) and result.seed_distance.max() <= np.pi + 1e-9
    assert result.position_error.max() < 1e-9 and result.orientation_error.max() < 1e-9
    for far in (1.1e5, 1e9, 1e300):
        seed[2] = -far
        with pytest.raises(BadValueError, match=r"seed of joint .*at most 100000 rad"):
            inverse_kinematics(chain, T, seed=seed)
        with pytest.raises(BadValueError, match="at most 100000 rad"):
            inverse_kinematics_batch(chain, T[None], seed=seed)


def test_a_seed_of_a_continuous_joint_is_bounded_with_limits_on():
    chain = chain_from_dh([0.5, 0.4], [0, 0], [0, 0], limits=[(None, None), (-2, 2)])
    T = forward_kinematics(chain, [0.3, 0.4])
    assert len(inverse_kinematics(chain, T, seed=[9e4, 0.0]))
    with pytest.raises(BadValueError, match="seed of joint 'joint_1' is 10000000.0"):
        inverse_kinematics(chain, T, seed=[1e7, 0.0])
    with pytest.raises(NonFiniteError, match="seed of joint 'joint_1'"):
        inverse_kinematics(chain, T, seed=[np.inf, 0.0])


def test_huge_angles_are_taken_modulo_a_turn_and_not_approximated():
    from fractions import Fraction

    chain = chain_from_dh([1.0], [0.0], [0.0])
    # The digits of pi to 1e-120 bring 1e60 back into one turn with 60 digits to spare.
    pi = Fraction(
        "3.14159265358979323846264338327950288419716939937510582097494459230781640628620899862803"
        "482534211706798214808651328230664709384460955"
    )
    for value in (1e5, 1e16, 1e22, 1e60):
        rest = float(Fraction(value) % (2 * pi))
        pose = forward_kinematics(chain, [value])
        np.testing.assert_allclose(pose[:2, 3], [np.cos(rest), np.sin(rest)], atol=1e-15)
    assert np.isfinite(forward_kinematics(chain, [1e300])).all()


@pytest.mark.parametrize("function", [forward_kinematics, jacobian])
def test_a_pose_that_overflows_is_refused(function):
    chain = chain_from_dh([0, 0], [0, 0], [0, 0], types="PP")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # without compiled kernels NumPy warns
        with pytest.raises(BadValueError, match="joint values with a finite pose"):
            function(chain, [1.7e308, 1.7e308])
        with pytest.raises(BadValueError, match="joint values with a finite pose"):
            function(chain, [[0.0, 0.0], [1.7e308, 1.7e308]])
    assert forward_kinematics(chain, [1e300, 0.0])[2, 3] == 1e300
