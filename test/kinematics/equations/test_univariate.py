"""All roots of both univariate procedures: they agree with each other and with the fast solver."""

import numpy as np
import pytest
from golden_arms import NAMES, REGULAR, SINGULAR, arm_and_pose, golden

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinematics.equations import li_woernle_hiller, raghavan_roth
from robomech_ros.kinematics.oracles import solve_bivariate
from robomech_ros.robots import chain_from_dh, load_robot

BOTH = (raghavan_roth, li_woernle_hiller)
FEW, MANY = range(12), range(12, 100)


def unmatched(found, expected):
    """Return the greatest distance of a posture, perhaps complex, from the nearest other."""
    difference = np.asarray(found)[:, None] - np.asarray(expected)[None]
    turned = (difference.real + np.pi) % (2 * np.pi) - np.pi + 1j * difference.imag
    return np.abs(turned).max(axis=2).min(axis=1).max()


def bound_of(name):
    """Return how well postures are known: where m have merged, to the m-th root of the rounding."""
    return 1e-4 if name in SINGULAR else 1e-8


def check_all_sixteen(name):
    """Sixteen postures from either procedure, the same, and the real ones are those of the kernel.

    The roots that merge with others at the rounding's level would be fewer: there are none here.
    """
    chain, T = arm_and_pose(name)
    ours = inverse_kinematics(chain, T, respect_limits=False)
    assert ours.complete
    found = [solve(chain, T) for solve in BOTH]
    for one in found:
        assert one.q.shape == (16, 6) and one.complete and not one.reason
        assert len(one.real) == len(ours.q)
        assert unmatched(one.real, ours.q) < 1e-8
        for q in one.q:
            assert (
                np.abs(one.equations.residual(q)).max() < 1e-9 * np.cosh(np.abs(q.imag).max()) ** 4
            )
    # A posture far from the real ones, where cosines are great, is known to fewer digits.
    size = np.cosh(np.abs(found[0].q.imag).max(axis=1))
    for q, bound in zip(found[0].q, 1e-8 * size**2, strict=True):
        assert unmatched(q[None], found[1].q) < bound
    return chain, T, ours


@pytest.mark.parametrize("name", (*REGULAR, *FEW))
def test_all_sixteen_roots(name):
    check_all_sixteen(name)


@pytest.mark.parametrize("name", (*NAMES, *FEW))
def test_the_bivariate_route_gives_the_same_real_postures(name):
    chain, T = arm_and_pose(name)
    ours = inverse_kinematics(chain, T, respect_limits=False)
    theirs = [crossing.q for crossing in solve_bivariate(chain, T, steps=120)]
    assert len(theirs) == len(ours.q)
    assert unmatched(theirs, ours.q) < bound_of(name)


@pytest.mark.long
@pytest.mark.timeout(900)
@pytest.mark.parametrize("name", MANY)
def test_a_hundred_arms(name):
    """Univariate and bivariate routes and the fast solver agree on random general arms."""
    chain, T, ours = check_all_sixteen(name)
    theirs = [crossing.q for crossing in solve_bivariate(chain, T, steps=120)]
    assert len(theirs) == len(ours.q)
    assert unmatched(theirs, ours.q) < 1e-8


@pytest.mark.parametrize("solve", BOTH)
@pytest.mark.parametrize("name", NAMES)
def test_golden_postures(name, solve):
    case, chain, T = golden(name)
    ours = inverse_kinematics(chain, T, respect_limits=False).q
    found = solve(chain, T)
    assert len(found.real) == len(ours) >= len(case["solutions"])
    assert unmatched(case["solutions"], found.real) < 1e-8
    assert unmatched(found.real, ours) < bound_of(name)
    assert found.complete == (name in REGULAR)
    assert bool(found.reason) != found.complete


