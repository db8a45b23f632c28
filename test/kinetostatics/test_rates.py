"""Joint rates from twists: lstsq, the pseudo-inverse, golden values, damping, what is refused."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robomech_ros._kernels.kinetostatics import rates as kernel
from robomech_ros.errors import BadValueError, NonFiniteError, UnknownLinkError, WrongSizeError
from robomech_ros.kinetostatics import jacobian, joint_rates, point_jacobian
from robomech_ros.kinetostatics.decoupled_blocks import wrist_of
from robomech_ros.robots import list_robots, load_robot


def pinv_rates(chain, q, twist, point=(0, 0, 0), axes=None, length=1.0):
    """By numpy's pseudo-inverse of the scaled Jacobian."""
    scale = np.repeat((1.0, 1.0 / length), 3)
    J = scale[:, None] * point_jacobian(chain, q, point, axes)
    return np.linalg.pinv(J, rcond=1e-6) @ (scale * twist)


def test_golden_rates_of_the_fanuc_arc_mate(golden):
    case = golden("kinetostatics_fanuc")
    chain, q = load_robot("fanuc_arcmate"), case["theta"]
    twist = np.array(case["J"]) @ case["qd"]
    np.testing.assert_allclose(joint_rates(chain, q, twist), case["qd"], rtol=0, atol=1e-12)


@pytest.mark.parametrize("robot", list_robots())
def test_agrees_with_the_pseudo_inverse(robot):
    chain = load_robot(robot)
    rng = np.random.default_rng(3)
    q, twists = rng.uniform(-3, 3, (100, chain.n)), rng.normal(size=(100, 6))
    for row, twist, found in zip(q, twists, joint_rates(chain, q, twists), strict=True):
        wanted = pinv_rates(chain, row, twist)
        J = jacobian(chain, row)
        tolerance = 1e-13 * np.linalg.cond(J) ** (2 if chain.n < 6 else 1)
        assert np.linalg.norm(found - wanted) <= tolerance * np.linalg.norm(wanted), row
        if chain.n >= 6:
            np.testing.assert_allclose(J @ found, twist, rtol=0, atol=1e-10)


@pytest.mark.parametrize("seed", range(24))
def test_random_chains_at_a_point_in_other_axes(random_chain, seed):
    chain = random_chain(seed, n=1 + seed % 8, kind="general")
    rng = np.random.default_rng(seed)
    q, twist, point = rng.uniform(-2, 2, chain.n), rng.normal(size=6), rng.normal(size=3)
    axes, length = Rotation.random(rng=rng).as_matrix(), rng.uniform(0.1, 3)
    found = joint_rates(chain, q, twist, point=point, axes=axes, length=length)
    wanted = pinv_rates(chain, q, twist, point, axes, length)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-10 * max(1, abs(wanted).max()))


def test_the_decoupled_way_is_taken_and_agrees_with_elimination():
    """An arm with slides in front of its wrist too: Stanford."""
    for robot in ("puma560", "stanford", "irb120"):
        chain, (centre, spherical) = load_robot(robot), wrist_of(load_robot(robot))
        assert spherical
        rng = np.random.default_rng(0)
        q, twist = rng.uniform(-2, 2, (50, 6)), rng.normal(size=(50, 6))
        both = np.empty((2, 50, 6))
        for way in (0, 1):
            given = chain.packed, way, centre, np.array([0.1, 0.2, 0.3]), 1.0, 0.0
            assert kernel.joint_rates(*given, q, twist, np.empty((0, 6)), both[way]) == 0
        size = np.abs(both[0]).max(axis=1, keepdims=True)
        np.testing.assert_allclose(both[1] / size, both[0] / size, rtol=0, atol=1e-9)


@pytest.mark.parametrize("robot", ["puma560", "ur5e", "panda", "scara"])
def test_damping_weakens_only_what_is_nearly_lost(robot):
    chain = load_robot(robot)
    rng = np.random.default_rng(1)
    for near in (1.0, 1e-1, 1e-3, 1e-7, 0.0):
        q, twist = near * rng.uniform(-1, 1, chain.n), rng.normal(size=6)
        u, s, vt = np.linalg.svd(jacobian(chain, q), full_matrices=False)
        gain = np.where(s < 0.1, s / 0.01, 1.0 / np.maximum(s, 0.1))
        wanted = vt.T @ (gain * (u.T @ twist))
        found = joint_rates(chain, q, twist, damping=0.1)
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-9)
        assert np.linalg.norm(found) <= np.linalg.norm(twist) / 0.1


