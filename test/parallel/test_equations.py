"""The book's equations of platforms: all roots, as `direct` finds them, and their contours."""

import numpy as np
import pytest
from platforms import platform, random_pose, same_poses
from scipy.spatial.transform import Rotation
from wrong_values import WRONG_VALUES, answered_or_refused, with_options

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.numerics import bivariate
from robomech_ros.parallel import (
    Delta,
    Planar3RPR,
    Planar3RRR,
    Spherical3RRR,
    StewartGough,
    load_parallel,
)
from robomech_ros.parallel.equations import delta_quadratic, platform_equations

KINDS = {"6-3": 16, "3-rpr": 6, "3-rrr": 6, "spherical": 8}
FEW, MANY = 12, 100


def random_robot(kind, rng):
    """A robot of a kind, and drives of one of its poses."""
    if kind == "6-3":
        top = np.repeat(rng.normal(size=(3, 3)), 2, axis=0)[rng.permutation(6)]
        robot = StewartGough(rng.normal(size=(6, 3)), top)
        return robot, robot.inverse(random_pose(robot, rng))
    if kind == "spherical":
        axes = rng.normal(size=(3, 3, 3))
        base, middle, top = axes / np.linalg.norm(axes, axis=2)[:, :, None]
        turned = Rotation.random(random_state=rng).apply(top)
        q = rng.uniform(-3.0, 3.0, 3)
        moved = Rotation.from_rotvec(q[:, None] * base).apply(middle)
        distal = np.arccos(np.sum(moved * turned, axis=1))
        return Spherical3RRR(base, middle, top, distal), q
    a, b = rng.normal(size=(2, 3, 2))
    pose = [*rng.normal(size=2), rng.uniform(-3.0, 3.0)]
    if kind == "3-rpr":
        robot = Planar3RPR(a, b)
        return robot, robot.inverse(pose)
    robot = Planar3RRR(a, b, 2.0, [3.0, 4.0, 5.0])
    q = robot.inverse(pose).q
    return (robot, q[0]) if len(q) else random_robot(kind, rng)


def golden_robot(kind, golden):
    if kind == "6-3":
        data = golden("sgp_6_3")
        return StewartGough(data["A"], data["B"]), data["L"]
    if kind == "3-rpr":
        data = golden("planar_3rpr")
        return Planar3RPR(data["A"], data["B"]), data["rho"]
    data = golden("spherical_3rrr")
    return Spherical3RRR(np.roll(data["W"], 1, axis=0), data["W"], data["V"]), [0.0, 0.0, 0.0]


def check_all_roots(robot, drives, degree):
    """As many different solutions as the degree, and the real ones are those of ``direct``."""
    equations = platform_equations(robot, drives)
    found = equations.roots()
    assert equations.degree == degree == len(found.angles) and found.complete
    assert found.polynomial.shape == (degree + 1,) and np.abs(found.polynomial).max() == 1.0
    assert same_poses(found.real, robot.direct(drives).poses, 1e-8)
    for angles, T in zip(found.angles, found.poses, strict=True):
        size = np.cosh(np.abs(angles.imag).max()) ** 2
        assert np.abs(equations.residual(angles)).max() < 1e-13 * size
        R = T[:3, :3]
        assert np.abs(R @ R.T - np.eye(3)).max() < 1e-9 * size**2
    for x in np.tan(0.5 * found.angles[:, 0]):
        if abs(x) < 1e12:
            powers = np.abs(x) ** np.arange(degree + 1)
            assert abs(np.polyval(found.polynomial, x)) < 1e-11 * powers.sum()
    return equations, found


def by_contours(equations):
    """The real poses at the crossings of the contours."""
    crossings = equations.contours().all()
    ends = [end for one in crossings for end in equations.solutions_at(*one.point)]
    assert np.abs(np.imag(ends)).max(initial=0.0) < 1e-12
    return [equations.pose(end).real for end in ends]


@pytest.mark.parametrize("kind", ["6-3", "3-rpr", "spherical"])
def test_golden_robots(kind, golden):
    robot, drives = golden_robot(kind, golden)
    equations, found = check_all_roots(robot, drives, KINDS[kind])
    assert len(found.real) == KINDS[kind]
    assert same_poses(by_contours(equations), found.real, 1e-8)
    if kind == "6-3":  # a planar base: poses in mirror pairs
        assert np.abs(found.polynomial[1::2]).max() < 1e-12


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_random_robots(kind):
    rng = np.random.default_rng(5)
    for number in range(FEW):
        equations, found = check_all_roots(*random_robot(kind, rng), KINDS[kind])
        if number < 4:
            assert same_poses(by_contours(equations), found.real, 1e-7)


@pytest.mark.long
@pytest.mark.timeout(900)
@pytest.mark.parametrize("kind", KINDS)
def test_a_hundred_robots(kind):
    rng = np.random.default_rng(6)
    for _ in range(MANY):
        equations, found = check_all_roots(*random_robot(kind, rng), KINDS[kind])
        assert same_poses(by_contours(equations), found.real, 1e-7)


