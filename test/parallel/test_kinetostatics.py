"""Velocities, accelerations and statics of parallel robots against differences and SymPy."""

import numpy as np
import pytest
from scipy.linalg import expm

from robomech_ros.errors import RobomechError
from robomech_ros.parallel import (
    Planar3RRR,
    StewartGough,
    drive_accelerations,
    drive_forces,
    drive_rates,
    load_parallel,
    platform_acceleration,
    platform_twist,
    platform_wrench,
    velocity_matrices,
    velocity_matrix_rates,
)

ROBOTS = ("hexapod", "dietmaier", "delta", "planar_3rpr", "planar_3rrr", "agile_eye")
STEP = 1e-4


def cross(w):
    return np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])


def start(name):
    """A robot, a regular pose, and a twist and its rate that the platform can have."""
    robot, T = load_parallel(name), np.eye(4)
    turn, place, motions = {
        "hexapod": ([0.1, -0.2, 0.3], [0.05, -0.02, 0.55], range(6)),
        "dietmaier": ([0.4, 0.2, -0.3], [0.2, 0.5, 0.9], range(6)),
        "delta": ([0.0, 0.0, 0.0], [0.12, -0.2, -0.95], (3, 4, 5)),
        "planar_3rpr": ([0.0, 0.0, 0.4], [3.0, 2.0, 0.0], (2, 3, 4)),
        "planar_3rrr": ([0.0, 0.0, 0.2], [0.45, 0.35, 0.0], (2, 3, 4)),
        "agile_eye": ([0.3, -0.2, 0.1], [0.0, 0.0, 0.0], (0, 1, 2)),
    }[name]
    T[:3, :3], T[:3, 3] = expm(cross(turn)), place
    rng = np.random.default_rng(5)
    twist, rate = np.zeros(6), np.zeros(6)
    twist[list(motions)] = 0.3 * rng.normal(size=len(motions))
    rate[list(motions)] = 0.3 * rng.normal(size=len(motions))
    return robot, T, twist, rate


def moved(T, twist, rate, t):
    """The pose after t, whose twist is twist + rate t but for terms of higher order."""
    out = T.copy()
    turn = t * twist[:3] + 0.5 * t * t * rate[:3]
    out[:3, :3] = expm(cross(turn)) @ T[:3, :3]
    out[:3, 3] = T[:3, 3] + t * twist[3:] + 0.5 * t * t * rate[3:]
    return out


def drives(robot, T, near=None):
    """Values of the drives at a pose: lengths, or the posture nearest to one."""
    if (near is None and isinstance(robot, StewartGough)) or robot.name == "planar_3rpr":
        return robot.inverse(T)
    if isinstance(robot, StewartGough):
        return robot.inverse(T)
    return robot.inverse(T, seed=near).q[0]


@pytest.mark.parametrize("name", ROBOTS)
def test_rates_and_accelerations_are_those_of_differences(name):
    robot, T, twist, rate = start(name)
    q = drives(robot, T)
    ahead, behind = (drives(robot, moved(T, twist, rate, t), q) for t in (STEP, -STEP))
    rates = drive_rates(robot, T, twist, q)
    assert rates == pytest.approx((ahead - behind) / (2 * STEP), abs=1e-6)
    accelerations = drive_accelerations(robot, T, twist, rate, q)
    assert accelerations == pytest.approx((ahead - 2 * q + behind) / STEP**2, abs=1e-5)
    # And back.
    assert platform_twist(robot, T, rates, q) == pytest.approx(twist, abs=1e-12)
    back = platform_acceleration(robot, T, rates, accelerations, q)
    assert back == pytest.approx(rate, abs=1e-11)


@pytest.mark.parametrize("name", ROBOTS)
def test_matrices_change_as_their_rates_say(name):
    robot, T, twist, rate = start(name)
    q = drives(robot, T)
    places = [moved(T, twist, rate, t) for t in (STEP, -STEP)]
    ahead, behind = (velocity_matrices(robot, one, drives(robot, one, q)) for one in places)
    found = velocity_matrix_rates(robot, T, twist, q)
    for k in range(2):
        assert found[k] == pytest.approx((ahead[k] - behind[k]) / (2 * STEP), abs=1e-5)


@pytest.mark.parametrize("name", ROBOTS)
def test_power_of_wrench_and_of_drives_is_the_same(name):
    robot, T, twist, _ = start(name)
    q = drives(robot, T)
    motions = list(velocity_matrices(robot, T, q).motions)
    wrench = np.arange(1.0, 7.0)
    forces = drive_forces(robot, T, wrench, q)
    power = forces @ drive_rates(robot, T, twist, q)
    assert power == pytest.approx(wrench @ twist, rel=1e-12)
    back = platform_wrench(robot, T, forces, q)
    assert back[motions] == pytest.approx(wrench[motions], rel=1e-11)
    others = [k for k in range(6) if k not in motions]
    assert not back[others].any()