@pytest.mark.parametrize("name", REGULAR)
def test_golden_roots_of_the_polynomial_real_and_complex(name):
    case, chain, T = golden(name)
    found = raghavan_roth(chain, T, first=1)
    assert found.joint == 3
    real = found.tangents[np.abs(found.angles.imag) < 1e-6].real
    angles = 2.0 * np.arctan(case["x3_tan_half_theta3_real"])
    for angle in angles:
        assert np.abs(np.exp(2j * np.arctan(real)) - np.exp(1j * angle)).min() < 1e-7
    for real_part, imaginary in case["x3_complex_roots"]:
        x = complex(real_part, imaginary)
        assert np.abs(found.tangents - x).min() < 1e-6 * (1.0 + abs(x))
    assert len(angles) + len(case["x3_complex_roots"]) == 16


@pytest.mark.parametrize("solve", BOTH)
@pytest.mark.parametrize("name", (*REGULAR, 0, 1, 2))
def test_the_polynomial_vanishes_at_the_roots(name, solve):
    found = solve(*arm_and_pose(name))
    assert found.polynomial.shape == (17,) and np.abs(found.polynomial).max() == 1.0
    for x in found.tangents:
        terms = found.polynomial * x ** np.arange(16, -1, -1)
        assert abs(terms.sum()) < 1e-8 * np.abs(terms).max()
    assert np.all(found.condition >= 1.0)


@pytest.mark.parametrize("solve", BOTH)
def test_any_joint_may_be_hidden(solve):
    chain, T = arm_and_pose(1)
    found = [solve(chain, T, first=first) for first in range(1, 7)]
    hidden = 2 if solve is raghavan_roth else 4
    assert [one.joint for one in found] == [(hidden + k) % 6 + 1 for k in range(6)]
    for one in found:
        assert one.q.shape == (16, 6)
        assert unmatched(one.real, found[0].real) < 1e-8


@pytest.mark.parametrize("solve", BOTH)
def test_a_half_turn_is_a_root_at_infinity(solve):
    a, b = [0.3, 0.4, 0.15, 0.2, 0.25, 0.1], [0.2, 0.1, 0.3, 0.15, 0.1, 0.2]
    chain = chain_from_dh(a, b, [1.1, -0.7, 1.3, 0.9, -1.2, 0.4])
    q = np.array([0.4, -0.8, 1.3, 0.5, -0.6, 1.0])
    q[solve(chain, np.eye(4), first=1).joint - 1] = np.pi
    T = forward_kinematics(chain, q)
    found = solve(chain, T, first=1)
    assert abs(found.polynomial[0]) < 1e-12
    assert np.abs(found.tangents).max() > 1e12
    assert found.q.shape == (16, 6)
    assert unmatched(q[None], found.real) < 1e-10
    assert len(found.real) == len(inverse_kinematics(chain, T, respect_limits=False).q)


def test_a_spherical_wrist_hides_another_joint():
    """The determinant that hides joint 3 vanishes for all angles: postures were lost."""
    case, chain, T = golden("ik6r_tsai_morgan_1")
    nothing = raghavan_roth(chain, T, first=1)
    assert nothing.reason == "the determinant vanishes for all angles"
    assert not nothing.complete and nothing.q.shape == (0, 6) and nothing.angles.shape == (0,)
    found = raghavan_roth(chain, T)
    assert found.joint != 3 and len(found.real) == 8
    assert unmatched(case["solutions"], found.real) < 1e-8


@pytest.mark.parametrize("solve", BOTH)
def test_wrong_arguments(solve):
    diestro = load_robot("diestro")
    with pytest.raises(BadValueError, match="six revolute"):
        solve(load_robot("panda"), np.eye(4))
    with pytest.raises(BadValueError, match="a joint from 1 to 6"):
        solve(diestro, np.eye(4), first=7)
    with pytest.raises(WrongSizeError):
        solve(diestro, np.eye(3))
    with pytest.raises(NonFiniteError):
        solve(diestro, np.full((4, 4), np.nan))