def test_legs_of_a_3_3_platform_and_equal_lengths():
    for lengths in ([1.5, 1.4, 1.3, 1.2, 1.1, 1.15], [1.2] * 6):
        robot = platform("3-3")
        check_all_roots(robot, lengths, 16)


def test_the_curves_are_equations_for_bivariate(golden):
    robot, drives = golden_robot("6-3", golden)
    equations = platform_equations(robot, drives)
    found = bivariate(equations.curves, period=2.0 * np.pi)
    assert len(found.roots) == 16 and found.is_root.all()


def test_a_half_turn_is_a_root_at_infinity():
    robot = Planar3RPR([[0, 0], [2, 0.3], [0.2, 2]], [[0, 0], [1, 0], [0.3, 1.2]])
    drives = robot.inverse([0.4, 0.3, np.pi])
    _, found = check_all_roots(robot, drives, 6)
    assert abs(found.polynomial[0]) < 1e-14 and np.abs(found.tangents).max() > 1e12


def test_delta_agrees_with_direct_real_or_not():
    robot, rng, real = load_parallel("delta"), np.random.default_rng(7), 0
    for _ in range(100):
        q = rng.uniform(-1.5, 1.5, 3)
        found, ours = delta_quadratic(robot, q), robot.direct(q)
        assert len(found.real) == len(ours)
        real += len(ours) > 0 and same_poses(found.real, ours.poses, 1e-9)
        length = np.sqrt(np.sum((found.positions[:, None] - found.centres) ** 2, axis=2))
        assert np.abs(length - robot.forearm).max() < 1e-12
    assert real > 50
    none = delta_quadratic(Delta(1.0, 0.05, 0.6, 0.9), [0.0, 0.0, 0.0])
    assert len(none.real) == 0 and np.abs(none.positions.imag).max() > 0.1


def test_what_is_missing_is_said():
    triangle = [[0, 0], [1, 0], [0.3, 0.8]]
    found = platform_equations(Planar3RPR(triangle, triangle), [0.5] * 3).roots()
    assert not found.complete and "6 roots that may be real led to" in found.reason
    # Base points in a line: the platform turns about it.
    line = np.outer(np.arange(6.0), [1.0, 0.0, 0.0])
    robot = StewartGough(line, np.repeat(np.eye(3), 2, axis=0))
    found = platform_equations(robot, robot.inverse(np.eye(4))).roots()
    assert not found.complete and "the platform can move" in found.reason
    assert len(found.angles) == len(found.roots) == len(found.real) == 0
    with pytest.raises(BadValueError, match="number of angles is 2, expected 3"):
        platform_equations(load_parallel("planar_3rpr"), [14.0] * 3).dialytic_matrix(0.0)
    legs = StewartGough(*(np.repeat(np.eye(3)[[0, 1, 2]], 2, 0) * r for r in (1.0, 0.5)))
    with pytest.raises(BadValueError, match="base_points is .* with different base points"):
        platform_equations(legs, [1.0] * 6)
    with pytest.raises(BadValueError, match="expected three points, each the end of two legs"):
        platform_equations(load_parallel("hexapod"), [0.7] * 6)
    with pytest.raises(BadValueError, match="legs 1 and 2 is .* their base points are 0.347"):
        platform_equations(platform("6-3"), [0.1, 2.0] * 3)
    with pytest.raises(BadValueError, match="robot is 'Delta', expected one of StewartGough"):
        platform_equations(load_parallel("delta"), [0.0] * 3)
    with pytest.raises(WrongSizeError, match="lengths has shape"):
        platform_equations(platform("6-3"), [1.0] * 5)
    for length in (-1.0, 1e300):
        with pytest.raises(BadValueError, match="length of leg 2 is .* from 0 m, up to 1e.06 m"):
            platform_equations(load_parallel("planar_3rpr"), [14.0, length, 14.0])
    equations = platform_equations(platform("6-3"), [1.5] * 6)
    with pytest.raises(BadValueError, match="largest imaginary part of angles is 1000.0"):
        equations.residual([1000j, 0.0, 0.0])
    with pytest.raises(WrongSizeError, match="first and second"):
        equations.curves(np.zeros(3), np.zeros(4))
    with pytest.raises(NonFiniteError):
        delta_quadratic(load_parallel("delta"), [0.0, np.nan, 0.0])
    with pytest.raises(BadValueError, match="the three elbows are not in line"):
        delta_quadratic(Delta(0.2, 0.2, 0.4, 1.0), [np.pi / 2] * 3)


def test_wrong_values_are_answered_or_refused():
    robot, lengths = load_parallel("planar_3rpr"), [14.98, 15.38, 12.0]
    equations = platform_equations(robot, lengths)
    calls = with_options(platform_equations, robot=robot, drives=lengths)
    calls |= with_options(delta_quadratic, robot=load_parallel("delta"), q=[0.0] * 3)
    calls["curves"] = lambda value: equations.curves(value, 0.1)
    for name in ("residual", "pose", "resultant"):
        calls[name] = getattr(equations, name)
    calls["first"] = lambda value: equations.solutions_at(value, 0.1)
    calls["second"] = lambda value: equations.solutions_at(0.1, value)
    for call in calls.values():
        assert len(answered_or_refused(call, WRONG_VALUES)) > 10