def test_a_singular_posture_without_damping_gives_the_least_rates():
    chain = load_robot("puma560")
    q, twist = np.zeros(6), np.ones(6)
    J = jacobian(chain, q)
    assert np.linalg.matrix_rank(J, 1e-9) < 6
    wanted = np.linalg.pinv(J, rcond=1e-6) @ twist
    np.testing.assert_allclose(joint_rates(chain, q, twist), wanted, rtol=0, atol=1e-10)


def test_secondary_rates_move_only_inside():
    chain = load_robot("panda")
    rng = np.random.default_rng(2)
    q, twist, wish = rng.uniform(-1, 1, 7), rng.normal(size=6), rng.normal(size=7)
    J = jacobian(chain, q)
    found = joint_rates(chain, q, twist, secondary=wish)
    np.testing.assert_allclose(J @ found, twist, rtol=0, atol=1e-11)
    inside = np.eye(7) - np.linalg.pinv(J) @ J
    wanted = joint_rates(chain, q, twist) + inside @ wish
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-11)
    puma = load_robot("puma560")
    regular = np.array([0.3, -0.5, 0.4, 0.5, 0.6, 0.7])
    bare = joint_rates(puma, regular, twist)
    np.testing.assert_allclose(
        joint_rates(puma, regular, twist, secondary=wish[:6]), bare, rtol=0, atol=1e-11
    )


def test_batches_are_their_rows():
    for robot in ("puma560", "ur5e", "panda", "scara"):
        chain = load_robot(robot)
        rng = np.random.default_rng(4)
        q, twist = rng.uniform(-2, 2, (3, 4, chain.n)), rng.normal(size=(3, 4, 6))
        found = joint_rates(chain, q, twist, damping=0.01)
        assert found.shape == (3, 4, chain.n)
        row = joint_rates(chain, q[1, 2], twist[1, 2], damping=0.01)
        np.testing.assert_array_equal(found[1, 2], row)
        same = joint_rates(chain, q, twist[0, 0], damping=0.01)
        np.testing.assert_array_equal(same[0, 0], found[0, 0])
        np.testing.assert_array_equal(
            same[2, 3], joint_rates(chain, q[2, 3], twist[0, 0], damping=0.01)
        )


def test_twists_in_the_axes_of_a_link():
    chain, rng = load_robot("panda"), np.random.default_rng(3)
    q, twist = rng.uniform(-1, 1, (4, chain.n)), rng.normal(size=6)
    found = joint_rates(chain, q, twist, axes=chain.tip)
    for row, rates in zip(q, found, strict=True):
        assert point_jacobian(chain, row, axes=chain.tip) @ rates == pytest.approx(twist)
    with pytest.raises(UnknownLinkError, match="moon"):
        joint_rates(chain, q, twist, axes="moon")


def test_what_is_refused():
    chain, q = load_robot("puma560"), [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
    with pytest.raises(NonFiniteError, match=r"twist\[2\] is nan"):
        joint_rates(chain, q, [0, 0, np.nan, 0, 0, 0])
    with pytest.raises(WrongSizeError, match=r"twist has shape \(5,\)"):
        joint_rates(chain, q, np.zeros(5))
    with pytest.raises(WrongSizeError, match=r"twist has shape \(2, 6\), expected \(6,\)"):
        joint_rates(chain, q, np.zeros((2, 6)))
    with pytest.raises(WrongSizeError, match=r"secondary has shape \(2, 6\), expected \(6,\)"):
        joint_rates(chain, q, np.zeros(6), secondary=np.zeros((2, 6)))
    with pytest.raises(NonFiniteError, match="secondary of joint 'elbow'"):
        joint_rates(chain, q, np.zeros(6), secondary=[0, 0, np.inf, 0, 0, 0])
    with pytest.raises(BadValueError, match=r"damping is -1\.0, expected a number from 0 to"):
        joint_rates(chain, q, np.zeros(6), damping=-1)
    with pytest.raises(BadValueError, match=r"largest of the twist is 1e\+308"):
        joint_rates(chain, q, [1e308] * 6)