@pytest.mark.parametrize("name", ROBOTS)
def test_many_poses_at_once_give_what_each_gives(name):
    robot, T, twist, rate = start(name)
    q = drives(robot, T)
    poses = np.stack([moved(T, twist, rate, t) for t in (0.0, 0.01, 0.02)])
    values = np.stack([drives(robot, one, q) for one in poses])
    rates = drive_rates(robot, poses, twist, values)
    forces = drive_forces(robot, poses, np.ones(6), values)
    more = platform_acceleration(robot, poses, rates, rates, values)
    for k in range(3):
        one = poses[k], values[k]
        assert rates[k] == pytest.approx(drive_rates(robot, one[0], twist, one[1]), abs=1e-14)
        assert forces[k] == pytest.approx(drive_forces(robot, one[0], np.ones(6), one[1]))
        assert more[k] == pytest.approx(
            platform_acceleration(robot, one[0], rates[k], rates[k], one[1])
        )


def test_the_matrix_of_legs_is_the_one_that_the_class_gives():
    robot, T, *_ = start("hexapod")
    K, J, motions = velocity_matrices(robot, T)
    assert (pytest.approx(robot.jacobian(T), abs=1e-15) == K) and motions == tuple(range(6))
    assert (np.eye(6) == J).all()


def test_planar_limbs_against_derivatives_by_sympy():
    sympy = pytest.importorskip("sympy")
    x, y, f, *q = sympy.symbols("x y f q1:4")
    robot = load_parallel("planar_3rrr")
    pose = [0.45, 0.35, 0.2]
    values = robot.inverse(pose).q[0]
    at = dict(zip([x, y, f, *q], [*pose, *values.tolist()], strict=True))
    K, J, motions = velocity_matrices(robot, pose, values)
    for i in range(3):
        (a, b), (u, v) = robot.base_points[i], robot.platform_points[i]
        d = x + sympy.cos(f) * u - sympy.sin(f) * v - a - robot.proximal[i] * sympy.cos(q[i])
        e = y + sympy.sin(f) * u + sympy.cos(f) * v - b - robot.proximal[i] * sympy.sin(q[i])
        length = sympy.sqrt(d * d + e * e)
        row = [float(length.diff(s).subs(at)) for s in (f, x, y)]
        assert K[i, list(motions)] == pytest.approx(row, abs=1e-12)
        assert J[i, i] == pytest.approx(-float(length.diff(q[i]).subs(at)), abs=1e-12)


def test_arguments_that_are_refused():
    robot, T, twist, _ = start("planar_3rrr")
    q = drives(robot, T)
    for call, said in (
        (lambda: drive_rates(robot, T, twist), "angles of the drives"),
        (lambda: drive_rates(robot, T, twist, q + [0.0, 0.1, 0.0]), "drive 2 is .* missed by"),
        (lambda: drive_rates(robot, T, np.ones(6), q), "0 except in entries 3, 4, 5"),
        (lambda: drive_rates(robot, T, [np.nan] * 6, q), "twist"),
        (lambda: platform_twist(robot, T, [1.0, 2.0], q), "rates has shape"),
        (lambda: drive_forces(robot, T, np.ones((2, 6)), q), "exerted_wrench has shape"),
        (
            lambda: velocity_matrices(robot, np.diag([1.0, -1.0, -1.0, 1.0]), q),
            "platform does not have is 2",
        ),
        (lambda: velocity_matrices("hexapod", T), "expected one of StewartGough"),
        (lambda: velocity_matrices(load_parallel("hexapod"), [0, 0, 0.5]), r"\(\.\.\., 4, 4\)"),
    ):
        with pytest.raises(RobomechError, match=said):
            call()


def test_a_stretched_limb_gives_its_drive_no_rate():
    corners = np.array([[0.0, 1.0], [-0.9, -0.5], [0.9, -0.5]])
    robot = Planar3RRR(2.0 * corners, corners, 0.8, 0.6)
    pose = [0.0, 2.0 + 1.4 - 1.0, 0.0]
    reach = Planar3RRR(2.0 * corners, corners, [0.8, 3.0, 3.0], [0.6, 3.0, 3.0])
    q = reach.inverse(pose).q[0]
    rates = drive_rates(reach, pose, [0.0, 0.0, 0.0, 0.1, 0.0, 0.0], q)
    assert np.isnan(rates[0]) and np.isfinite(rates[1:]).all()
    assert np.isnan(platform_wrench(reach, pose, [1.0, 1.0, 1.0], q)[2:5]).all()
    assert len(robot.inverse(pose)) == 0
